#include "firmware/drive/thermal_watch.h"

#include "firmware/drive/drive.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/drive/settings_in_motion.h"
#include "firmware/drive/state_machine.h"

/* A share of the samples, whatever their period; heat goes by seconds. */
#define SLOT_PERIODS 8u
#define SPAN_PERIODS (SLOT_PERIODS * WINDING_LOOKS)
#define STEPS        64

/* 1 % more current than rated is a sensor's error; 15 % more heat are 12 K. */
#define HEAT_DERATES  1.02
#define HEAT_DERATED  1.10
#define HEAT_OF_FAULT 1.15

#define RATED 0.5 /* current in per-unit */

void thermal_watch_design(struct drive *drive)
{
    const struct hal_facts *facts = drive->board->facts;
    const struct drive_settings *settings = &drive->settings;
    const num_real beta_K = (num_real)facts->bridge_ntc_beta_K;
    const num_real fault_C = (num_real)settings->bridge_fault_C;
    struct thermal_watch *watch = &drive->thermal;

    watch->limit_A = settings->current_limit_A;
    watch->motor_in_force = watch->bridge_in_force = 0u;
    watch->fault_code = 0u;
    if (beta_K > 0 && fault_C > 0) {
        watch->derate_code = (uint16_t)bridge_temperature_code((num_real)settings->bridge_derate_C,
                                                               beta_K, facts->converter_codes);
        watch->fault_code =
            (uint16_t)bridge_temperature_code(fault_C, beta_K, facts->converter_codes);
    }
}

void thermal_watch_set_limit(struct thermal_watch *watch, double limit_A)
{
    watch->limit_A = limit_A;
}

/* Where in its slot the currents are looked at: no two slots go together. */
static uint32_t place_of(uint32_t slot)
{
    return slot * slot * 0x9e3779b1u >> 29;
}

/* Never all of it: a law divides by what its limit lets it brake with. */
static num_t less_steps(num_t of, uint32_t steps)
{
    return num_mul_unit(of, UNIT(1.0 / (STEPS + 1))) * (num_t)steps;
}

num_t thermal_watch_limit(const struct thermal_watch *watch, num_t limit, num_t along)
{
    const num_t square = NUM(RATED * RATED) - num_mul(along, along);
    const num_t excess = limit - (square > NUM(0.0) ? num_sqrt(square) : NUM(0.0));
    num_t left = limit;

    if (excess > NUM(0.0)) {
        left -= less_steps(excess, watch->motor_derated);
    }
    return left - less_steps(left, watch->bridge_derated);
}

/* Begins and ends a step apart. */
static void show(struct thermal_watch *watch, unsigned flag, uint32_t steps)
{
    if (steps > 1u) {
        watch->shown |= (uint8_t)flag;
    } else if (steps == 0u) {
        watch->shown &= (uint8_t)~flag;
    }
}

static enum drive_fault judge_winding(struct drive *drive)
{
    struct thermal_watch *watch = &drive->thermal;
    const num_real span_s =
        (num_real)SPAN_PERIODS * (num_real)drive->board->facts->control_period_s;
    const num_real time_constant_s = (num_real)drive->settings.motor_time_constant_s;
    num_t step = NUM(HEAT_DERATES);
    uint8_t steps = 0;

    if (time_constant_s > 0) {
        winding_heat_pass(&watch->winding, span_s, time_constant_s);
    } else {
        watch->winding = (struct winding_heat){.looks = 0};
    }
    watch->heat = winding_heat_most(&watch->winding);
    while (steps < STEPS && (step += NUM((HEAT_DERATED - HEAT_DERATES) / STEPS)) <= watch->heat) {
        steps++;
    }
    watch->motor_derated = steps;
    show(watch, THERMAL_MOTOR_DERATES, steps);
    return watch->heat > NUM(HEAT_OF_FAULT) ? DRIVE_FAULT_MOTOR_OVERHEATED : DRIVE_FAULT_NONE;
}

static enum drive_fault judge_bridge(struct thermal_watch *watch, const struct hal *board)
{
    const uint32_t derate = watch->derate_code;
    const uint32_t fault = watch->fault_code;

    if (fault == 0u) {
        watch->bridge_derated = 0u;
        return DRIVE_FAULT_NONE;
    }
    const uint32_t code = board->bridge_temperature(board->context);
    const bool broken = bridge_temperature_is_implausible(code, board->facts->converter_codes);
    const uint32_t beyond = derate > code && !broken ? derate - code : 0u;
    const uint32_t steps = beyond * STEPS / (derate > fault ? derate - fault : 1u);

    watch->bridge_derated = (uint8_t)(steps < STEPS ? steps : STEPS);
    show(watch, THERMAL_NO_SENSOR, broken ? STEPS : 0u);
    show(watch, THERMAL_BRIDGE_DERATES, watch->bridge_derated);
    return code <= fault && !broken ? DRIVE_FAULT_BRIDGE_OVERHEATED : DRIVE_FAULT_NONE;
}

/* A resistance that has just been calibrated. */
static void begin(struct drive *drive)
{
    const num_real cold_ohm = (num_real)drive->settings.cold_resistance_ohm;
    const num_real ohm = (num_real)num_to_double(drive->estimator.estimate.winding.resistance) *
                         (num_real)drive->base.resistance_ohm;

    if (cold_ohm > 0) {
        winding_heat_begin(&drive->thermal.winding, ohm / cold_ohm);
    }
}

/* Every span. */
static void judge(struct drive *drive)
{
    struct thermal_watch *watch = &drive->thermal;
    const bool ready = interrupt_view_state(drive) == DRIVE_OPERATION_ENABLED;
    const enum drive_fault of_bridge = judge_bridge(watch, drive->board);
    const enum drive_fault of_motor = judge_winding(drive);

    if (!ready) {
        return;
    }
    if (interrupt_view_period(drive) - interrupt_view_state_since(drive) <=
        SPAN_PERIODS + SLOT_PERIODS) {
        begin(drive);
    }
    if (watch->motor_derated != watch->motor_in_force ||
        watch->bridge_derated != watch->bridge_in_force) {
        settings_in_motion_derate(drive);
        watch->motor_in_force = watch->motor_derated;
        watch->bridge_in_force = watch->bridge_derated;
    }
    if (of_motor != DRIVE_FAULT_NONE || of_bridge != DRIVE_FAULT_NONE) {
        state_machine_ask_for_fault(drive, of_motor != DRIVE_FAULT_NONE ? of_motor : of_bridge);
    }
}

void thermal_watch_background(struct drive *drive)
{
    struct thermal_watch *watch = &drive->thermal;
    const uint32_t period = interrupt_view_period(drive);
    const uint32_t slot = period / SLOT_PERIODS;
    const enum drive_state state = interrupt_view_state(drive);
    struct phases current = {NUM(0.0), NUM(0.0)};

    if (slot == watch->slot || period % SLOT_PERIODS < place_of(slot) || period == UINT32_MAX) {
        return;
    }
    atomic_signal_fence(memory_order_seq_cst);
    if (state == DRIVE_OPERATION_ENABLED || state == DRIVE_ALIGNING) {
        current = measurement_current(&drive->measurement, &drive->params.measurement,
                                      drive->current_codes.a, drive->current_codes.b);
    }
    atomic_signal_fence(memory_order_seq_cst);
    if (period != interrupt_view_period(drive)) {
        return; /* an interrupt has come in between */
    }
    if (slot / WINDING_LOOKS != watch->slot / WINDING_LOOKS) {
        judge(drive);
    }
    winding_heat_look(&watch->winding, current);
    watch->slot = slot;
}
