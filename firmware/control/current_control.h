/*
 * d-q current control of Bendjedia 2012 (4)-(6): a PI per axis on the linear part, the rotational
 * voltages fed forward, the vector limited with d first, integrators unwound by what the limit
 * took away.
 *
 *   v_d = Kp (i_d* - i_d) + z_d - N w L i_q
 *   v_q = Kp (i_q* - i_q) + z_q + N w L i_d + Km w
 *   z  += Ki (i* - i) + (Ki/Kp) (v_limited - v)
 *
 * Kp = L w_c and Ki = R w_c T cancel the winding's pole, so the loop closes with the bandwidth w_c.
 * The currents are those predicted for S(k+1), where the voltage begins to act; that takes the
 * period of delay out of the loop.
 */
#ifndef STEADYSTEP_CURRENT_CONTROL_H
#define STEADYSTEP_CURRENT_CONTROL_H

#include "firmware/motor/motor_params.h"
#include "firmware/motor/park.h"
#include "firmware/motor/per_unit.h"

struct current_control_params {
    coef_t proportional;
    coef_t integral;
    coef_t unwind;    /* Ki/Kp */
    coef_t reactance; /* N L: voltage per speed and current */
};

struct current_control {
    struct dq integral; /* z */
};

struct current_control_params current_control_design(const struct motor_params *motor,
                                                     const struct per_unit *base, double period_s,
                                                     double bandwidth_rad_s);

void current_control_reset(struct current_control *control);

/* Voltage in the control frame, of magnitude at most voltage_limit. */
struct dq current_control_step(struct current_control *control,
                               const struct current_control_params *params, struct dq reference,
                               struct dq current, num_t speed, num_t voltage_limit);

#endif
