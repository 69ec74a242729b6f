#include "firmware/control/state_feedback.h"

#include "firmware/design/state_feedback_design.h"

const struct law_gain_list state_feedback_law_gains = {NULL, 0};

bool state_feedback_law_design(struct state_feedback_law_params *params,
                               const struct position_law_task *task, char error[DESIGN_ERROR_TEXT])
{
    struct state_feedback_gains k;

    if (!state_feedback_design(task->motor, task->period_s, task->bandwidth_rad_s,
                               task->current_bandwidth_rad_s, &k, error)) {
        return false;
    }
    const struct error_feedback_gains gains = {
        .position_A_rad = k.k_angle_A_rad,
        .speed_As_rad = k.k_speed_As_rad,
        .reference_friction_As_rad = k.k_speed_reference_As_rad - k.k_speed_As_rad,
        .reference_acceleration_As2_rad = k.k_acceleration_reference_As2_rad,
    };
    params->feedback = error_feedback_scale(task, &gains);
    return true;
}

/* K_L T_L: torque and q current are the same number in per-unit. */
num_t state_feedback_law_step(struct state_feedback_law_state *state,
                              const struct state_feedback_law_params *params,
                              const struct position_law_input *input)
{
    num_t current = error_feedback(&params->feedback, input) + input->load_torque;

    (void)state;
    return num_limit(current, params->feedback.current_limit);
}
