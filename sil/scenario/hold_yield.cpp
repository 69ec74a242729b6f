#include "sil/scenario/hold_yield.h"

#include <algorithm>
#include <cmath>

namespace scenario
{

namespace
{

constexpr double followed_swings = 8; /* for so many 1/w_h a load step is followed */
constexpr double code_parts = 4096;   /* of the leg voltages' +- full scale */

/* What holds the rotor back on this plant, at most. */
double held_back_Nm(const Scenario &scenario)
{
    const plant::ImperfectionConfig &share = scenario.plant.imperfections;
    return scenario.motor.holding_torque_Nm() *
           (std::fabs(share.detent_4) + std::fabs(share.detent_2) + std::fabs(share.detent_1) +
            share.coulomb_friction);
}

} // namespace

std::optional<double> hold_yield_rad(const Scenario &scenario)
{
    const plant::SensorConfig &sensors = scenario.plant.sensors;
    const motor_params &motor = scenario.motor.params;
    drive_hold_bearing bearing{};
    char refusal[DRIVE_ERROR_TEXT];
    if (scenario.drive.feedback == DRIVE_FEEDBACK_ENCODER ||
        !drive_hold_bearing_of(&scenario.drive, scenario.plant.bridge.period_s, &bearing,
                               refusal)) {
        return {};
    }
    const double load_Nm = bearing.noticed_step_Nm + held_back_Nm(scenario);
    const double torque_Nm =
        bearing.torque_Nm * (1 - scenario.plant.imperfections.saturation_depth);
    const double swing_rad_s =
        std::sqrt(motor.rotor_teeth * bearing.torque_Nm / motor.inertia_kgm2);
    const double error_V = sensors.exact ? 0 : sensors.phase_voltage_range_V / code_parts;
    return std::asin(std::min(1.0, load_Nm / torque_Nm)) / motor.rotor_teeth +
           error_V / motor.torque_constant_Nm_A * followed_swings / swing_rad_s;
}

} // namespace scenario
