/*
 * Constant gains of the invariant estimator: the steady-state Kalman gain of the current error
 * seen in the estimated rotor frame, at one design speed, of which only the even gains and one odd
 * gain are kept.
 *
 * Error model, eps = e^(-j N theta_est) (i - i_est), d real, q imaginary:
 *   d eps/dt    = -(R/L + j N w) eps + (Km/L) N w dtheta - j (Km/L) dw - b/L
 *   d dw/dt     = (Km/J) (eps_q - N i_d dtheta) - (Kv/J) dw - dT_L / J
 *   d dtheta/dt = dw
 * A voltage offset, constant in phase coordinates, enters as -b/L and turns with -N w in the frame.
 */
#ifndef STEADYSTEP_INVARIANT_EKF_DESIGN_H
#define STEADYSTEP_INVARIANT_EKF_DESIGN_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/design/refusal.h"
#include "firmware/motor/motor_params.h"

/*
 * With the innovation nu = e^(-j N theta_est) (i - i_est):
 *   i_est_d   += k_current_d nu_d        i_est_q   += k_current_q nu_q      (in the frame)
 *   w_est     += k_speed_q nu_q
 *   theta_est += k_angle_d sat(w_est / angle_d_full_speed) nu_d + k_angle_q nu_q
 *   T_L_est   += k_load_q nu_q
 *   b_q       += k_bias_d sat(w_est / angle_d_full_speed) nu_d + k_bias_q nu_q
 *   R_est     += k_resistance i_d nu_d
 * with b_q a step of the offset b in the direction of the frame's q axis; b is subtracted from the
 * measured voltage. In hold, where `away` is T_L_est - T_settled, also
 *   T_L_est   -= load_return away
 *   theta_est += angle_return away
 *   b_q       -= bias_return away
 *   T_settled += load_settle away
 */
struct invariant_ekf_gains {
    double k_current_d;      /* A per A */
    double k_current_q;      /* A per A */
    double k_speed_q_rad_As; /* rad/s per A */
    double k_angle_d_rad_A;  /* mechanical rad per A; odd in the speed; in hold 0 but of a step */
    double k_angle_q_rad_A;  /* mechanical rad per A */
    double k_load_q_Nm_A;    /* N m per A */
    double angle_d_full_speed_rad_s; /* |w_est| above which k_angle_d acts in full */
    double k_bias_d_V_A;             /* V per A; odd in the speed; 0 in hold */
    double k_bias_q_V_A;             /* V per A; 0 but in the unloaded hold */
    double k_resistance_ohm_A2;      /* ohm per A^2; 0 in motion */
    double load_return;              /* share per period; of the settled hold, else 0 */
    double angle_return_rad_Nm;      /* mechanical rad per N m and period; likewise */
    double bias_return_V_Nm;         /* V per N m and period; likewise */
    double load_settle;              /* share per period; while a load step is followed, else 0 */
};

/* The d-axis hold. */
struct invariant_ekf_hold_gains {
    struct invariant_ekf_gains quiet;     /* the load returns to what it was */
    struct invariant_ekf_gains following; /* behind a load step: the load is learned */
    struct invariant_ekf_gains unloaded;  /* no load is expected: the voltage offset is learned */
    uint32_t following_periods;           /* how long a load step is followed */
    uint32_t rest_periods;                /* behind that, in which none is */
    uint32_t swing_periods;               /* in which a rotor swings into place */
    double feigned_share;                 /* of a change of the load: what that may feign more */
    double load_step_Nm;                  /* change that ends the settled hold */
};

/* Of an estimated angle, electrical: half of what loses the rotor, and a little for parts that
   differ from the file's. */
#define ANGLE_ERROR_MAX_DEG 20.0

/* Gains in motion. False, with text in `error`, if the motor is outside what the model bears. */
bool invariant_ekf_motion_design(const struct motor_params *motor, double period_s,
                                 struct invariant_ekf_gains *gains, char error[DESIGN_ERROR_TEXT]);

/*
 * By how much a load step in motion throws the estimated angle before it is found, electrical rad,
 * by the linear model in i_q, w, theta and T_L. No more than a thousand periods are looked at.
 */
double invariant_ekf_thrown_rad(const struct motor_params *motor, double period_s,
                                const struct invariant_ekf_gains *gains, double load_step_Nm);

/* The same in degrees by the load step that a motor has to bear, 25 % of the rated torque. */
double invariant_ekf_thrown_deg(const struct motor_params *motor, double period_s,
                                const struct invariant_ekf_gains *gains);

/* Whether that is within ANGLE_ERROR_MAX_DEG; the motor is blind else. */
bool invariant_ekf_motion_check(const struct motor_params *motor, double period_s,
                                const struct invariant_ekf_gains *gains,
                                char error[DESIGN_ERROR_TEXT]);

/* Gains in the d-axis hold with `hold_current_A` > 0. */
bool invariant_ekf_hold_design(const struct motor_params *motor, double period_s,
                               double hold_current_A, struct invariant_ekf_hold_gains *gains,
                               char error[DESIGN_ERROR_TEXT]);

/*
 * A current's offset feigns a speed (drive_blind_speed_rad_s), and in a settled hold the load at
 * which as much angle returns; offsets in both phases 1.5 times that. Less is no step of the load:
 * a hold that followed it would move the rotor with the current that compensates it, and begin anew
 * before the offset is found.
 */
void invariant_ekf_bear_offset(double period_s, double feigned_speed_rad_s,
                               struct invariant_ekf_hold_gains *gains);

/* While a load step is followed nu_d shows the angle, too, where it is the back-EMF's: not with an
   error of the resistance, nor of the voltage. */
void invariant_ekf_find_angle_in_step(const struct invariant_ekf_gains *moving,
                                      struct invariant_ekf_hold_gains *hold);

/* The same in two parts, one behind the other, of half its time each. */
bool invariant_ekf_settled_hold_design(const struct motor_params *motor, double period_s,
                                       double hold_current_A,
                                       struct invariant_ekf_hold_gains *gains,
                                       char error[DESIGN_ERROR_TEXT]);
bool invariant_ekf_load_step_hold_design(const struct motor_params *motor, double period_s,
                                         double hold_current_A,
                                         struct invariant_ekf_hold_gains *gains,
                                         char error[DESIGN_ERROR_TEXT]);

#endif
