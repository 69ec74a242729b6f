/* What the runs of the STM32G071 board attach to it. */
#ifndef STEADYSTEP_TESTS_STM32G071_MOTOR_H
#define STEADYSTEP_TESTS_STM32G071_MOTOR_H

#include "firmware/motor/motor_params.h"
#include "sil/plant/plant.h"

namespace stm32g071
{

constexpr double host_baud = 115200;

/* sil/motors/bendjedia-2012.toml */
constexpr motor_params motor = {0.37, 0.9e-3, 0.157, 0.000307, 15.62e-5, 3.0, 24.0, 50};

/* The motor at this bridge: its resistance is in series, its dead time next to none. */
inline plant::Config plant_config()
{
    plant::Config config;
    config.motor = {motor.resistance_ohm + 0.18,    motor.inductance_H, motor.torque_constant_Nm_A,
                    motor.viscous_friction_Nms_rad, motor.inertia_kgm2, motor.rotor_teeth};
    config.bridge.bus_V = motor.supply_V;
    config.bridge.half_period_counts = 3200;
    config.bridge.dead_time_s = 5e-9;
    return config;
}

} // namespace stm32g071

#endif
