/* The held rotor on its spring: w_h = sqrt(N Km i_hold / J), rad/s. */
#ifndef STEADYSTEP_HOLD_FREQUENCY_H
#define STEADYSTEP_HOLD_FREQUENCY_H

#include "firmware/design/elementary.h"
#include "firmware/motor/motor_params.h"

static inline double hold_frequency(const struct motor_params *motor, double hold_current_A)
{
    return square_root((double)motor->rotor_teeth * motor->torque_constant_Nm_A * hold_current_A /
                       motor->inertia_kgm2);
}

#endif
