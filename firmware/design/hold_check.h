/*
 * The d-axis hold as the sampled loop that it is, and how well it is damped.
 *
 * The voltage that acts is known to the estimator, and the prediction to S(k+1) takes the period of
 * delay out of the loop. So the modes of the whole loop are those of the control, as if the rotor
 * were measured and without delay, and those of the estimation error (separation); the tests have
 * the loop in one piece and find the same modes (tests/reference/test_hold.cpp).
 *
 *   control     i_q, w, theta, integrator:  i_q* = -k_w w,  v_q = Kp (i_q* - i_q) + z + Km w
 *   estimation  i_q, w, theta, T_L, voltage offset; the gains of a settled hold or of a load step
 *
 * Both have the rotor on its spring, w_h^2 = N Km i_hold / J. The d axis is a first-order lag.
 */
#ifndef STEADYSTEP_HOLD_CHECK_H
#define STEADYSTEP_HOLD_CHECK_H

#include "firmware/design/hold_frequency.h"
#include "firmware/design/invariant_ekf_design.h"

/* Damping ratio below which a held rotor rings: a push is down to a tenth in 3.7 swings at 0.1. */
#define HOLD_DAMPING_MIN 0.1

/* Frequency of the held rotor times the period: beyond it 20 samples do not make a swing. */
#define HOLD_FREQUENCY_PERIOD_MAX 0.3

/*
 * Load step a, of the hold's largest torque Km i_hold, that an undamped rotor at rest bears: what
 * sin(x) - a leaves of the spring's torque has stopped it before it is pulled out,
 * sqrt(1 - a^2) + a asin(a) = pi a - 1.
 */
#define HOLD_LOAD_STEP_SHARE 0.7246

/* By so much two current channels and a warming winding leave the drop R i unknown. */
#define HOLD_DROP_ERROR 0.025

struct hold_task {
    const struct motor_params *motor;
    double period_s;
    double hold_current_A;
    double bandwidth_rad_s; /* of the state feedback whose damping the hold takes; NaN: default */
    double current_bandwidth_rad_s;
};

/* Lasting load, N m, that pulls the held rotor out of its place. */
static inline double hold_torque_Nm(const struct motor_params *motor, double hold_current_A)
{
    return motor->torque_constant_Nm_A * hold_current_A;
}

/* Heat, W, that the hold makes of the winding as long as it lasts. */
static inline double hold_heat_W(const struct motor_params *motor, double hold_current_A)
{
    return motor->resistance_ohm * hold_current_A * hold_current_A;
}

/*
 * Speed, rad/s, up to which the hold leads the rotor: an eighth of w_h, so that detent torque,
 * which comes four times per electrical turn, stays below the resonance, but no more than where the
 * back-EMF is 2.6 % of the supply and shows a load that the hold cannot see.
 */
double hold_creep_speed(const struct motor_params *motor, double hold_current_A);

/* Acceleration, rad/s^2, up to which it does: the rotor's inertia takes it back by a degree. */
double hold_creep_acceleration(const struct motor_params *motor, double hold_current_A);

/*
 * Default of the bandwidth, rad/s: 200 or a quarter of w_h, whichever is more, but no more than the
 * current loop bears (loop_bandwidth.h).
 */
double hold_bandwidth(const struct motor_params *motor, double hold_current_A,
                      double current_bandwidth_rad_s);

/*
 * Damping k_w of the hold, i_q* = -k_w w: twice the state feedback's gain of the speed, A per
 * rad/s. False, with the limit in `error`, if the loops cannot bear the bandwidths.
 */
bool hold_damping_design(const struct hold_task *task, double *damping_As_rad,
                         char error[DESIGN_ERROR_TEXT]);

/* Smallest damping ratio of the control's modes with k_w; negative: unstable. */
double hold_control_damping(const struct hold_task *task, double damping_As_rad);

/* The same of the estimation error with these gains; 1 if no mode swings. */
double hold_estimator_damping(const struct hold_task *task,
                              const struct invariant_ekf_gains *gains);

/*
 * What a settled hold's load estimate shows of a load step at most, before it returns to the load
 * before: a share.
 */
double hold_step_shown(const struct hold_task *task, const struct invariant_ekf_gains *settled);

/* False, with the quantity and its limit in `error`, if the held rotor swings too fast for the
   period or the control damps it by less than HOLD_DAMPING_MIN. */
bool hold_control_check(const struct hold_task *task, char error[DESIGN_ERROR_TEXT]);

/*
 * What HOLD_DROP_ERROR of the drop at rated current feigns as speed, r R i / Km, takes the
 * estimated angle along by this much, electrical degrees, within the 1/w_h in which the hold has
 * its rotor.
 */
double hold_drop_angle_deg(const struct hold_task *task);

/*
 * The damping of the estimation error in a settled hold and behind a load step; and that the angle
 * above is at most ANGLE_ERROR_MAX_DEG.
 */
bool hold_estimator_check(const struct hold_task *task,
                          const struct invariant_ekf_hold_gains *gains,
                          char error[DESIGN_ERROR_TEXT]);

#endif
