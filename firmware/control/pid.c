#include "firmware/control/pid.h"

#include "firmware/design/pid_design.h"

bool pid_law_design(struct position_law_params *params, const struct position_law_task *task,
                    char error[DESIGN_ERROR_TEXT])
{
    struct pid_gains k;

    if (!pid_design(task->motor, task->period_s, task->bandwidth_rad_s,
                    task->current_bandwidth_rad_s, &k, error)) {
        return false;
    }
    const struct position_law_gains gains = {
        .position_A_rad = k.k_proportional_A_rad,
        .speed_As_rad = k.k_speed_As_rad,
        .reference_friction_As_rad = k.k_speed_reference_As_rad - k.k_speed_As_rad,
        .reference_acceleration_As2_rad = k.k_acceleration_reference_As2_rad,
    };
    position_law_scale(params, task, &gains);
    params->integral = coef_from_double(k.k_integral_step_A_rad * task->base->rad_per_turn /
                                        task->base->current_A);
    return true;
}

num_t pid_law_step(struct position_law_state *state, const struct position_law_params *params,
                   const struct position_law_input *input)
{
    num_t position_error = num_headroom(input->position_error, params->position_error_limit);
    num_t integral = state->integral + num_mul_coef(position_error, params->integral);
    num_t current = position_law_proportional(params, input) + integral;
    num_t limited = num_limit(current, params->current_limit);
    bool winds_up = (current > limited && position_error > NUM(0.0)) ||
                    (current < limited && position_error < NUM(0.0));

    if (!winds_up) {
        state->integral = num_limit(integral, params->current_limit);
    }
    return limited;
}
