/*
 * Field-oriented control as Kim 2016 (34) compares with: the mechanical controller (24)
 * (torque_demand.h), then a current tracking that cancels the winding and closes with the gain rho.
 * In the rotor frame
 *
 *   v_d = R i_d - N w L i_q* + rho L (i_d* - i_d)
 *   v_q = R i_q + Km w + N w L i_d* + f L (d/dt) i_q* + rho L (i_q* - i_q)
 *
 * rho is the current bandwidth unless it is given. The share f of the derivative, the gain
 * `inductance_feed_forward`, is 1 as published. Published cases: k1p = 1000, rho = 25000 and
 * k1p = 10000, rho = 10000 (as the text has it; the list prints 1000).
 */
#ifndef STEADYSTEP_FOC_H
#define STEADYSTEP_FOC_H

#include "firmware/control/inductive_voltage.h"
#include "firmware/control/torque_demand.h"

struct foc_law_params {
    struct torque_demand_params demand;
    struct inductive_voltage_params inductive;
    coef_t tracking; /* rho L */
    num_t current_error_limit;
};

static inline num_t *foc_law_current_limit(struct foc_law_params *params)
{
    return &params->demand.feedback.current_limit;
}

struct foc_law_state {
    struct torque_demand_state demand;
    num_t current; /* i_q* of the last period */
};

extern const struct law_gain_list foc_law_gains;

/* false: the loops cannot bear the bandwidths, the limit in error. */
__attribute__((cold)) bool foc_law_design(struct foc_law_params *params,
                                          const struct position_law_task *task,
                                          char error[DESIGN_ERROR_TEXT]);

struct voltage_demand foc_law_step(struct foc_law_state *state, const struct foc_law_params *params,
                                   const struct voltage_law_input *input);

#endif
