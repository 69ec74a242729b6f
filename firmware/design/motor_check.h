/* What every design needs of a motor file before it divides by it. */
#ifndef STEADYSTEP_MOTOR_CHECK_H
#define STEADYSTEP_MOTOR_CHECK_H

#include <stdbool.h>

#include "firmware/design/refusal.h"
#include "firmware/motor/motor_params.h"

/*
 * True if every parameter and the period are finite and positive (viscous friction may be zero)
 * and the period is shorter than the electrical time constant L / R; else false and the parameter
 * with its bound in `error`.
 */
bool motor_check(const struct motor_params *motor, double period_s, char error[DESIGN_ERROR_TEXT]);

#endif
