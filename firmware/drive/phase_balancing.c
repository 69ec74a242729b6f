#include "firmware/drive/phase_balancing.h"

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
    return phase_balance_periods(&drive->enabling.balance_params);
}

void phase_balancing_start(struct drive *drive)
{
    const struct phases drop_error = offset_calibration_drop_error(
        &drive->enabling.calibration, &drive->enabling.calibration_params,
        &drive->params.measurement, drive->estimator.estimate.winding.resistance);

    measurement_add_voltage_offset(&drive->measurement, drop_error);
    phase_balance_start(&drive->enabling.balance, drive->reference.next.position.fraction);
}

static void scale_currents(struct drive *drive)
{
    const num_t imbalance = drive->enabling.phase_imbalance;

    measurement_balance(&drive->measurement, imbalance);
    estimate_balance_currents(&drive->estimator.estimate, imbalance);
}

enum phase_balancing phase_balancing_step(struct drive *drive, const struct hal_samples *samples)
{
    struct phase_balance *balance = &drive->enabling.balance;
    const struct phase_balance_params *params = &drive->enabling.balance_params;
    struct channels winding = {{NUM(0.0), NUM(0.0)}, {NUM(0.0), NUM(0.0)}};

    if (phase_balance_looks(balance)) {
        winding =
            measurement_step(&drive->measurement, &drive->params.measurement, samples).winding;
    }
    const enum phase_balance_event event = phase_balance_step(balance, params, &winding);

    drive->enabling.phase_imbalance = balance->imbalance;
    switch (event) {
    case PHASES_GO_ON:
        break;
    case PHASES_COMPARED:
        scale_currents(drive);
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
