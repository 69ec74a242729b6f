#include "firmware/control/smc.h"

#include "firmware/control/voltage_limit.h"

enum { K1, K2, M, M_D, GAINS };

static const struct law_gain gains[GAINS] = {
    [K1] = SLIDING_MODE_GAIN_K1,
    [K2] = SLIDING_MODE_GAIN_K2,
    [M] = SLIDING_MODE_GAIN_M,
    [M_D] = {"M_d_V", 1e-2, 1e3},
};

const struct law_gain_list smc_law_gains = {gains, GAINS};

bool smc_law_design(struct smc_law_params *params, const struct position_law_task *task,
                    char error[DESIGN_ERROR_TEXT])
{
    const struct sliding_mode_task bandwidths = sliding_mode_task_of(task);
    const struct sliding_mode_gains derived = sliding_mode_gains_of(&bandwidths);
    const double voltage_V = law_gain_or(task, M, derived.voltage_V);

    (void)error;
    params->surface = sliding_surface_design(task, law_gain_or(task, K1, derived.k1_1_s2),
                                             law_gain_or(task, K2, derived.k2_1_s));
    params->voltage_q = num_from_double(voltage_V / task->base->voltage_V);
    params->voltage_d = num_from_double(law_gain_or(task, M_D, voltage_V) / task->base->voltage_V);
    return true;
}

/* -M sgn(s); 0 on the surface itself */
static num_t against(num_t s, num_t voltage)
{
    if (s > NUM(0.0)) {
        return -voltage;
    }
    return s < NUM(0.0) ? voltage : NUM(0.0);
}

struct voltage_demand smc_law_step(struct smc_law_state *state, const struct smc_law_params *params,
                                   const struct voltage_law_input *input)
{
    const struct tracking_error e = tracking_error_of(&params->surface, input);
    const struct dq wanted = {
        against(input->current.d - input->current_d_reference, params->voltage_d),
        against(sliding_surface(&params->surface, &e), params->voltage_q),
    };

    (void)state;
    return (struct voltage_demand){limit_voltage(wanted, input->voltage_limit), NUM(0.0)};
}
