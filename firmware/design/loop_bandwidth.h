/* What a cascade of sampled loops can bear; asked by every position design. */
#ifndef STEADYSTEP_LOOP_BANDWIDTH_H
#define STEADYSTEP_LOOP_BANDWIDTH_H

#include <stdbool.h>

#include "firmware/design/refusal.h"
#include "firmware/motor/motor_params.h"

/*
 * Current bandwidth times period: the current loop is an integrator with 1.5 periods of delay, so
 * 0.3 leaves it 64 degrees of phase margin, and still 38 if L is half of what the motor file says.
 */
#define CURRENT_BANDWIDTH_PERIOD_MAX 0.3
/*
 * Current bandwidth over position bandwidth: at 4 the lag of the current loop leaves the double
 * pole of the state feedback a damping of 0.69 and the triple pole of the PID 0.47.
 */
#define CURRENT_OVER_POSITION_BANDWIDTH_MIN 4.0
/*
 * Bandwidth of the encoder's observer times period, p = e^-0.5 = 0.6: beyond it a count of noise
 * goes straight into the speed.
 */
#define ENCODER_OBSERVER_PERIOD_MAX 0.5

/*
 * True if the motor (motor_check.h) bears a current loop of this bandwidth sampled with `period_s`;
 * else false and the limit in `error`.
 */
bool current_bandwidth_check(const struct motor_params *motor, double period_s,
                             double current_bandwidth_rad_s, char error[DESIGN_ERROR_TEXT]);

/*
 * True if `position_bandwidth_rad_s` can be had over a current control of
 * `current_bandwidth_rad_s` sampled with `period_s`; else false and the limit in `error`.
 * Checks the current loop first.
 */
bool loop_bandwidth_check(const struct motor_params *motor, double period_s,
                          double position_bandwidth_rad_s, double current_bandwidth_rad_s,
                          char error[DESIGN_ERROR_TEXT]);

#endif
