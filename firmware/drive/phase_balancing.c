#include "firmware/drive/phase_balancing.h"

#include "firmware/drive/inductance.h"

/* A rotor that is led is known by this estimator alone; and a voltage that is computed from what
   was commanded knows the phases less well than their difference is. */
static bool applies(const struct drive *drive, const struct drive_settings *settings)
{
    return settings->balance_phases && settings->hold_on_enable &&
           settings->feedback == DRIVE_FEEDBACK_SENSORLESS &&
           settings->estimator == DRIVE_ESTIMATOR_INVARIANT_EKF &&
           !drive->params.path.infers_voltage;
}

uint32_t phase_balancing_design(struct drive *drive, const struct drive_settings *settings,
                                double period_s)
{
    const struct phase_balance_task task = {
        .base = &drive->base,
        .motor = &settings->motor,
        .period_s = period_s,
        .hold_current_A = settings->hold_current_A,
    };

    if (!applies(drive, settings)) { /* its memory may be the alignment's */
        return 0u;
    }
    drive->enabling.balance_params = phase_balance_design(&task);
    drive->enabling.inductance_put.left = 0u;
    if (FINDS_INDUCTANCE) {
        drive->enabling.inductance_params = inductance_measurement_design(
            &drive->base, settings->hold_current_A,
            settings->identify_inductance && !settings->standstill_pulses
                ? drive->enabling.balance_params.look
                : 0u);
    }
    return phase_balance_periods(&drive->enabling.balance_params);
}

void phase_balancing_start(struct drive *drive)
{
    const struct phases drop_error = offset_calibration_drop_error(
        &drive->enabling.calibration, &drive->enabling.calibration_params,
        &drive->params.measurement, drive->estimator.estimate.winding.resistance);

    measurement_add_voltage_offset(&drive->measurement, drop_error);
    phase_balance_start(&drive->enabling.balance, drive->reference.next.position.fraction);
    inductance_measurement_start(&drive->enabling.inductance);
}

static void scale_currents(struct drive *drive)
{
    const num_t imbalance = drive->enabling.phase_imbalance;

    measurement_balance(&drive->measurement, imbalance);
    estimate_balance_currents(&drive->estimator.estimate, imbalance);
}

/* While the phases are compared, by means over whole swings. */
static void swing_current(struct drive *drive, const struct channels *winding)
{
    struct inductance_measurement *inductance = &drive->enabling.inductance;
    const struct sincos frame = drive->hold.frame;

    if (inductance_measurement_step(inductance, &drive->enabling.inductance_params,
                                    drive->estimator.estimate.winding.resistance,
                                    park(winding->voltage, frame).d,
                                    park(winding->current, frame).d)) {
        const num_t reference = drive->params.hold.current + inductance->level;

        standstill_hold_put_current(&drive->hold, reference);
        standstill_hold_preset(&drive->hold, reference);
    }
}

/* In a period of its own, for the longest path. */
__attribute__((noinline)) static enum phase_balancing put_inductance(struct drive *drive)
{
    const num_t more = inductance_measurement_result(&drive->enabling.inductance,
                                                     &drive->enabling.inductance_params,
                                                     drive->estimator.estimate.winding.admittance);

    drive->enabling.inductance.complete = false;
    return inductance_put(drive, more) ? PHASES_ARE_BEING_BALANCED : INDUCTANCE_DOES_NOT_MATCH;
}

enum phase_balancing phase_balancing_step(struct drive *drive, const struct hal_samples *samples)
{
    struct phase_balance *balance = &drive->enabling.balance;
    const struct phase_balance_params *params = &drive->enabling.balance_params;
    struct channels winding = {{NUM(0.0), NUM(0.0)}, {NUM(0.0), NUM(0.0)}};

    if (FINDS_INDUCTANCE && drive->enabling.inductance_put.left > 0u) {
        inductance_put_part(drive);
        return PHASES_ARE_BEING_BALANCED;
    }
    if (FINDS_INDUCTANCE && drive->enabling.inductance.complete) {
        return put_inductance(drive);
    }
    if (phase_balance_looks(balance)) {
        winding =
            measurement_step(&drive->measurement, &drive->params.measurement, samples).winding;
        if (FINDS_INDUCTANCE) {
            swing_current(drive, &winding);
        }
    }
    const enum phase_balance_event event = phase_balance_step(balance, params, &winding);

    drive->enabling.phase_imbalance = balance->imbalance;
    switch (event) {
    case PHASES_GO_ON:
        break;
    case PHASES_COMPARED:
        scale_currents(drive);
        drive->enabling.inductance.complete = drive->enabling.inductance_params.half != 0u;
        break;
    case PHASES_AT_FINAL:
        return PHASES_ARE_BALANCED;
    case PHASES_TOO_DIFFERENT:
        return PHASES_DO_NOT_MATCH;
    }
    const bool leads = phase_balance_leads(balance);

    if (balance->periods == 0u) { /* what a rotor that lags was taken for, at another angle */
        estimator_forget_bias(&drive->estimator, &drive->params.estimator);
    }
    if (leads || balance->periods == 0u) { /* else the frame stays where it is */
        standstill_hold_follow(
            &drive->hold, drive->reference.next.position.fraction + (angle_t)balance->held.offset,
            phase_balance_speed(balance, params), leads);
    }
    return PHASES_ARE_BEING_BALANCED;
}
