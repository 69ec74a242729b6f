#include "firmware/drive/belt_watch.h"

#include "firmware/design/loop_bandwidth.h"
#include "firmware/drive/drive.h"
#include "firmware/drive/inductance.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/drive/law_design.h"

#define SWINGS     12u
#define LATEST_S   4e-3
#define NARROWER   0.5
#define NARROWINGS 2

static const double swing_rad_s = 125.0; /* electrical, from one side to the other */

static bool given(double setting)
{
    return setting == setting;
}

void belt_watch_design(struct drive *drive, const struct drive_settings *settings)
{
    if (!WATCHES_BELT) {
        return;
    }
    const double period_s = drive->board->facts->control_period_s;
    const double swing = swing_rad_s / drive->settings.motor.rotor_teeth;

    drive->belt_watch = (struct belt_watch){
        .swing = num_from_double(swing / drive->base.speed_rad_s),
        .latest = (uint16_t)(LATEST_S / period_s),
        .narrowings = given(settings->law_bandwidth_rad_s) ? 0 : NARROWINGS,
        .widened = given(settings->current_bandwidth_rad_s),
        .watches = settings->feedback == DRIVE_FEEDBACK_SENSORLESS &&
                   settings->estimator == DRIVE_ESTIMATOR_INVARIANT_EKF,
    };
}

bool belt_watch_swings(struct belt_watch *watch, num_t value, uint32_t period)
{
    const num_t beyond = watch->falls ? watch->extreme - value : value - watch->extreme;

    if (beyond >= NUM(0.0)) {
        watch->extreme = value;
    } else if (beyond < -watch->swing) {
        const uint32_t since = period - watch->turned;
        const bool on_end = 4u * since >= watch->latest && since <= watch->latest;

        watch->swings = on_end ? (uint8_t)(watch->swings + 1u) : (uint8_t)0u;
        watch->falls = !watch->falls;
        watch->turned = period;
        watch->extreme = value;
    }
    return watch->swings >= SWINGS;
}

static void widen_current_loop(struct drive *drive)
{
    const double period_s = drive->board->facts->control_period_s;
    struct motor_params motor = drive->settings.motor;

    motor.inductance_H = inductance_in_force_H(drive);
    drive->settings.current_bandwidth_rad_s = CURRENT_BANDWIDTH_PERIOD_MAX / period_s;

    const struct current_control_params widest = current_control_design(
        &motor, &drive->base, period_s, drive->settings.current_bandwidth_rad_s);

    hal_defer_interrupts(drive->board, true);
    drive->params.current_control = widest;
    hal_defer_interrupts(drive->board, false);
    drive->belt_watch.widened = true;
}

static void narrow_law(struct drive *drive)
{
    union position_law_params law = drive->params.law;
    char error[DRIVE_ERROR_TEXT];

    drive->belt_watch.narrowings = (drive->belt_watch.narrowings - 1u) & 3u;
    drive->settings.law_bandwidth_rad_s *= NARROWER;
    if (law_design(drive, &drive->settings, &law, error)) {
        hal_defer_interrupts(drive->board, true);
        drive->params.law = law;
        hal_defer_interrupts(drive->board, false);
    } else {
        drive->settings.law_bandwidth_rad_s /= NARROWER; /* what is shown is in force */
    }
}

void belt_watch_background(struct drive *drive)
{
    const uint32_t period = interrupt_view_period(drive);
    struct belt_watch *watch = &drive->belt_watch;

    if (!WATCHES_BELT || !watch->watches ||
        interrupt_view_state(drive) != DRIVE_OPERATION_ENABLED) {
        return;
    }
    atomic_signal_fence(memory_order_seq_cst);
    num_t value = drive->estimator.estimate.rotor.speed - drive->reference.now.speed;

    if (watch->widened) {
        value = drive->current_reference.q;
        watch->swing = num_half(drive->params.hold.current_limit);
    }
    atomic_signal_fence(memory_order_seq_cst);
    if (period != interrupt_view_period(drive) || !belt_watch_swings(watch, value, period)) {
        return;
    }
    watch->swings = 0;
    if (!watch->widened) {
        widen_current_loop(drive);
    } else if (watch->narrowings > 0 && !drive->hold.active) {
        narrow_law(drive);
    }
}
