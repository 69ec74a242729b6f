/*
 * Gains of the PID position control (Bendjedia 2012 section V names one, without gains): triple
 * real closed-loop pole e^(-w0 T) on the exact discrete model (18), derivative from the speed.
 */
#ifndef STEADYSTEP_PID_DESIGN_H
#define STEADYSTEP_PID_DESIGN_H

#include <stdbool.h>

#include "firmware/design/refusal.h"
#include "firmware/motor/motor_params.h"

/*
 * With e = theta* - theta and the sum s(k+1) = s(k) + e(k), s(0) = 0:
 *   i_q* = k_proportional e + k_integral_step s + k_speed (w* - w)
 *          + (Kv / Km) w* + k_acceleration_reference alpha*
 */
struct pid_gains {
    double k_proportional_A_rad;             /* A per rad (mechanical) */
    double k_integral_step_A_rad;            /* A per rad and period: K_i T */
    double k_speed_As_rad;                   /* A per rad/s, derivative part */
    double k_speed_reference_As_rad;         /* k_speed + Kv / Km */
    double k_acceleration_reference_As2_rad; /* J / Km */
};

/* False, with the limit in `error`, if the loops cannot bear the bandwidths (loop_bandwidth.h). */
bool pid_design(const struct motor_params *motor, double period_s, double bandwidth_rad_s,
                double current_bandwidth_rad_s, struct pid_gains *gains,
                char error[DESIGN_ERROR_TEXT]);

#endif
