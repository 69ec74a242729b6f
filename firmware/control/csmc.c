#include "firmware/control/csmc.h"

#include "firmware/control/voltage_limit.h"

enum { K0_D = SLIDING_MODE_GAINS, K0_Q, M, GAINS };

static const struct law_gain gains[GAINS] = {
    SLIDING_MODE_GAIN_LIST,
    [K0_D] = SLIDING_MODE_GAIN_K0_D,
    [K0_Q] = SLIDING_MODE_GAIN_K0_Q,
    [M] = SLIDING_MODE_GAIN_M,
};

const struct law_gain_list csmc_law_gains = {gains, GAINS};

bool csmc_law_design(struct csmc_law_params *params, const struct position_law_task *task,
                     char error[DESIGN_ERROR_TEXT])
{
    struct sliding_mode_gains in_force;

    if (!sliding_mode_design(&params->mode, &in_force, task, error)) {
        return false;
    }
    params->integrator_d =
        conditional_integrator_design(law_gain_or(task, K0_D, in_force.k0_d_1_s), task->period_s);
    params->integrator_q =
        conditional_integrator_design(law_gain_or(task, K0_Q, in_force.k0_q_1_s), task->period_s);
    params->voltage =
        coef_from_double(law_gain_or(task, M, in_force.voltage_V) / task->base->voltage_V);
    return true;
}

struct voltage_demand csmc_law_step(struct csmc_law_state *state,
                                    const struct csmc_law_params *params,
                                    const struct voltage_law_input *input)
{
    const struct tracking_error e = tracking_error_of(&params->mode.surface, input);
    const struct dq levels = sliding_mode_levels(&params->mode, input, &e);
    const num_t d = conditional_integrator_step(&state->d, &params->integrator_d, levels.d);
    const num_t q = conditional_integrator_step(&state->q, &params->integrator_q, levels.q);
    const struct dq wanted = {-num_mul_coef(d, params->voltage), -num_mul_coef(q, params->voltage)};

    return (struct voltage_demand){limit_voltage(wanted, input->voltage_limit), NUM(0.0)};
}
