/* The motors of sil/motors/ as the design tests need them. */
#ifndef STEADYSTEP_REFERENCE_MOTORS_H
#define STEADYSTEP_REFERENCE_MOTORS_H

#include <array>

#include "firmware/motor/motor_params.h"

namespace reference
{

inline motor_params bendjedia_2012()
{
    motor_params motor{};
    motor.resistance_ohm = 0.37;
    motor.inductance_H = 0.9e-3;
    motor.torque_constant_Nm_A = 0.157;
    motor.viscous_friction_Nms_rad = 0.000307;
    motor.inertia_kgm2 = 15.62e-5;
    motor.rated_current_A = 3.0;
    motor.supply_V = 24.0;
    motor.rotor_teeth = 50;
    return motor;
}

inline motor_params seshagiri_khalil()
{
    motor_params motor{};
    motor.resistance_ohm = 19.0;
    motor.inductance_H = 40e-3;
    motor.torque_constant_Nm_A = 0.1349;
    motor.viscous_friction_Nms_rad = 0.0013;
    motor.inertia_kgm2 = 4.1295e-4;
    motor.rated_current_A = 2.0;
    motor.supply_V = 50.0;
    motor.rotor_teeth = 50;
    return motor;
}

inline motor_params kim_2016()
{
    motor_params motor{};
    motor.resistance_ohm = 2.25;
    motor.inductance_H = 3.6e-3;
    motor.torque_constant_Nm_A = 0.48;
    motor.viscous_friction_Nms_rad = 1e-3;
    motor.inertia_kgm2 = 4.8e-5;
    motor.rated_current_A = 2.0;
    motor.supply_V = 24.0;
    motor.rotor_teeth = 50;
    return motor;
}

inline std::array<motor_params, 3> motors()
{
    return {bendjedia_2012(), seshagiri_khalil(), kim_2016()};
}

} // namespace reference

#endif
