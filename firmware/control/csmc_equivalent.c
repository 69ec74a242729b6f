#include "firmware/control/csmc_equivalent.h"

#include "firmware/control/voltage_limit.h"

enum { K0_D = SLIDING_MODE_GAINS, K0_Q, RESISTANCE, INDUCTANCE, Q_D, Q_Q, GAINS };

static const struct law_gain gains[GAINS] = {
    SLIDING_MODE_GAIN_LIST,
    [K0_D] = SLIDING_MODE_GAIN_K0_D,
    [K0_Q] = SLIDING_MODE_GAIN_K0_Q,
    [RESISTANCE] = {"resistance_tolerance_ohm", 0.0, 1e3},
    [INDUCTANCE] = {"inductance_tolerance_H", 0.0, 1.0},
    [Q_D] = {"q_d_V", 0.0, 1e3},
    [Q_Q] = {"q_q_V", 0.0, 1e3},
};

const struct law_gain_list csmc_equivalent_law_gains = {gains, GAINS};

/* Of the paper: R within 20 +- 1 ohm, L within 35 +- 5 mH. */
#define RESISTANCE_TOLERANCE (1.0 / 20.0)
#define INDUCTANCE_TOLERANCE (5.0 / 35.0)

static const double term_limit = 8.0; /* per-unit, of each of three voltages */

static num_t error_limit(double gain)
{
    return num_from_double(gain * term_limit > term_limit ? term_limit / gain : term_limit);
}

bool csmc_equivalent_law_design(struct csmc_equivalent_law_params *params,
                                const struct position_law_task *task, char error[DESIGN_ERROR_TEXT])
{
    const struct motor_params *motor = task->motor;
    const struct per_unit *base = task->base;
    const double k3 = motor->torque_constant_Nm_A / motor->inertia_kgm2;
    const double k4 = motor->viscous_friction_Nms_rad / motor->inertia_kgm2;
    /* L/k3, from an acceleration per second to a voltage */
    const double jerk = motor->inductance_H / k3 * base->acceleration_rad_s2 / base->voltage_V;
    const double resistance_tolerance_ohm =
        law_gain_or(task, RESISTANCE, RESISTANCE_TOLERANCE * motor->resistance_ohm);
    const double inductance_tolerance_H =
        law_gain_or(task, INDUCTANCE, INDUCTANCE_TOLERANCE * motor->inductance_H);
    struct sliding_mode_gains in_force;

    if (!sliding_mode_design(&params->mode, &in_force, task, error)) {
        return false;
    }

    const double speed = in_force.k1_1_s2 * jerk * base->speed_rad_s / base->acceleration_rad_s2;
    const double acceleration = in_force.k2_1_s * jerk;

    params->integrator_d =
        conditional_integrator_design(law_gain_or(task, K0_D, in_force.k0_d_1_s), task->period_s);
    params->integrator_q =
        conditional_integrator_design(law_gain_or(task, K0_Q, in_force.k0_q_1_s), task->period_s);
    params->reactance = coef_from_double(per_unit_reactance(base, motor));
    params->voltage_of_speed = coef_from_double(speed);
    params->voltage_of_acceleration = coef_from_double(acceleration);
    params->voltage_of_friction = coef_from_double(k4 * jerk);
    params->voltage_of_jerk = coef_from_double(jerk / task->period_s);
    params->speed_limit = error_limit(speed);
    params->acceleration_limit = error_limit(acceleration);
    params->resistance_tolerance =
        coef_from_double(resistance_tolerance_ohm / base->resistance_ohm);
    params->inductance_tolerance = coef_from_double(inductance_tolerance_H / motor->inductance_H);
    params->least_d = num_from_double(law_gain_or(task, Q_D, in_force.voltage_V) / base->voltage_V);
    params->least_q = num_from_double(law_gain_or(task, Q_Q, in_force.voltage_V) / base->voltage_V);
    return true;
}

struct voltage_demand csmc_equivalent_law_step(struct csmc_equivalent_law_state *state,
                                               const struct csmc_equivalent_law_params *params,
                                               const struct voltage_law_input *input)
{
    const struct dq i = input->current;
    const struct tracking_error e = tracking_error_of(&params->mode.surface, input);
    const struct dq levels = sliding_mode_levels(&params->mode, input, &e);
    const num_t level_d = conditional_integrator_step(&state->d, &params->integrator_d, levels.d);
    const num_t level_q = conditional_integrator_step(&state->q, &params->integrator_q, levels.q);

    /* F^ in volts. Rotational voltages, and what moves the surface at constant voltage. */
    const num_t speed = input->motion.speed;
    const num_t reactance = num_mul_coef(speed, params->reactance);
    const num_t rotation_d = num_mul(reactance, i.q);
    const num_t rotation_q = num_mul(reactance, i.d);
    const num_t acceleration = e.acceleration + input->motion.reference_acceleration;
    const num_t sliding =
        num_mul_coef(num_headroom(e.speed, params->speed_limit), params->voltage_of_speed) +
        num_mul_coef(num_headroom(e.acceleration, params->acceleration_limit),
                     params->voltage_of_acceleration) -
        num_mul_coef(acceleration, params->voltage_of_friction);

    const num_t beta_d = num_mul_coef(num_abs(i.d), params->resistance_tolerance) +
                         num_mul_coef(num_abs(rotation_d), params->inductance_tolerance) +
                         params->least_d;
    const num_t beta_q = num_mul_coef(num_abs(i.q), params->resistance_tolerance) +
                         num_mul_coef(num_abs(sliding - rotation_q), params->inductance_tolerance) +
                         params->least_q;
    const struct dq wanted = {
        .d = num_mul(input->resistance, i.d) - rotation_d - num_mul(beta_d, level_d),
        .q = num_mul(input->resistance, i.q) + rotation_q + speed - sliding +
             num_mul_coef(input->reference_jerk, params->voltage_of_jerk) -
             num_mul(beta_q, level_q),
    };

    return (struct voltage_demand){limit_voltage(wanted, input->voltage_limit), NUM(0.0)};
}
