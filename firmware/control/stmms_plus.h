/*
 * STMMS (stmms.h) with the voltage that the inductance takes fed forward, still without reading a
 * current:
 *
 *   v_d = R i_d* - N w L i_q*
 *   v_q = R i_q* + Km w + N w L i_d* + f L (d/dt) i_q*
 *
 * The share f is the gain `inductance_feed_forward`, 0.8 unless given: what a count of the encoder
 * does to the voltage grows with it, the lag that is left, (1 - f) L/R, falls with it. Nothing but
 * R damps the current, and no current is compared with its reference: the torque is as good as R, L
 * and Km are known. The speed limit of stmms.h does not apply.
 */
#ifndef STEADYSTEP_STMMS_PLUS_H
#define STEADYSTEP_STMMS_PLUS_H

#include "firmware/control/inductive_voltage.h"
#include "firmware/control/torque_demand.h"

struct stmms_plus_law_params {
    struct torque_demand_params demand;
    struct inductive_voltage_params inductive;
};

static inline num_t *stmms_plus_law_current_limit(struct stmms_plus_law_params *params)
{
    return &params->demand.feedback.current_limit;
}

struct stmms_plus_law_state {
    struct torque_demand_state demand;
    num_t current; /* i_q* of the last period */
};

extern const struct law_gain_list stmms_plus_law_gains;

/* false: the period does not bear the bandwidth, the limit in error. */
bool stmms_plus_law_design(struct stmms_plus_law_params *params,
                           const struct position_law_task *task, char error[DESIGN_ERROR_TEXT]);

struct voltage_demand stmms_plus_law_step(struct stmms_plus_law_state *state,
                                          const struct stmms_plus_law_params *params,
                                          const struct voltage_law_input *input);

#endif
