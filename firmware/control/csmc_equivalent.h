/*
 * Continuous sliding-mode control around the nominal equivalent control, Seshagiri and Khalil,
 * section III: surfaces and conditional integrators (3), (4), law (5) with a_ii of the nominal L,
 *
 *   v_d = R i_d - N w L i_q - beta_d sat(s1/mu_d)
 *   v_q = R i_q + N w L i_d + Km w + L/k3 (j* - k1 de2 - k2 dde2 + k4 dw/dt) - beta_q sat(s2/mu_q)
 *
 * and beta large enough for what the tolerances dR and dL of the motor can add, in volts:
 *
 *   beta_d = dR |i_d| + dL N |w i_q| + q_d
 *   beta_q = dR |i_q| + dL |k1 de2 + k2 dde2 - k4 dw/dt - k3 N w i_d|/k3 + q_q
 *
 * The paper takes q_d = 2.1 k0_d mu_d (L + dL) and q_q = 2.1 k0_q mu_q (L + dL)/k3, a volt: enough
 * for its motor and load, which are known but for R and L. By default q is the supply, as M in
 * csmc.h: it also bears bridge, detent and friction. Then the layers follow from the current
 * bandwidth.
 *
 * The nominal R is the drive's, calibrated where it calibrates; j* is left out of beta_q as in the
 * paper, whose reference is constant.
 */
#ifndef STEADYSTEP_CSMC_EQUIVALENT_H
#define STEADYSTEP_CSMC_EQUIVALENT_H

#include "firmware/control/sliding_mode.h"

struct csmc_equivalent_law_params {
    struct sliding_mode_params mode;
    struct conditional_integrator_params integrator_d;
    struct conditional_integrator_params integrator_q;
    coef_t reactance;               /* N L */
    coef_t voltage_of_speed;        /* k1 L/k3 */
    coef_t voltage_of_acceleration; /* k2 L/k3 */
    coef_t voltage_of_friction;     /* k4 L/k3 */
    coef_t voltage_of_jerk;         /* L/k3 */
    num_t speed_limit;              /* keeps the voltage of an error inside the number range */
    num_t acceleration_limit;
    coef_t resistance_tolerance; /* dR */
    coef_t inductance_tolerance; /* dL/L */
    num_t least_d;               /* q */
    num_t least_q;
};

static inline num_t *csmc_equivalent_law_current_limit(struct csmc_equivalent_law_params *params)
{
    return &params->mode.surface.current_limit;
}

struct csmc_equivalent_law_state {
    struct conditional_integrator d;
    struct conditional_integrator q;
};

extern const struct law_gain_list csmc_equivalent_law_gains;

/* false: the sampled loop cannot bear the bandwidth, the limit in error. */
__attribute__((cold)) bool csmc_equivalent_law_design(struct csmc_equivalent_law_params *params,
                                                      const struct position_law_task *task,
                                                      char error[DESIGN_ERROR_TEXT]);

struct voltage_demand csmc_equivalent_law_step(struct csmc_equivalent_law_state *state,
                                               const struct csmc_equivalent_law_params *params,
                                               const struct voltage_law_input *input);

#endif
