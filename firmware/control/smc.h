/*
 * Ideal sliding-mode control, the yardstick of Seshagiri and Khalil, section IV:
 *
 *   v_d = -M sgn(s1*),   v_q = -M sgn(s2*)
 *
 * On a drive it chatters between +M and -M by design: for comparison in simulation. Both at once
 * are a vector of 1.4 M, and d is served first: without room for that in the bridge the d axis
 * needs a smaller M of its own, M_d_V, or nothing is left for the torque.
 */
#ifndef STEADYSTEP_SMC_H
#define STEADYSTEP_SMC_H

#include "firmware/control/sliding_mode.h"

struct smc_law_params {
    struct sliding_surface_params surface;
    num_t voltage_d;
    num_t voltage_q; /* M */
};

static inline num_t *smc_law_current_limit(struct smc_law_params *params)
{
    return &params->surface.current_limit;
}

struct smc_law_state {
    num_t none; /* C knows no empty struct */
};

extern const struct law_gain_list smc_law_gains;

/* Cannot refuse: without a boundary layer no bandwidth is too high. */
bool smc_law_design(struct smc_law_params *params, const struct position_law_task *task,
                    char error[DESIGN_ERROR_TEXT]);

struct voltage_demand smc_law_step(struct smc_law_state *state, const struct smc_law_params *params,
                                   const struct voltage_law_input *input);

#endif
