#include "firmware/drive/belt_watch.h"

#include "firmware/design/loop_bandwidth.h"
#include "firmware/drive/drive.h"
#include "firmware/drive/inductance.h"
#include "firmware/drive/interrupt_view.h"

#define SWINGS    12u
#define SOONEST_S 1.4e-3
#define LATEST_S  4e-3

static const double swing_rad_s = 125.0; /* electrical, from one side to the other */

void belt_watch_design(struct drive *drive, const struct drive_settings *given)
{
    if (!WATCHES_BELT) {
        return;
    }
    const double period_s = drive->board->facts->control_period_s;
    const double swing = swing_rad_s / drive->settings.motor.rotor_teeth;

    drive->belt_watch = (struct belt_watch){
        .swing = num_from_double(swing / drive->base.speed_rad_s),
        .soonest = (uint16_t)(SOONEST_S / period_s),
        .latest = (uint16_t)(LATEST_S / period_s),
        .watches = drive->settings.feedback == DRIVE_FEEDBACK_SENSORLESS &&
                   given->current_bandwidth_rad_s != given->current_bandwidth_rad_s,
    };
}

bool belt_watch_swings(struct belt_watch *watch, num_t error, uint32_t period)
{
    const num_t beyond = watch->falls ? watch->extreme - error : error - watch->extreme;

    if (beyond >= NUM(0.0)) {
        watch->extreme = error;
    } else if (beyond < -watch->swing) {
        const uint32_t since = period - watch->turned;
        const bool on_end = since >= watch->soonest && since <= watch->latest;

        watch->swings = on_end ? (uint8_t)(watch->swings + 1u) : (uint8_t)0u;
        watch->falls = !watch->falls;
        watch->turned = period;
        watch->extreme = error;
    }
    return watch->swings >= SWINGS;
}

void belt_watch_background(struct drive *drive)
{
    const uint32_t period = interrupt_view_period(drive);

    if (!WATCHES_BELT || !drive->belt_watch.watches ||
        interrupt_view_state(drive) != DRIVE_OPERATION_ENABLED) {
        return;
    }
    atomic_signal_fence(memory_order_seq_cst);
    const num_t error = drive->estimator.estimate.rotor.speed - drive->reference.now.speed;

    atomic_signal_fence(memory_order_seq_cst);
    if (period != interrupt_view_period(drive) ||
        !belt_watch_swings(&drive->belt_watch, error, period)) {
        return;
    }
    const double period_s = drive->board->facts->control_period_s;
    struct motor_params motor = drive->settings.motor;

    motor.inductance_H = inductance_in_force_H(drive);

    const struct current_control_params widest = current_control_design(
        &motor, &drive->base, period_s, CURRENT_BANDWIDTH_PERIOD_MAX / period_s);

    hal_defer_interrupts(drive->board, true);
    drive->params.current_control = widest;
    hal_defer_interrupts(drive->board, false);
    drive->belt_watch.watches = false;
    drive->belt_watch.seen = true;
}
