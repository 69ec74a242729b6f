#include "sil/scenario/ratings.h"

#include <algorithm>
#include <cmath>

namespace scenario
{

namespace
{

constexpr double pi = 3.14159265358979323846;

/* (R I + Km w)^2 + (N L I w)^2 = U^2, solved for w. */
double rated_speed(const motor_params &motor)
{
    const double drop_V = motor.resistance_ohm * motor.rated_current_A;
    const double constant = motor.torque_constant_Nm_A;
    const double reactance = motor.rotor_teeth * motor.inductance_H * motor.rated_current_A;
    const double a = constant * constant + reactance * reactance;
    const double b = drop_V * constant;
    const double c = drop_V * drop_V - motor.supply_V * motor.supply_V;
    return c < 0 ? (std::sqrt(b * b - a * c) - b) / a : 0;
}

} // namespace

Ratings ratings_of(const motor_params &motor)
{
    const double torque_Nm = motor.torque_constant_Nm_A * motor.rated_current_A;
    return {torque_Nm,
            rated_speed(motor),
            torque_Nm / motor.inertia_kgm2,
            motor.rated_current_A,
            motor.supply_V,
            pi / 2 / motor.rotor_teeth};
}

RatingScales scales_of(const Ratings &motor, const Ratings &reference)
{
    const double speed = motor.speed_rad_s / reference.speed_rad_s;
    const double acceleration = motor.acceleration_rad_s2 / reference.acceleration_rad_s2;
    return {motor.torque_Nm / reference.torque_Nm, speed,
            std::min(acceleration, speed),         motor.current_A / reference.current_A,
            motor.supply_V / reference.supply_V,   motor.full_step_rad / reference.full_step_rad};
}

} // namespace scenario
