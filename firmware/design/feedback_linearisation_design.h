/*
 * Three poles for the chain of integrators that input-output linearisation leaves of the motor:
 * position, speed, acceleration, driven by the change of acceleration over a period, w.
 *
 *   theta+ = theta + T omega + T^2/2 alpha + T^2/6 w
 *   omega+ = omega + T alpha + T/2 w                     exact for a constant rate of the current
 *   alpha+ = alpha + w
 *   w = k_position e_theta + k_speed e_omega + k_acceleration e_alpha
 *
 * One pole pair of frequency w0 and damping D, one real pole of bandwidth w_c, each at z = e^(s T).
 * With d = 1 - z and (d1 + x)(d2 + x)(d3 + x) = x^3 + c2 x^2 + c1 x + c0 comparison of the
 * characteristic polynomials gives, without cancellation for poles near one,
 *
 *   k_position = c0/T^2,  k_speed = (c1 - c0)/T,  k_acceleration = c2 - (c1 - c0)/2 - c0/6
 */
#ifndef STEADYSTEP_FEEDBACK_LINEARISATION_DESIGN_H
#define STEADYSTEP_FEEDBACK_LINEARISATION_DESIGN_H

#include <stdbool.h>

#include "firmware/design/refusal.h"

/*
 * Bounds of frequency times period. The period of delay is predicted away and costs nothing as long
 * as the prediction is right, so a fast pole may be as fast as the current control's. What bounds
 * them is a wrong model: up to here all poles of the closed loop, with delay, prediction and
 * observers, stay inside the unit circle with inductance, torque constant and inertia each 20 % off
 * in any combination, for load observers of 1000...5000 rad/s at 10 kHz (tests/reference).
 */
#define LINEARISED_CURRENT_BANDWIDTH_PERIOD_MAX 0.3
#define LINEARISED_LAW_BANDWIDTH_PERIOD_MAX     0.15

struct feedback_linearisation_poles {
    double law_bandwidth_rad_s;     /* w0 of the pair */
    double damping;                 /* D, 0...1 */
    double current_bandwidth_rad_s; /* w_c */
};

/* Change of acceleration over a period, per error. */
struct feedback_linearisation_gains {
    double k_position_s2;  /* rad/s^2 per rad */
    double k_speed_s;      /* rad/s^2 per rad/s */
    double k_acceleration; /* 1 */
};

/* false: a bandwidth is beyond what the period bears, the limit in error. */
bool feedback_linearisation_design(double period_s,
                                   const struct feedback_linearisation_poles *poles,
                                   struct feedback_linearisation_gains *gains,
                                   char error[DESIGN_ERROR_TEXT]);

#endif
