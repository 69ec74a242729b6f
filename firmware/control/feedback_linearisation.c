#include "firmware/control/feedback_linearisation.h"

#include "firmware/control/voltage_limit.h"
#include "firmware/design/elementary.h"
#include "firmware/design/feedback_linearisation_design.h"
#include "firmware/design/motor_check.h"

enum { DAMPING, VOLTAGE_DISTURBANCE, JERK, LOAD, GAINS };

static const struct law_gain gains[GAINS] = {
    [DAMPING] = {"damping", 0.1, 1.0},
    [VOLTAGE_DISTURBANCE] = {"voltage_disturbance_rad_s", 0.0, 1e6},
    [JERK] = {"jerk_feed_forward", 0.0, 1.0},
    [LOAD] = {"load_compensation", 0.0, 1.0},
};

const struct law_gain_list feedback_linearisation_law_gains = {gains, GAINS};

/* Found on the plant `real`: between ringing and lag, and between noise and error at speed. */
static const double default_damping = 0.7;
static const double default_voltage_disturbance_rad_s = 1000.0;

/* Per-unit bound of one of the terms of d_q: all of them together stay below NUM_MAX. */
static const double term_limit = 8.0;

/* Of the current limit, for braking from a large error; the rest is for load and control. */
static const double braking_share = 0.6;

/* Electrical turns; times twice the largest position error it stays inside the number range. */
#define BRAKING_ERROR_MAX 1.0

static unit_t ratio(double x)
{
    return unit_from_num(num_from_double(x));
}

bool feedback_linearisation_law_design(struct feedback_linearisation_law_params *params,
                                       const struct position_law_task *task,
                                       char error[DESIGN_ERROR_TEXT])
{
    const struct motor_params *motor = task->motor;
    const struct per_unit *base = task->base;
    const double period_s = task->period_s;
    const struct feedback_linearisation_poles poles = {
        .law_bandwidth_rad_s = task->bandwidth_rad_s,
        .damping = law_gain_or(task, DAMPING, default_damping),
        .current_bandwidth_rad_s = task->current_bandwidth_rad_s,
    };
    struct feedback_linearisation_gains k;

    if (!motor_check(motor, period_s, error) ||
        !feedback_linearisation_design(period_s, &poles, &k, error)) {
        return false;
    }
    const double position = k.k_position_s2 * base->rad_per_turn / base->acceleration_rad_s2;
    const double speed = k.k_speed_s * base->speed_rad_s / base->acceleration_rad_s2;
    const double x = poles.current_bandwidth_rad_s * period_s;
    const double decay = motor->resistance_ohm * period_s / motor->inductance_H;
    const double stiffness_ohm =
        motor->inductance_H / period_s / exponential_phi1(-decay) - 0.5 * motor->resistance_ohm;
    const double turn = (double)motor->rotor_teeth * base->speed_rad_s * period_s;
    const double voltage_disturbance_rad_s =
        law_gain_or(task, VOLTAGE_DISTURBANCE, default_voltage_disturbance_rad_s);

    /* A small error e is closed at the speed s e, s = k_theta/k_w, which asks for s^2 e of braking.
     */
    const double approach_per_s = k.k_position_s2 / k.k_speed_s;
    const double braking_rad_s2 =
        motor->torque_constant_Nm_A * task->current_limit_A / motor->inertia_kgm2;
    const double braking_turns =
        braking_rad_s2 / (approach_per_s * approach_per_s) / base->rad_per_turn;

    params->disturbance =
        voltage_disturbance_design(motor, base, period_s, voltage_disturbance_rad_s);
    params->disturbed =
        task->delay_periods == 0u ? coef_from_double(0.0) : params->disturbance.admittance;
    params->position = coef_from_double(position);
    params->speed = coef_from_double(speed);
    params->acceleration = coef_from_double(k.k_acceleration);
    params->field = ratio(x * exponential_phi1(-x));
    params->jerk = ratio(law_gain_or(task, JERK, 1.0));
    params->load = ratio(law_gain_or(task, LOAD, 1.0));
    params->friction =
        coef_from_double(motor->viscous_friction_Nms_rad * base->speed_rad_s / base->torque_Nm);
    params->stiffness = coef_from_double(stiffness_ohm / base->resistance_ohm);
    params->reactance = coef_from_double(per_unit_reactance(base, motor));
    params->droop = coef_from_double(turn * turn / 24.0);
    params->half_speed =
        coef_from_double(0.5 * period_s * base->acceleration_rad_s2 / base->speed_rad_s);
    params->braking_error =
        num_from_double(smaller(braking_share * braking_turns, BRAKING_ERROR_MAX));
    params->position_error_limit =
        num_from_double(smaller(term_limit / position, POSITION_DIFFERENCE_MAX));
    params->speed_error_limit = num_from_double(
        smaller(2.0 * task->speed_limit_rad_s / base->speed_rad_s, term_limit / speed));
    params->current_limit = num_from_double(task->current_limit_A / base->current_A);
    return true;
}

/* The currents at the instant of action; without a delay they are measured as they are. */
static struct dq disturbed_current(const struct feedback_linearisation_law_params *params,
                                   struct dq current, struct dq disturbance)
{
    return (struct dq){current.d + num_mul_coef(disturbance.d, params->disturbed),
                       current.q + num_mul_coef(disturbance.q, params->disturbed)};
}

/*
 * The error that asks for the speed from which the rotor can still brake. Beyond e0 the approach
 * speed s e gives way to the parabola of constant braking s^2 e0, which touches it there.
 */
static num_t approach_error(const struct feedback_linearisation_law_params *params, num_t error)
{
    const num_t e0 = params->braking_error;
    const num_t distance = num_abs(error);

    if (distance > e0) {
        const num_t braked = num_sqrt(num_mul(distance + distance - e0, e0));

        error = error > NUM(0.0) ? braked : -braked;
    }
    return num_headroom(error, params->position_error_limit);
}

static num_t wanted_change(const struct feedback_linearisation_law_params *params,
                           const struct voltage_law_input *input, num_t acceleration)
{
    const struct position_law_input *motion = &input->motion;
    const num_t position_error = approach_error(params, motion->position_error);
    const num_t speed_error =
        num_limit(motion->reference_speed - motion->speed, params->speed_error_limit);

    return num_mul_coef(position_error, params->position) +
           num_mul_coef(speed_error, params->speed) +
           num_mul_coef(motion->reference_acceleration - acceleration, params->acceleration) +
           num_mul_unit(input->reference_jerk, params->jerk) + input->load_torque_change;
}

/*
 * The inverse of motor_model.h for the frame of the middle of the period; h = N w T,
 * droop = h^2/24, cos h/2 = 1 - 3 droop, sin h/2 = h/2 (1 - droop).
 */
static struct dq winding_voltage(const struct feedback_linearisation_law_params *params,
                                 const struct voltage_law_input *input, struct dq mean,
                                 struct dq change, num_t acceleration)
{
    const num_t speed = input->motion.speed + num_mul_coef(acceleration, params->half_speed);
    const num_t droop = num_mul_coef(num_mul(speed, speed), params->droop);
    const num_t turning = speed - num_mul(droop, speed);
    const num_t reactance = num_mul_coef(turning, params->reactance);
    const num_t along = NUM(1.0) - droop - droop - droop;
    const struct dq drop = {
        num_mul(input->resistance, mean.d) + num_mul_coef(change.d, params->stiffness),
        num_mul(input->resistance, mean.q) + num_mul_coef(change.q, params->stiffness)};

    return (struct dq){num_mul(drop.d, along) - num_mul(reactance, mean.q),
                       num_mul(drop.q, along) + num_mul(reactance, mean.d) + turning};
}

struct voltage_demand
feedback_linearisation_law_step(struct feedback_linearisation_law_state *state,
                                const struct feedback_linearisation_law_params *params,
                                const struct voltage_law_input *input)
{
    const num_t speed = input->motion.speed;
    const num_t load = num_mul_unit(input->motion.load_torque, params->load);
    const struct dq disturbance =
        voltage_disturbance_step(&state->disturbance, &params->disturbance, input->innovation);
    const struct dq current = disturbed_current(params, input->undisturbed_current, disturbance);
    const num_t acceleration = current.q - load - num_mul_coef(speed, params->friction);
    const num_t wanted = current.q + wanted_change(params, input, acceleration);
    const num_t target = num_limit(wanted, params->current_limit);
    const struct dq change = {num_mul_unit(input->current_d_reference - current.d, params->field),
                              target - current.q};
    const struct dq mean = {current.d + num_half(change.d), current.q + num_half(change.q)};
    const struct dq voltage = winding_voltage(params, input, mean, change, acceleration);
    const struct dq demand = {voltage.d - disturbance.d, voltage.q - disturbance.q};

    return (struct voltage_demand){limit_voltage(demand, input->voltage_limit), target};
}
