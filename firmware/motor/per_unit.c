#include "firmware/motor/per_unit.h"

struct per_unit per_unit_base(const struct motor_params *motor, double period_s)
{
    const double two_pi = 6.283185307179586476925;
    struct per_unit base;

    base.current_A = 2.0 * motor->rated_current_A;
    base.voltage_V = motor->supply_V;
    base.speed_rad_s = base.voltage_V / motor->torque_constant_Nm_A;
    base.torque_Nm = motor->torque_constant_Nm_A * base.current_A;
    base.acceleration_rad_s2 = base.torque_Nm / motor->inertia_kgm2;
    base.resistance_ohm = base.voltage_V / base.current_A;
    base.rad_per_turn = two_pi / (double)motor->rotor_teeth;
    base.turns_per_period = base.speed_rad_s * period_s / base.rad_per_turn;
    base.ratio = 1.0;
    return base;
}

double per_unit_reactance(const struct per_unit *base, const struct motor_params *motor)
{
    return (double)motor->rotor_teeth * base->speed_rad_s * motor->inductance_H /
           base->resistance_ohm;
}
