#include "firmware/drive/rotor_watch.h"

#include "firmware/drive/drive.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/drive/state_machine.h"

/* In looks of the following error, 1 ms each. */
#define SWING_LOOKS 100u
#define STAND_LOOKS 30u

#define SWINGS      3u
#define SWING_TURNS NUM(1.0) /* electrical */
#define COUNTS_OFF  2.0
#define AT_LIMIT    0.99

void rotor_watch_reset(struct rotor_watch *watch, uint32_t period)
{
    watch->free = period;
    rotor_watch_reset_swing(&watch->swing);
}

void rotor_watch_reset_swing(struct rotor_swing *swing)
{
    swing->side = 0;
    swing->turns = 0u;
}

bool rotor_watch_swings(struct rotor_swing *swing, num_t error, num_t limit, uint32_t period,
                        uint32_t within)
{
    const int8_t side = error > limit ? 1 : error < -limit ? -1 : 0;

    if (side != 0 && side != swing->side) {
        swing->turns = swing->side != 0 && period - swing->turned < within
                           ? (uint8_t)(swing->turns + 1u)
                           : (uint8_t)0u;
        swing->turned = period;
        swing->side = side;
    }
    return swing->turns >= SWINGS;
}

bool rotor_watch_jumps(struct rotor_watch *watch, struct position reference, num_t limit)
{
    const num_t moved = position_difference(reference, watch->reference);

    watch->reference = reference;
    return num_abs(moved) > limit;
}

bool rotor_watch_count_stands(struct rotor_watch *watch, int32_t count, bool pushed,
                              uint32_t period, uint32_t longer)
{
    if (count != watch->count || !pushed) {
        watch->count = count;
        watch->free = period;
    }
    return period - watch->free > longer;
}

static bool is_pushed(const struct drive *drive, num_t error)
{
    const struct drive_settings *settings = &drive->settings;

    if (interrupt_view_moves(drive)) {
        return false;
    }
    const double turns_off = COUNTS_OFF * settings->motor.rotor_teeth /
                             (double)drive->board->facts->encoder_counts_per_turn;
    const double limit = AT_LIMIT * settings->current_limit_A / drive->base.current_A;

    return num_abs(drive->current_reference.q) > num_from_double(limit) &&
           num_abs(error) < num_from_double(turns_off);
}

static enum drive_fault look(struct drive *drive, uint32_t period)
{
    const struct following_error_params *following = &drive->params.following;
    const bool encoder = drive->settings.feedback == DRIVE_FEEDBACK_ENCODER;
    const bool watched = encoder ? following->limit > NUM(0.0)
                                 : drive->synchronism.monitored &&
                                       drive->synchronism.policy == DRIVE_SYNCHRONISM_FAULT;
    const num_t error = position_difference(drive->reference.now.position,
                                            drive->estimator.estimate.rotor.position);

    const num_t limit = encoder ? following->limit : SWING_TURNS;

    if (rotor_watch_jumps(&drive->rotor_watch, drive->reference.now.position, limit)) {
        rotor_watch_reset_swing(&drive->rotor_watch.swing);
    }
    if (watched && rotor_watch_swings(&drive->rotor_watch.swing, error, limit, period,
                                      SWING_LOOKS * following->periods)) {
        return encoder ? DRIVE_FAULT_FOLLOWING_ERROR : DRIVE_FAULT_STALLED;
    }
    return encoder && rotor_watch_count_stands(&drive->rotor_watch, drive->encoder_count,
                                               is_pushed(drive, error), period,
                                               STAND_LOOKS * following->periods)
               ? DRIVE_FAULT_ENCODER
               : DRIVE_FAULT_NONE;
}

void rotor_watch_background(struct drive *drive)
{
    const uint32_t period = interrupt_view_period(drive);

    if (interrupt_view_state(drive) != DRIVE_OPERATION_ENABLED) {
        rotor_watch_reset(&drive->rotor_watch, period);
        return;
    }
    atomic_signal_fence(memory_order_seq_cst);
    const enum drive_fault fault = look(drive, period);

    atomic_signal_fence(memory_order_seq_cst);
    if (fault != DRIVE_FAULT_NONE && period == interrupt_view_period(drive)) {
        state_machine_ask_for_fault(drive, fault);
    }
}
