#include "sil/scenario/hold_yield.h"

#include <algorithm>
#include <cmath>

#include "sil/board/board.h"

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
            share.coulomb_friction + share.iron.hysteresis);
}

/* With an encoder. */
std::optional<double> law_yield_rad(const Scenario &scenario)
{
    const plant::ImperfectionConfig &share = scenario.plant.imperfections;
    const motor_params &motor = scenario.motor.params;
    const auto counts = static_cast<std::uint32_t>(scenario.plant.sensors.encoder_counts_per_turn);
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

HoldYield::HoldYield(const Scenario &scenario) : scenario_(scenario)
{
    drive_hold_bearing bearing{};
    char refusal[DRIVE_ERROR_TEXT];
    const hal_facts facts = sil::facts_of(scenario.plant);
    if (scenario.drive.feedback != DRIVE_FEEDBACK_ENCODER &&
        drive_hold_bearing_of(&scenario.drive, scenario.plant.bridge.period_s,
                              drive_blind_speed_rad_s(&scenario.drive, &facts), &bearing,
                              refusal)) {
        bearing_ = bearing;
    }
}

/* The most that loads have changed by in a hold since the last motion without their being noticed:
   by less than a step that is, or while the hold leads a reference that creeps. */
void HoldYield::read(const Record &record, const Row &row)
{
    if (!bearing_ || record.rows() < record.time_zero_row()) {
        return;
    }
    const double change_Nm = row[LOAD_TORQUE] - load_Nm_;
    load_Nm_ = row[LOAD_TORQUE];
    if (first_) {
        first_ = false;
        return;
    }
    if (row[HOLDING] == 0) {
        unnoticed_Nm_ = most_unnoticed_Nm_ = 0;
        return;
    }
    const bool led = row[REFERENCE_MOVING] != 0;
    unnoticed_Nm_ += led || std::fabs(change_Nm) <= bearing_->noticed_step_Nm ? change_Nm : 0;
    most_unnoticed_Nm_ = std::max(most_unnoticed_Nm_, std::fabs(unnoticed_Nm_));
}

std::optional<double> HoldYield::yield_rad() const
{
    if (scenario_.drive.feedback == DRIVE_FEEDBACK_ENCODER) {
        return law_yield_rad(scenario_);
    }
    if (!bearing_) {
        return {};
    }
    const plant::SensorConfig &sensors = scenario_.plant.sensors;
    const motor_params &motor = scenario_.motor.params;
    const double load_Nm =
        std::max(bearing_->noticed_step_Nm, most_unnoticed_Nm_) + held_back_Nm(scenario_);
    const double torque_Nm =
        bearing_->torque_Nm * (1 - scenario_.plant.imperfections.saturation_depth);
    const double swing_rad_s =
        std::sqrt(motor.rotor_teeth * bearing_->torque_Nm / motor.inertia_kgm2);
    const double error_V = sensors.exact ? 0 : sensors.phase_voltage_range_V / code_parts;
    return std::asin(std::min(1.0, load_Nm / torque_Nm)) / motor.rotor_teeth +
           error_V / motor.torque_constant_Nm_A * followed_swings / swing_rad_s;
}

} // namespace scenario
