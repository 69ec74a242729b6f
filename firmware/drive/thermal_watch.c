#include "firmware/drive/thermal_watch.h"

#include "firmware/design/elementary.h"
#include "firmware/drive/drive.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/drive/settings_in_motion.h"
#include "firmware/drive/state_machine.h"

#define SLOT_PERIODS 8u
#define SPAN_SLOTS   32u
#define STEPS        64.0

/* 1 % more current than rated is a sensor's error; 15 % more heat are 12 K. */
static const double derating_begins = 1.02;
static const double derating_ends = 1.10;
static const double heat_of_fault = 1.15;

/* By so much it has to cool before derating is over. */
static const double hysteresis_heat = 0.02;
static const double hysteresis_K = 5.0;

/* Where in its slot the currents are looked at: a hash, the same in every run. */
static uint32_t place_of(uint32_t slot)
{
    const uint32_t mixed = slot * 0x9e3779b1u;

    return ((mixed ^ mixed >> 15) * 0x85ebca6bu) >> 29;
}

double thermal_watch_limit_A(const struct drive *drive, double limit_A, double along_A)
{
    const struct thermal_watch *watch = &drive->thermal;
    const double rated_A = drive->settings.motor.rated_current_A;
    const double least_A = smaller(limit_A, rated_A / STEPS);
    const double beside_A = square_root(rated_A * rated_A - along_A * along_A);
    const double excess_A = larger(limit_A - beside_A, 0.0);
    const double left_A = limit_A - excess_A * (double)watch->motor_derated / STEPS;

    return larger(left_A - left_A * (double)watch->bridge_derated / STEPS, least_A);
}

static uint8_t steps(double value, double from, double to)
{
    const double count = STEPS * (value - from) / (to - from);

    return count > 0.0 ? (uint8_t)smaller(count, STEPS) : 0u;
}

static void show(struct thermal_watch *watch, unsigned flag, bool begins, bool over)
{
    if (begins) {
        watch->shown |= (uint8_t)flag;
    } else if (over) {
        watch->shown &= (uint8_t)~flag;
    }
}

static enum drive_fault judge_winding(struct drive *drive)
{
    struct thermal_watch *watch = &drive->thermal;
    const double time_constant_s = drive->settings.motor_time_constant_s;
    const double rated = drive->settings.motor.rated_current_A / drive->base.current_A;
    const double span_s =
        (double)(SLOT_PERIODS * SPAN_SLOTS) * drive->board->facts->control_period_s;

    if (time_constant_s <= 0.0) {
        watch->winding = (struct winding_heat){.looks = 0};
    }
    winding_heat_pass(&watch->winding, span_s, time_constant_s, rated * rated);

    const double heat = winding_heat_most(&watch->winding);

    watch->heat = num_from_double(heat);
    watch->motor_derated = steps(heat, derating_begins, derating_ends);
    show(watch, THERMAL_MOTOR_DERATES, watch->motor_derated > 0u,
         heat < derating_begins - hysteresis_heat);
    return heat >= heat_of_fault ? DRIVE_FAULT_MOTOR_OVERHEATED : DRIVE_FAULT_NONE;
}

static enum drive_fault judge_bridge(struct drive *drive)
{
    struct thermal_watch *watch = &drive->thermal;
    const struct hal *board = drive->board;
    const double fault_C = drive->settings.bridge_fault_C;
    const double derate_C = drive->settings.bridge_derate_C;

    if (board->facts->bridge_ntc_beta_K <= 0.0) {
        return DRIVE_FAULT_NONE;
    }
    const bool plausible =
        bridge_thermometer_read(&watch->thermometer, board->bridge_temperature(board->context),
                                board->facts->converter_codes);
    const double bridge_C =
        bridge_thermometer_C(&watch->thermometer, board->facts->bridge_ntc_beta_K);
    const bool watched = plausible && fault_C > 0.0;

    watch->bridge_C = plausible && bridge_C > 0.0 ? (uint32_t)bridge_C : 0u;
    watch->bridge_derated = watched ? steps(bridge_C, derate_C, fault_C) : 0u;
    show(watch, THERMAL_NO_SENSOR, !plausible && fault_C > 0.0, true);
    show(watch, THERMAL_BRIDGE_DERATES, watch->bridge_derated > 0u,
         bridge_C < derate_C - hysteresis_K || !watched);
    return watched && bridge_C >= fault_C ? DRIVE_FAULT_BRIDGE_OVERHEATED : DRIVE_FAULT_NONE;
}

/* A resistance that has just been calibrated says how hot the winding is. */
static void begin(struct drive *drive)
{
    const struct drive_settings *settings = &drive->settings;
    const double resistance_ohm =
        num_to_double(drive->estimator.estimate.winding.resistance) * drive->base.resistance_ohm;

    if (settings->cold_resistance_ohm > 0.0 && settings->motor_time_constant_s > 0.0 &&
        settings->feedback == DRIVE_FEEDBACK_SENSORLESS && settings->resistance_adaptation) {
        winding_heat_begin(&drive->thermal.winding, resistance_ohm / settings->cold_resistance_ohm);
    }
}

/* The limits, from what was set. */
static void derate(struct drive *drive)
{
    struct thermal_watch *watch = &drive->thermal;
    struct drive_settings wanted = drive->settings;
    char refusal[DRIVE_ERROR_TEXT];

    wanted.current_limit_A = watch->limit_A;
    watch->motor_in_force = watch->motor_derated;
    watch->bridge_in_force = watch->bridge_derated;
    (void)settings_in_motion_change(drive, &wanted, refusal);
}

/* Every span. */
static void judge(struct drive *drive)
{
    struct thermal_watch *watch = &drive->thermal;
    const bool ready = interrupt_view_state(drive) == DRIVE_OPERATION_ENABLED;

    if (ready && !watch->ready) {
        begin(drive);
    }
    watch->ready = ready;

    const enum drive_fault of_motor = judge_winding(drive);
    const enum drive_fault of_bridge = judge_bridge(drive);

    if (!ready) {
        return;
    }
    if (watch->motor_derated != watch->motor_in_force ||
        watch->bridge_derated != watch->bridge_in_force) {
        derate(drive);
    }
    if (of_motor != DRIVE_FAULT_NONE || of_bridge != DRIVE_FAULT_NONE) {
        state_machine_ask_for_fault(drive, of_motor != DRIVE_FAULT_NONE ? of_motor : of_bridge);
    }
}

/* None while nothing controls. */
static struct phases current_of(const struct drive *drive)
{
    const enum drive_state state = interrupt_view_state(drive);

    return state == DRIVE_OPERATION_ENABLED || state == DRIVE_ALIGNING
               ? measurement_current(&drive->measurement, &drive->params.measurement,
                                     drive->current_codes.a, drive->current_codes.b)
               : (struct phases){NUM(0.0), NUM(0.0)};
}

void thermal_watch_background(struct drive *drive)
{
    struct thermal_watch *watch = &drive->thermal;
    const uint32_t period = interrupt_view_period(drive);
    const uint32_t slot = period / SLOT_PERIODS;

    if (slot == watch->slot || period % SLOT_PERIODS < place_of(slot) || period == UINT32_MAX) {
        return;
    }
    atomic_signal_fence(memory_order_seq_cst);
    const struct phases current = current_of(drive);
    atomic_signal_fence(memory_order_seq_cst);

    if (period != interrupt_view_period(drive)) {
        return; /* an interrupt has come in between */
    }
    if (slot / SPAN_SLOTS != watch->slot / SPAN_SLOTS) {
        judge(drive);
    }
    winding_heat_look(&watch->winding, current);
    watch->slot = slot;
}
