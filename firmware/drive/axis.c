#include "firmware/drive/axis.h"

#include <stdatomic.h>
#include <stddef.h>

#include "firmware/drive/drive.h"
#include "firmware/drive/state_machine.h"

/* What a fault's row says of the position. */
enum { STANDS, WITH_ENCODER, UNCERTAIN };

#define BIT_IF_STANDS(constant, code, name, cause, limit, position, remedy)                        \
    | (uint32_t)((position) == STANDS) << DRIVE_FAULT_##constant
#define BIT_IF_UNCERTAIN(constant, code, name, cause, limit, position, remedy)                     \
    | (uint32_t)((position) == UNCERTAIN) << DRIVE_FAULT_##constant
static const uint32_t say_nothing_of_rotor = 1u
                                             << DRIVE_FAULT_NONE DRIVE_FAULTS_TABLE(BIT_IF_STANDS);
static const uint32_t say_encoder_may_fail = 0u DRIVE_FAULTS_TABLE(BIT_IF_UNCERTAIN);
_Static_assert((int)DRIVE_FAULTS <= 32, "a bit each");

static bool is_one_of(enum drive_fault fault, uint32_t faults)
{
    return (faults >> fault & 1u) != 0u;
}

bool axis_begins_anew(const struct drive_settings *in_force, const struct drive_settings *given)
{
    return in_force->motor.rotor_teeth != given->motor.rotor_teeth ||
           in_force->feedback != given->feedback ||
           in_force->encoder_counts_per_turn != given->encoder_counts_per_turn ||
           in_force->encoder_zero_known != given->encoder_zero_known ||
           in_force->encoder_zero_rad != given->encoder_zero_rad ||
           in_force->initial_angle_rad != given->initial_angle_rad ||
           in_force->initial_angle_error_rad != given->initial_angle_error_rad;
}

void axis_begin(struct drive *drive)
{
    const struct enabling_params *enabling = &drive->params.enabling;

    drive->axis.counts = false;
    atomic_signal_fence(memory_order_release); /* the interrupt keeps away */
    drive->axis =
        (struct axis){.reference = enabling->encoder_zero_known ? DRIVE_POSITION_REFERENCED
                                                                : DRIVE_POSITION_ASSUMED};
    encoder_set(&drive->axis.encoder, enabling->initial_position, 0);
    reference_reset(&drive->reference, enabling->initial_position);
}

struct position axis_kept_position(const struct drive *drive)
{
    const struct encoder *kept = &drive->axis.encoder;

    return (struct position){kept->turns, (angle_t)(kept->fraction >> 32)};
}

struct position axis_position(const struct drive *drive, struct position encoder_zero)
{
    const struct drive_params *params = &drive->params;

    return params->enabling.encoder_zero_known && !drive->axis.counts
               ? encoder_position(&params->estimator.encoder_observer.encoder, encoder_zero,
                                  drive->encoder_count)
               : drive->reference.next.position;
}

void axis_note_ready(struct drive *drive)
{
    drive->axis.aligned = estimator_has_encoder(&drive->params.estimator);
}

void axis_note_uncertain(struct drive *drive)
{
    drive->axis.reference = DRIVE_POSITION_UNCERTAIN;
}

/* A rotor near its reference, and slow, comes to rest within the turn from which a hold draws it
   back. */
static bool rests(const struct drive *drive)
{
    const struct rotor *rotor = &drive->estimator.estimate.rotor;
    const num_t error = position_difference(drive->reference.next.position, rotor->position);

    return !reference_busy(&drive->reference) &&
           drive->synchronism.shown == DRIVE_SYNCHRONISM_SURE && num_abs(error) < NUM(0.25) &&
           num_abs(rotor->speed) < drive->params.hold.speed_limit;
}

/* Without an encoder: where the rotor is from now on is assumed. */
static void leave_rotor(struct drive *drive, bool powered, bool sound)
{
    struct position position = drive->reference.next.position;

    if (!sound || (powered && !rests(drive))) {
        axis_note_uncertain(drive);
        position = drive->estimator.estimate.rotor.position;
    } else if (drive->axis.reference == DRIVE_POSITION_REFERENCED) {
        drive->axis.reference = DRIVE_POSITION_KEPT;
    }
    if (powered) {
        encoder_set(&drive->axis.encoder, position, 0);
    }
}

static void leave_encoder(struct drive *drive, const struct encoder *encoder, bool sound)
{
    struct axis *axis = &drive->axis;

    axis->counts = !drive->supervision.aligns;
    if (axis->counts) {
        axis->encoder = *encoder;
    } else { /* of the search nothing is of use */
        encoder_set(&axis->encoder, drive->reference.next.position, 0);
    }
    if (!sound) {
        axis->aligned = false;
        axis_note_uncertain(drive);
    }
}

void axis_note_bridge_off(struct drive *drive, enum drive_fault fault)
{
    const bool powered = state_machine_powered(drive);
    const struct encoder *encoder = estimator_encoder(&drive->estimator, &drive->params.estimator);

    if (encoder == NULL) {
        leave_rotor(drive, powered, is_one_of(fault, say_nothing_of_rotor));
    } else if (powered) {
        leave_encoder(drive, encoder, !is_one_of(fault, say_encoder_may_fail));
    }
}

void axis_note_disabled(struct drive *drive)
{
    reference_reset(&drive->reference, axis_kept_position(drive));
}

void axis_follow_encoder(struct drive *drive)
{
    const struct position here =
        encoder_step(&drive->axis.encoder, &drive->params.estimator.encoder_observer.encoder,
                     drive->encoder_count);

    estimator_show_position(&drive->estimator, here);
    if (drive->supervision.state != DRIVE_FAULT) {
        reference_place(&drive->reference, here);
    }
}

void axis_set_position(struct drive *drive, struct position position)
{
    const struct enabling_params *enabling = &drive->params.enabling;
    struct axis *axis = &drive->axis;

    if (!state_machine_powered(drive)) {
        reference_place(&drive->reference, axis_position(drive, enabling->encoder_zero_assumed));
    }
    axis->offset = position_minus(position, drive->reference.next.position);
    axis->reference = state_machine_powered(drive) || axis->counts || enabling->encoder_zero_known
                          ? DRIVE_POSITION_REFERENCED
                          : DRIVE_POSITION_KEPT;
}
