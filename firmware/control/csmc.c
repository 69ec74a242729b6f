#include "firmware/control/csmc.h"

#include "firmware/control/voltage_limit.h"

enum { K1, K2, MU_D, MU_Q, K0_D, K0_Q, M, GAINS };

static const struct law_gain gains[GAINS] = {
    [K1] = SLIDING_MODE_GAIN_K1,     [K2] = SLIDING_MODE_GAIN_K2,
    [MU_D] = SLIDING_MODE_GAIN_MU_D, [MU_Q] = SLIDING_MODE_GAIN_MU_Q,
    [K0_D] = SLIDING_MODE_GAIN_K0_D, [K0_Q] = SLIDING_MODE_GAIN_K0_Q,
    [M] = SLIDING_MODE_GAIN_M,
};

const struct law_gain_list csmc_law_gains = {gains, GAINS};

bool csmc_law_design(struct csmc_law_params *params, const struct position_law_task *task,
                     char error[DESIGN_ERROR_TEXT])
{
    const struct per_unit *base = task->base;
    const struct sliding_mode_task bandwidths = sliding_mode_task_of(task);
    const struct sliding_mode_gains derived = sliding_mode_gains_of(&bandwidths);
    const bool layers_given = law_gain_is_given(task, MU_D) && law_gain_is_given(task, MU_Q);
    const bool surface_given = law_gain_is_given(task, K1) && law_gain_is_given(task, K2);

    if ((!layers_given && !sliding_mode_current_bandwidth_check(&bandwidths, error)) ||
        (!surface_given && !sliding_mode_bandwidth_check(&bandwidths, error))) {
        return false;
    }
    params->surface = sliding_surface_design(task, law_gain_or(task, K1, derived.k1_1_s2),
                                             law_gain_or(task, K2, derived.k2_1_s));
    params->layer_d =
        boundary_layer_design(law_gain_or(task, MU_D, derived.mu_d_A) / base->current_A);
    params->layer_q = boundary_layer_design(law_gain_or(task, MU_Q, derived.mu_q_rad_s2) /
                                            base->acceleration_rad_s2);
    params->integrator_d =
        conditional_integrator_design(law_gain_or(task, K0_D, derived.k0_d_1_s), task->period_s);
    params->integrator_q =
        conditional_integrator_design(law_gain_or(task, K0_Q, derived.k0_q_1_s), task->period_s);
    params->voltage = coef_from_double(law_gain_or(task, M, derived.voltage_V) / base->voltage_V);
    return true;
}

struct voltage_demand csmc_law_step(struct csmc_law_state *state,
                                    const struct csmc_law_params *params,
                                    const struct voltage_law_input *input)
{
    const struct tracking_error e = tracking_error_of(&params->surface, input);
    const num_t levels_d =
        boundary_layer_levels(&params->layer_d, input->current.d - input->current_d_reference);
    const num_t levels_q =
        boundary_layer_levels(&params->layer_q, sliding_surface(&params->surface, &e));
    const num_t d = conditional_integrator_step(&state->d, &params->integrator_d, levels_d);
    const num_t q = conditional_integrator_step(&state->q, &params->integrator_q, levels_q);
    const struct dq wanted = {-num_mul_coef(d, params->voltage), -num_mul_coef(q, params->voltage)};

    return (struct voltage_demand){limit_voltage(wanted, input->voltage_limit), NUM(0.0)};
}
