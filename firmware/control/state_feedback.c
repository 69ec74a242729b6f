#include "firmware/control/state_feedback.h"

#include "firmware/design/state_feedback_design.h"

bool state_feedback_law_design(struct position_law_params *params,
                               const struct position_law_task *task, char error[DESIGN_ERROR_TEXT])
{
    struct state_feedback_gains k;

    if (!state_feedback_design(task->motor, task->period_s, task->bandwidth_rad_s,
                               task->current_bandwidth_rad_s, &k, error)) {
        return false;
    }
    const struct position_law_gains gains = {
        .position_A_rad = k.k_angle_A_rad,
        .speed_As_rad = k.k_speed_As_rad,
        .reference_friction_As_rad = k.k_speed_reference_As_rad - k.k_speed_As_rad,
        .reference_acceleration_As2_rad = k.k_acceleration_reference_As2_rad,
    };
    position_law_scale(params, task, &gains);
    return true;
}

/* K_L T_L: torque and q current are the same number in per-unit. */
num_t state_feedback_law_step(struct position_law_state *state,
                              const struct position_law_params *params,
                              const struct position_law_input *input)
{
    num_t current = position_law_proportional(params, input) + input->load_torque;

    (void)state;
    return num_limit(current, params->current_limit);
}
