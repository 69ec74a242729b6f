#include "firmware/drive/rotor_watch.h"

#include "firmware/drive/drive.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/drive/state_machine.h"

#define RISEN_LOOKS  5u   /* of the following error, 1 ms each */
#define RISE         0.15 /* of the current limit */
#define HIGH         0.7
#define COUNTS_ASIDE 2.0
#define SWING_TURNS  NUM(1.0) /* electrical */
#define SWING_LOOKS  100u     /* 5 Hz and more */
#define SWINGS       3u

bool rotor_watch_step(struct rotor_watch *watch, const struct rotor_watch_params *params,
                      const struct rotor_look *look)
{
    const num_t current = num_abs(look->current);

    if (look->count != watch->count || !look->in_place || current < watch->current) {
        watch->count = look->count;
        watch->current = current;
    }
    if (current - watch->current <= params->rise || current < params->high) {
        watch->low = look->period;
    }
    return look->period - watch->low >= params->periods;
}

static num_t error_of(const struct drive *drive)
{
    return position_difference(drive->reference.now.position,
                               drive->estimator.estimate.rotor.position);
}

static bool count_stands(struct drive *drive, uint32_t period)
{
    const struct drive_settings *settings = &drive->settings;
    const double turns_aside = COUNTS_ASIDE * settings->motor.rotor_teeth /
                               (double)drive->board->facts->encoder_counts_per_turn;
    const num_t limit = num_from_double(settings->current_limit_A / drive->base.current_A);
    const struct rotor_watch_params params = {
        .rise = num_mul(NUM(RISE), limit),
        .high = num_mul(NUM(HIGH), limit),
        .periods = RISEN_LOOKS * drive->params.following.periods,
    };
    const struct rotor_look look = {
        .period = period,
        .count = drive->encoder_count,
        .current = drive->current.q,
        .in_place = !interrupt_view_moves(drive) &&
                    num_abs(error_of(drive)) < num_from_double(turns_aside),
    };

    return rotor_watch_step(&drive->rotor_watch, &params, &look);
}

bool rotor_watch_swings(struct rotor_swing *swing, num_t error, uint32_t period, uint32_t within)
{
    const int8_t side = error > SWING_TURNS ? 1 : error < -SWING_TURNS ? -1 : 0;

    if (side != 0 && side != swing->side) {
        swing->turns = period - swing->turned < within ? (uint8_t)(swing->turns + 1u) : (uint8_t)0u;
        swing->turned = period;
        swing->side = side;
    }
    return swing->turns >= SWINGS;
}

static bool swings(struct drive *drive, uint32_t period)
{
    return drive->synchronism.monitored && drive->synchronism.policy == DRIVE_SYNCHRONISM_FAULT &&
           rotor_watch_swings(&drive->rotor_watch.swing, error_of(drive), period,
                              SWING_LOOKS * drive->params.following.periods);
}

void rotor_watch_background(struct drive *drive)
{
    const bool encoder = drive->settings.feedback == DRIVE_FEEDBACK_ENCODER;
    const uint32_t period = interrupt_view_period(drive);

    if (interrupt_view_state(drive) != DRIVE_OPERATION_ENABLED) {
        drive->rotor_watch.low = period;
        drive->rotor_watch.swing.turns = 0u;
        return;
    }
    atomic_signal_fence(memory_order_seq_cst);
    const bool shows = encoder ? count_stands(drive, period) : swings(drive, period);

    atomic_signal_fence(memory_order_seq_cst);
    if (shows && period == interrupt_view_period(drive)) {
        state_machine_ask_for_fault(drive,
                                    encoder ? DRIVE_FAULT_ENCODER : DRIVE_FAULT_STALLED);
    }
}
