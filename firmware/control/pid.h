/*
 * Position PID, the derivative taken from the estimated speed:
 *
 *   i_q* = Kp (theta* - theta) + Kd (w* - w) + z,   z += Ki (theta* - theta)
 *
 * The integrator stands still while the current is limited and the error would drive it further.
 */
#ifndef STEADYSTEP_PID_H
#define STEADYSTEP_PID_H

#include "firmware/control/position_law.h"

extern const struct position_law pid;

#endif
