/*
 * Gains of the mechanical controller of Kim 2016 (24) from one bandwidth:
 *
 *   k2 = w0,   k1p = 4 w0,   k1 = 0,   k0 = k1p k2 w0/30
 *
 * With torque at once (26) has poles near -4 w0, -w0 and -w0/30. k1 only adds to k1p k2, and the
 * paper's k0 = 10 1/s^3 would take four days to learn a load.
 */
#ifndef STEADYSTEP_MECHANICAL_CONTROL_DESIGN_H
#define STEADYSTEP_MECHANICAL_CONTROL_DESIGN_H

#include <stdbool.h>

#include "firmware/design/refusal.h"
#include "firmware/motor/motor_params.h"

/*
 * k1p times the period: a sampled speed loop with a period of delay oscillates for good at 1, and
 * from 0.15 on the quantised speed of an encoder makes the current hunt.
 */
#define MECHANICAL_CONTROL_PERIOD_MAX 0.15

/* (k1p + k2) L/R without current control: the winding's lag leaves the speed loop a damping of 0.3.
 */
#define MECHANICAL_CONTROL_LAG_MAX 2.8

/*
 * N w L/R without current control: the current lags the voltage by its arc tangent and the torque
 * is short by 1/(1 + (N w L/R)^2); beyond 4, a seventeenth, the rotor is lost.
 */
#define REACTANCE_OVER_RESISTANCE_MAX 4.0

/* Largest bandwidths, rad/s: of the sampled speed loop, and without current control. */
double mechanical_control_bandwidth_max(double period_s);
double winding_lag_bandwidth_max(const struct motor_params *motor);

/* Largest speed, rad/s, without current control. */
double winding_lag_speed_max(const struct motor_params *motor);

struct mechanical_control_gains {
    double k1p_per_s;
    double k0_per_s3;
    double k1_per_s2;
    double k2_per_s;
};

/* False, with the limit in `error`, if the period does not bear the bandwidth. */
bool mechanical_control_design(const struct motor_params *motor, double period_s,
                               double bandwidth_rad_s, struct mechanical_control_gains *gains,
                               char error[DESIGN_ERROR_TEXT]);

/* False, with the limit in `error`, if the winding is too slow for a law without current control.
 */
bool winding_lag_check(const struct motor_params *motor, double bandwidth_rad_s,
                       double speed_limit_rad_s, char error[DESIGN_ERROR_TEXT]);

#endif
