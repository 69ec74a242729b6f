/*
 * Constant gains of the invariant estimator: the steady-state Kalman gain of the current error
 * seen in the estimated rotor frame, at one design speed, of which only the even gains and one odd
 * gain are kept.
 *
 * Error model, eps = e^(-j N theta_est) (i - i_est), d real, q imaginary:
 *   d eps/dt    = -(R/L + j N w) eps + (Km/L) N w dtheta - j (Km/L) dw - b/L
 *   d dw/dt     = (Km/J) (eps_q - N i_d dtheta) - (Kv/J) dw - dT_L / J
 *   d dtheta/dt = dw
 *   d b/dt      = -b / tau          voltage bias in the frame, in hold only
 */
#ifndef STEADYSTEP_INVARIANT_EKF_DESIGN_H
#define STEADYSTEP_INVARIANT_EKF_DESIGN_H

#include <stdbool.h>

#include "firmware/design/refusal.h"
#include "firmware/motor/motor_params.h"

/*
 * With the innovation nu = e^(-j N theta_est) (i - i_est):
 *   i_est_d   += k_current_d nu_d        i_est_q   += k_current_q nu_q      (in the frame)
 *   w_est     += k_speed_q nu_q
 *   theta_est += k_angle_d sat(w_est / angle_d_full_speed) nu_d + k_angle_q nu_q
 *   T_L_est   += k_load_q nu_q
 *   b_d       += k_bias_d nu_d           b_q       += k_bias_q nu_q         (hold)
 * and in the prediction, once a period,
 *   b *= bias_decay, T_L_est *= load_decay, b subtracted from the voltage in the frame.
 */
struct invariant_ekf_gains {
    double k_current_d;              /* A per A */
    double k_current_q;              /* A per A */
    double k_speed_q_rad_As;         /* rad/s per A */
    double k_angle_d_rad_A;          /* mechanical rad per A; odd in the speed; 0 in hold */
    double k_angle_q_rad_A;          /* mechanical rad per A */
    double k_load_q_Nm_A;            /* N m per A */
    double angle_d_full_speed_rad_s; /* |w_est| above which k_angle_d acts in full */
    double k_bias_d_V_A;             /* V per A; 0 in motion */
    double k_bias_q_V_A;             /* V per A; 0 in motion */
    double bias_decay;               /* factor per period; 0 in motion: the bias is cleared */
    double load_decay;               /* factor per period; 1: the load estimate does not leak */
    double k_resistance_ohm_AV;      /* R_est += k_resistance i_d b_d per period; 0 in motion */
};

/* How the load estimate behaves in the d-axis hold. */
enum invariant_ekf_hold {
    INVARIANT_EKF_HOLD_ROBUST, /* bears 20 mA current offset and unmeasured dead time */
    INVARIANT_EKF_HOLD_FAST    /* follows a load step in a few ms; for measured voltages */
};

/* Gains in motion. False, with text in `error`, if the motor is outside what the model bears. */
bool invariant_ekf_motion_design(const struct motor_params *motor, double period_s,
                                 struct invariant_ekf_gains *gains, char error[DESIGN_ERROR_TEXT]);

/* Gains in the d-axis hold with `hold_current_A` > 0. */
bool invariant_ekf_hold_design(const struct motor_params *motor, double period_s,
                               double hold_current_A, enum invariant_ekf_hold hold,
                               struct invariant_ekf_gains *gains, char error[DESIGN_ERROR_TEXT]);

#endif
