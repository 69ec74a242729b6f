/*
 * Continuous sliding-mode control with conditional integrators, Seshagiri and Khalil (3), (4), (7):
 *
 *   v_d = -M sat(s1/mu_d),   v_q = -M sat(s2/mu_q)
 *
 * Knows of the motor only what the surface needs (sliding_mode.h): neither R nor L, nor the
 * rotational voltages, which the integrators make up for at constant speed.
 *
 * With k0_d = k0_q = 0 it has no integrators, the comparison of section V.
 */
#ifndef STEADYSTEP_CSMC_H
#define STEADYSTEP_CSMC_H

#include "firmware/control/sliding_mode.h"

struct csmc_law_params {
    struct sliding_mode_params mode;
    struct conditional_integrator_params integrator_d;
    struct conditional_integrator_params integrator_q;
    coef_t voltage; /* M */
};

static inline num_t *csmc_law_current_limit(struct csmc_law_params *params)
{
    return &params->mode.surface.current_limit;
}

struct csmc_law_state {
    struct conditional_integrator d;
    struct conditional_integrator q;
};

extern const struct law_gain_list csmc_law_gains;

/* false: the sampled loop cannot bear a bandwidth that a gain follows from, the limit in error. */
bool csmc_law_design(struct csmc_law_params *params, const struct position_law_task *task,
                     char error[DESIGN_ERROR_TEXT]);

struct voltage_demand csmc_law_step(struct csmc_law_state *state,
                                    const struct csmc_law_params *params,
                                    const struct voltage_law_input *input);

#endif
