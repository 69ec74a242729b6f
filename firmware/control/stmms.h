/*
 * Simplified torque-modulated microstepping, Kim 2016 (32): the mechanical controller (24)
 * (torque_demand.h) and, instead of a current control, the voltage at which the winding would carry
 * i_q* if it had no inductance, (28) in the rotor frame:
 *
 *   v_d = R i_d*,   v_q = R i_q* + Km w              (i_d* = 0 once a hold has been left)
 *
 * R is the calibrated series resistance. The law reads no current; the observer that gives it speed
 * and load does.
 *
 * What the inductance takes is missing: with x = N w L/R the q current is i_q* / (1 + x^2), so in
 * motion an error (T_L + Kv w) x^2 / (J k1p k2) remains, and beyond x = 4 the rotor is lost. A law
 * that is designed from its bandwidth refuses a speed limit beyond that. Laws that know L:
 * stmms_plus.h, foc.h.
 */
#ifndef STEADYSTEP_STMMS_H
#define STEADYSTEP_STMMS_H

#include "firmware/control/torque_demand.h"

struct stmms_law_params {
    struct torque_demand_params demand;
};

static inline num_t *stmms_law_current_limit(struct stmms_law_params *params)
{
    return &params->demand.feedback.current_limit;
}

struct stmms_law_state {
    struct torque_demand_state demand;
};

extern const struct law_gain_list stmms_law_gains;

/* false: bandwidth or speed limit cannot be had with this winding and period, the limit in error.
 */
bool stmms_law_design(struct stmms_law_params *params, const struct position_law_task *task,
                      char error[DESIGN_ERROR_TEXT]);

struct voltage_demand stmms_law_step(struct stmms_law_state *state,
                                     const struct stmms_law_params *params,
                                     const struct voltage_law_input *input);

#endif
