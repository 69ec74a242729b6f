#include "firmware/control/pid.h"

#include "firmware/design/pid_design.h"

const struct law_gain_list pid_law_gains = {NULL, 0};

bool pid_law_design(struct pid_law_params *params, const struct position_law_task *task,
                    char error[DESIGN_ERROR_TEXT])
{
    struct pid_gains k;

    if (!pid_design(task->motor, task->period_s, task->bandwidth_rad_s,
                    task->current_bandwidth_rad_s, &k, error)) {
        return false;
    }
    const struct error_feedback_gains gains = {
        .position_A_rad = k.k_proportional_A_rad,
        .speed_As_rad = k.k_speed_As_rad,
        .reference_friction_As_rad = k.k_speed_reference_As_rad - k.k_speed_As_rad,
        .reference_acceleration_As2_rad = k.k_acceleration_reference_As2_rad,
    };
    params->feedback = error_feedback_scale(task, &gains);
    params->integral = coef_from_double(k.k_integral_step_A_rad * task->base->rad_per_turn /
                                        task->base->current_A);
    return true;
}

num_t pid_law_step(struct pid_law_state *state, const struct pid_law_params *params,
                   const struct position_law_input *input)
{
    const struct error_feedback_params *feedback = &params->feedback;
    num_t position_error = num_headroom(input->position_error, feedback->position_error_limit);
    num_t integral = state->integral + num_mul_coef(position_error, params->integral);
    num_t current = error_feedback(feedback, input) + integral;
    num_t limited = num_limit(current, feedback->current_limit);
    bool winds_up = (current > limited && position_error > NUM(0.0)) ||
                    (current < limited && position_error < NUM(0.0));

    if (!winds_up) {
        state->integral = num_limit(integral, feedback->current_limit);
    }
    return limited;
}
