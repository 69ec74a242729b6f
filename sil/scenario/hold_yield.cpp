#include "sil/scenario/hold_yield.h"

#include <algorithm>
#include <cmath>

namespace scenario
{

namespace
{

constexpr double two_pi = 6.283185307179586;
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

/* The most that loads have changed by in a hold since the last motion without their being noticed:
   by less than a step that is, or while the hold leads a reference that creeps. */
double unnoticed_Nm(const Record &record, double noticed_step_Nm)
{
    double unnoticed = 0, most = 0;
    for (std::size_t row = record.time_zero_row() + 1; row < record.rows(); ++row) {
        if (record.at(row, HOLDING) == 0) {
            unnoticed = most = 0;
            continue;
        }
        const double change_Nm = record.at(row, LOAD_TORQUE) - record.at(row - 1, LOAD_TORQUE);
        const bool led = record.at(row, REFERENCE_MOVING) != 0;
        unnoticed += led || std::fabs(change_Nm) <= noticed_step_Nm ? change_Nm : 0;
        most = std::max(most, std::fabs(unnoticed));
    }
    return most;
}

/* With an encoder. */
std::optional<double> law_yield_rad(const Scenario &scenario)
{
    const plant::ImperfectionConfig &share = scenario.plant.imperfections;
    const motor_params &motor = scenario.motor.params;
    const std::uint32_t counts = scenario.plant.sensors.encoder_counts_per_turn;
    if (scenario.drive.law != POSITION_LAW_FEEDBACK_LINEARISATION || counts == 0) {
        return {};
    }
    const double stiffness_Nm_rad =
        drive_law_stiffness_Nm_rad(&scenario.drive, scenario.plant.bridge.period_s, counts);
    const double steepest_Nm_rad =
        motor.rotor_teeth * scenario.motor.holding_torque_Nm() *
        (4 * std::fabs(share.detent_4) + 2 * std::fabs(share.detent_2) + std::fabs(share.detent_1));
    if (!(steepest_Nm_rad > stiffness_Nm_rad)) {
        return {};
    }
    return held_back_Nm(scenario) / stiffness_Nm_rad + two_pi / counts;
}

} // namespace

std::optional<double> hold_yield_rad(const Scenario &scenario, const Record &record)
{
    if (scenario.drive.feedback == DRIVE_FEEDBACK_ENCODER) {
        return law_yield_rad(scenario);
    }
    const plant::SensorConfig &sensors = scenario.plant.sensors;
    const motor_params &motor = scenario.motor.params;
    drive_hold_bearing bearing{};
    char refusal[DRIVE_ERROR_TEXT];
    if (!drive_hold_bearing_of(&scenario.drive, scenario.plant.bridge.period_s, &bearing,
                               refusal)) {
        return {};
    }
    const double load_Nm =
        std::max(bearing.noticed_step_Nm, unnoticed_Nm(record, bearing.noticed_step_Nm)) +
        held_back_Nm(scenario);
    const double torque_Nm =
        bearing.torque_Nm * (1 - scenario.plant.imperfections.saturation_depth);
    const double swing_rad_s =
        std::sqrt(motor.rotor_teeth * bearing.torque_Nm / motor.inertia_kgm2);
    const double error_V = sensors.exact ? 0 : sensors.phase_voltage_range_V / code_parts;
    return std::asin(std::min(1.0, load_Nm / torque_Nm)) / motor.rotor_teeth +
           error_V / motor.torque_constant_Nm_A * followed_swings / swing_rad_s;
}

} // namespace scenario
