#include "firmware/drive/rotor_watch.h"

#include "firmware/drive/drive.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/drive/phase_watch.h"
#include "firmware/drive/state_machine.h"
#include "firmware/drive/synchronism.h"

/* In looks of the following error, 1 ms each. */
#define SWING_LOOKS 100u
#define STAND_LOOKS 30u
#define AWAY_LOOKS  125u
#define DENIALS     50 /* samples */
#define STANDS      3u /* looks of phase_watch */

#define SWINGS      4u
#define SWING_TURNS NUM(1.0) /* electrical */
#define COUNTS_OFF  2.0
#define AT_LIMIT    0.99

void rotor_watch_reset(struct rotor_watch *watch, uint32_t period)
{
    watch->free = period;
    watch->denied = 0u;
    rotor_watch_reset_swing(&watch->swing);
}

void rotor_watch_reset_swing(struct rotor_swing *swing)
{
    swing->extreme = NUM(0.0);
    swing->side = 0;
    swing->times = 0u;
}

bool rotor_watch_swings(struct rotor_swing *swing, num_t error, num_t limit, uint32_t period,
                        uint32_t within)
{
    const int8_t side = error > limit ? 1 : error < -limit ? -1 : 0;
    const num_t size = num_abs(error);
    const bool is_back = swing->side == 0;
    const num_t on_its_way = is_back ? size - swing->extreme : swing->extreme - size;

    if (side != 0 && side != swing->side && (!is_back || on_its_way > num_half(limit))) {
        swing->times = swing->times > 0u && period - swing->turned < within
                           ? (uint8_t)(swing->times + 1u)
                           : (uint8_t)1u;
        swing->turned = period;
        swing->side = side;
        swing->extreme = size;
    } else if (on_its_way < NUM(0.0)) {
        swing->extreme = size;
    } else if (!is_back && on_its_way > num_half(limit)) {
        swing->side = 0;
        swing->extreme = size;
    }
    return swing->times >= SWINGS;
}

bool rotor_watch_stays_away(const struct rotor_swing *swing, uint32_t period, uint32_t longer)
{
    return swing->side != 0 && period - swing->turned > longer;
}

bool rotor_watch_jumps(struct rotor_watch *watch, struct position reference, num_t limit)
{
    const num_t moved = position_difference(reference, watch->reference);

    watch->reference = reference;
    return num_abs(moved) > limit;
}

/* Per-unit, a back-EMF is its speed. */
bool rotor_watch_winding_denies(const struct rotor_winding *winding, num_t margin)
{
    const struct phases i = winding->current;
    const num_t off = num_abs(i.a - winding->expected.a) + num_abs(i.b - winding->expected.b);
    const num_t of_currents =
        num_mul(winding->resistance + num_abs(winding->reactance), num_abs(i.a) + num_abs(i.b));
    const num_t unsure = num_half(of_currents + num_abs(winding->speed));

    return off > num_mul_coef(margin + unsure, winding->rate);
}

bool rotor_watch_denies(struct rotor_watch *watch, bool denies, struct phases expected,
                        uint32_t period)
{
    if (period == watch->expected_in) {
        watch->denied = (uint8_t)(denies ? watch->denied + (watch->denied < DENIALS) : 0);
    }
    watch->expected = expected;
    watch->expected_in = period + 1u;
    return watch->denied == DENIALS;
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
    const num_real turns_off = (num_real)COUNTS_OFF * (num_real)settings->motor.rotor_teeth /
                               (num_real)drive->board->facts->encoder_counts_per_turn;
    const num_real limit =
        (num_real)AT_LIMIT * (num_real)settings->current_limit_A / (num_real)drive->base.current_A;

    return num_abs(drive->current_reference.q) > num_from_double((double)limit) &&
           num_abs(error) < num_from_double((double)turns_off);
}

/* A current that stands is no rotor's: its phase or its sensor is another watch's. */
static bool currents_move(const struct drive *drive)
{
    const struct phase_watch *watch = &drive->phase_watch;

    return watch->count[0].looks < STANDS && watch->count[1].looks < STANDS &&
           !phase_watch_chatters(drive);
}

static bool winding_denies(struct drive *drive, uint32_t period)
{
    const num_t speed = drive->estimator.estimate.rotor.speed;
    const struct rotor_winding winding = {
        .current = measurement_current(&drive->measurement, &drive->params.measurement,
                                       drive->current_codes.a, drive->current_codes.b),
        .expected = drive->rotor_watch.expected,
        .speed = speed,
        .resistance = drive->estimator.estimate.winding.resistance,
        .reactance = num_mul_coef(speed, drive->params.current_control.reactance),
        .rate = drive->params.model.rate,
    };
    const bool denies =
        currents_move(drive) &&
        rotor_watch_winding_denies(&winding, drive->phase_watch_params.voltage_error);

    return rotor_watch_denies(&drive->rotor_watch, denies, drive->expectation.current, period);
}

static enum drive_fault look(struct drive *drive, uint32_t period)
{
    const struct following_error_params *following = &drive->params.following;
    const bool encoder = reads_encoder(&drive->settings);
    const bool watched = encoder ? following->limit > NUM(0.0) : synchronism_loss_is_fault(drive);
    const num_t error = position_difference(drive->reference.now.position,
                                            drive->estimator.estimate.rotor.position);
    const num_t limit = encoder ? following->limit : SWING_TURNS;

    if (rotor_watch_jumps(&drive->rotor_watch, drive->reference.now.position, limit)) {
        rotor_watch_reset_swing(&drive->rotor_watch.swing);
    }
    if (watched && (rotor_watch_swings(&drive->rotor_watch.swing, error, limit, period,
                                       SWING_LOOKS * following->periods) ||
                    (encoder && rotor_watch_stays_away(&drive->rotor_watch.swing, period,
                                                       AWAY_LOOKS * following->periods)))) {
        return encoder ? DRIVE_FAULT_FOLLOWING_ERROR : DRIVE_FAULT_STALLED;
    }
    return encoder && (winding_denies(drive, period) ||
                       rotor_watch_count_stands(&drive->rotor_watch, drive->encoder_count,
                                                is_pushed(drive, error), period,
                                                STAND_LOOKS * following->periods))
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
