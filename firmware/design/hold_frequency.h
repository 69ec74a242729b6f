/* The frequencies with which a rotor swings by itself, rad/s. */
#ifndef STEADYSTEP_HOLD_FREQUENCY_H
#define STEADYSTEP_HOLD_FREQUENCY_H

#include "firmware/design/elementary.h"
#include "firmware/motor/motor_params.h"

/* On the spring of a held current: w_h = sqrt(N Km i_hold / J). */
static inline double hold_frequency(const struct motor_params *motor, double hold_current_A)
{
    return square_root((double)motor->rotor_teeth * motor->torque_constant_Nm_A * hold_current_A /
                       motor->inertia_kgm2);
}

/* Against its winding, through back-EMF and inductance: w_em = Km / sqrt(J L). */
static inline double electromechanical_frequency(const struct motor_params *motor)
{
    return motor->torque_constant_Nm_A / square_root(motor->inertia_kgm2 * motor->inductance_H);
}

#endif
