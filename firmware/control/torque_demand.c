#include "firmware/control/torque_demand.h"

bool torque_demand_needs_design(const struct position_law_task *task)
{
    return !law_gain_is_given(task, TORQUE_DEMAND_K1P) ||
           !law_gain_is_given(task, TORQUE_DEMAND_K0) || !law_gain_is_given(task, TORQUE_DEMAND_K2);
}

bool torque_demand_design(struct torque_demand_params *params, const struct position_law_task *task,
                          char error[DESIGN_ERROR_TEXT])
{
    const struct motor_params *motor = task->motor;
    const double km = motor->torque_constant_Nm_A;
    const double friction = motor->viscous_friction_Nms_rad / km;
    const double inertia = motor->inertia_kgm2 / km;
    struct mechanical_control_gains k = {0.0, 0.0, 0.0, 0.0};

    if (torque_demand_needs_design(task) &&
        !mechanical_control_design(motor, task->period_s, task->bandwidth_rad_s, &k, error)) {
        return false;
    }
    const double k1p = law_gain_or(task, TORQUE_DEMAND_K1P, k.k1p_per_s);
    const double k0 = law_gain_or(task, TORQUE_DEMAND_K0, k.k0_per_s3);
    const double k1 = law_gain_or(task, TORQUE_DEMAND_K1, k.k1_per_s2);
    const double k2 = law_gain_or(task, TORQUE_DEMAND_K2, k.k2_per_s);
    /* B w = B w* - B (w* - w) */
    const struct error_feedback_gains gains = {
        .position_A_rad = inertia * (k1 + k1p * k2),
        .speed_As_rad = inertia * (k1p + k2) - friction,
        .reference_friction_As_rad = friction,
        .reference_acceleration_As2_rad = inertia,
    };
    params->feedback = error_feedback_scale(task, &gains);
    params->integral =
        coef_from_double(TORQUE_DEMAND_INTEGRAL_SCALE * inertia * k0 * task->period_s *
                         task->base->rad_per_turn / task->base->current_A);
    params->load_compensation =
        coef_from_double(law_gain_or(task, TORQUE_DEMAND_LOAD_COMPENSATION, 1.0));
    params->integral_limit = num_from_double(TORQUE_DEMAND_INTEGRAL_SCALE * task->current_limit_A /
                                             task->base->current_A);
    return true;
}

/* More of the same sign would be in vain. */
static bool winds_up(num_t excess, num_t error)
{
    return (excess > NUM(0.0) && error > NUM(0.0)) || (excess < NUM(0.0) && error < NUM(0.0));
}

num_t torque_demand_step(struct torque_demand_state *state,
                         const struct torque_demand_params *params,
                         const struct position_law_input *input)
{
    const num_t position_error =
        num_headroom(input->position_error, params->feedback.position_error_limit);
    const num_t integral = state->integral + num_mul_coef(position_error, params->integral);
    const num_t demand = error_feedback(&params->feedback, input) +
                         num_mul_coef(input->load_torque, params->load_compensation) +
                         num_mul_unit(integral, UNIT(1.0 / TORQUE_DEMAND_INTEGRAL_SCALE));
    const num_t current = num_limit(demand, params->feedback.current_limit);

    if (!winds_up(demand - current, position_error) &&
        !winds_up(state->shortfall, position_error)) {
        state->integral = num_limit(integral, params->integral_limit);
    }
    return current;
}
