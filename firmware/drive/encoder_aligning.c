#include "firmware/drive/encoder_aligning.h"

#include "firmware/design/elementary.h"
#include "firmware/design/hold_frequency.h"
#include "firmware/drive/default_settings.h"

double encoder_aligning_current_A(const struct drive_settings *settings, struct hold_task hold)
{
    const double rated = settings->motor.rated_current_A;
    const double allowed = rated < settings->current_limit_A ? rated : settings->current_limit_A;
    const double trip = HOLD_TRIP_SHARE * settings->overcurrent_trip_A;
    char ignored[DESIGN_ERROR_TEXT];
    double damping_As_rad;

    if (!hold_damping_design(&hold, &damping_As_rad, ignored)) {
        return settings->hold_current_A; /* which is refused for that */
    }
    hold.hold_current_A = smaller(allowed, trip);
    return hold.hold_current_A > settings->hold_current_A &&
                   hold_frequency(hold.motor, hold.hold_current_A) * hold.period_s <=
                       HOLD_FREQUENCY_PERIOD_MAX &&
                   hold_control_damping(&hold, damping_As_rad) >= HOLD_DAMPING_MIN
               ? hold.hold_current_A
               : settings->hold_current_A;
}

void encoder_aligning_design(struct drive *drive, const struct drive_settings *settings,
                             double period_s, double current_A)
{
    const struct encoder_alignment_task task = {
        .base = &drive->base,
        .motor = &settings->motor,
        .counts_per_turn = drive->board->facts->encoder_counts_per_turn,
        .period_s = period_s,
        .current_A = current_A,
        .settling_s = 0.5 * settings->hold_on_enable_s,
    };

    drive->enabling.alignment_params = encoder_alignment_design(&task);
}

void encoder_aligning_start(struct drive *drive)
{
    encoder_alignment_start(&drive->enabling.alignment, drive->encoder_count);
}

/* Not in the memory of the interrupt, as operation does not need it. */
__attribute__((noinline)) enum encoder_aligning encoder_aligning_step(struct drive *drive)
{
    struct encoder_alignment *alignment = &drive->enabling.alignment;
    const struct position final = drive->reference.next.position;
    const enum encoder_alignment_event event = encoder_alignment_step(
        alignment, &drive->enabling.alignment_params, drive->encoder_count, drive->current.d);

    if (event == ALIGNMENT_FAILS) {
        return ENCODER_NOT_ALIGNED;
    }
    if (event == ALIGNMENT_PLACES) {
        estimator_place(&drive->estimator, &drive->params.estimator,
                        position_add(final, alignment->rotor), drive->encoder_count);
        estimator_predict(&drive->estimator, &drive->params.estimator, &drive->params.model,
                          drive->actuation.in_force);
    }
    standstill_hold_align(&drive->hold, final.fraction + (angle_t)alignment->held.offset,
                          encoder_alignment_speed(alignment, &drive->enabling.alignment_params),
                          encoder_alignment_current(alignment, &drive->enabling.alignment_params));
    return alignment->stage == ALIGNMENT_FOUND ? ENCODER_ALIGNED : ENCODER_ALIGNING;
}
