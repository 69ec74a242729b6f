/*
 * The constant gain of Bendjedia's steady-state EKF: what (9), (10), (12) converge to at
 * standstill without current, with the paper's Q and R, on the Euler model (7), (8) in d-q.
 *
 * P0 has no part in it: the limit does not depend on P0. At standstill theta is not observable
 * in this model and P44 grows by Q44 each period for ever; the gain converges all the same.
 * A gain extracted while moving is unstable in its own direction at low speed and is not offered.
 */
#ifndef STEADYSTEP_STEADY_STATE_EKF_DESIGN_H
#define STEADYSTEP_STEADY_STATE_EKF_DESIGN_H

#include <stdbool.h>

#include "firmware/design/refusal.h"
#include "firmware/motor/motor_params.h"

/* The non-zero elements of K; rows i_d, i_q, w, theta, T_L, columns i_d, i_q. */
struct steady_state_ekf_gains {
    double k_current_d;      /* K11, A per A */
    double k_current_q;      /* K22, A per A */
    double k_speed_q_rad_As; /* K32, rad/s per A */
    double k_angle_q_rad_A;  /* K42, mechanical rad per A */
    double k_load_q_Nm_A;    /* K52, N m per A */
};

/* False, with text in `error`, if the Euler model of the motor is unstable at this period. */
bool steady_state_ekf_design(const struct motor_params *motor, double period_s,
                             struct steady_state_ekf_gains *gains, char error[DESIGN_ERROR_TEXT]);

#endif
