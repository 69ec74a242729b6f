#include "sil/scenario/motor_report.h"

#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "sil/scenario/motor_plausibility.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

constexpr double control_period_s = 100e-6;

using Figures = std::vector<std::pair<const char *, double>>;

Figures parameters_of(const Motor &motor)
{
    const motor_params &of = motor.params;
    return {
        {"resistance_ohm", of.resistance_ohm},
        {"inductance_H", of.inductance_H},
        {"torque_constant_Nm_A", of.torque_constant_Nm_A},
        {"viscous_friction_Nms_rad", of.viscous_friction_Nms_rad},
        {"inertia_kgm2", of.inertia_kgm2},
        {"rated_current_A", of.rated_current_A},
        {"supply_V", of.supply_V},
        {"rotor_teeth", of.rotor_teeth},
    };
}

/* The rotor on the magnetic spring of the rated current swings at the last of them. */
Figures consequences_of(const Motor &motor)
{
    const motor_params &of = motor.params;
    Figures figures = {
        {"holding_torque_Nm", motor.holding_torque_Nm()},
        {"electrical_time_constant_s", of.inductance_H / of.resistance_ohm},
        {"back_emf_speed_rad_s", of.supply_V / of.torque_constant_Nm_A},
        {"hold_frequency_rad_s", std::sqrt(of.rotor_teeth * of.torque_constant_Nm_A *
                                           of.rated_current_A / of.inertia_kgm2)},
    };
    if (motor.rotor_inertia_kgm2.has_value()) {
        figures.push_back({"rotor_inertia_kgm2", *motor.rotor_inertia_kgm2});
    }
    if (motor.detent_torque_Nm.has_value()) {
        figures.push_back({"detent_torque_Nm", *motor.detent_torque_Nm});
    }
    return figures;
}

/* At the control period of the boards, with the default settings and a current range that suits the
   motor: the bearing, or why there is none. */
struct Sensorless {
    drive_hold_bearing bearing{};
    std::string refusal;
};

Sensorless sensorless_of(const Motor &motor)
{
    drive_settings settings;
    Sensorless found;
    char error[DRIVE_ERROR_TEXT];
    drive_settings_default(&settings, &motor.params);
    if (!drive_hold_bearing_of(&settings, control_period_s, 0.0, &found.bearing, error)) {
        found.refusal = error;
    }
    return found;
}

Figures figures_of(const drive_hold_bearing &bearing)
{
    return {
        {"hold_current_A", bearing.current_A},
        {"hold_heat_W", bearing.heat_W},
        {"hold_torque_Nm", bearing.torque_Nm},
        {"hold_load_step_Nm", bearing.load_step_Nm},
        {"hold_noticed_step_Nm", bearing.noticed_step_Nm},
        {"hold_creep_speed_rad_s", bearing.creep_speed_rad_s},
        {"motion_current_A", bearing.motion_current_A},
        {"load_step_angle_error_deg", bearing.thrown_deg},
        {"winding_drop_angle_error_deg", bearing.drop_deg},
    };
}

std::string lines_of(const Figures &figures)
{
    std::string text;
    for (const auto &[name, value] : figures) {
        text += format("  %-28s %.6g\n", name, value);
    }
    return text;
}

nlohmann::ordered_json json_of(const Motor &motor)
{
    nlohmann::ordered_json json;
    json["id"] = motor.id;
    json["description"] = motor.description;
    json["source"] = motor.source;
    json["stated"] = motor.stated;
    json["assumed"] = motor.assumed;
    json["unusual"] = motor.unusual;
    json["file"] = motor.document.location.file;
    for (const Figures &figures : {parameters_of(motor), consequences_of(motor)}) {
        for (const auto &[name, value] : figures) {
            json[name] = value;
        }
    }
    const Sensorless sensorless = sensorless_of(motor);
    json["refused_sensorless"] = sensorless.refusal;
    if (sensorless.refusal.empty()) {
        for (const auto &[name, value] : figures_of(sensorless.bearing)) {
            json[name] = value;
        }
    }
    json["doubts"] = doubts_about(motor);
    return json;
}

} // namespace

std::string motor_report(const Motor &motor)
{
    std::string text = motor.id + ": " + motor.description + "\n";
    text += lines_of(parameters_of(motor)) + "  follows:\n" + lines_of(consequences_of(motor));
    const Sensorless sensorless = sensorless_of(motor);
    text += "  without an encoder, default settings:\n";
    text += sensorless.refusal.empty() ? lines_of(figures_of(sensorless.bearing))
                                       : "  refused: " + sensorless.refusal + "\n";
    for (const std::string &doubt : doubts_about(motor)) {
        text +=
            (motor.unusual.empty() ? "  doubtful: " : "  unusual, and said to be: ") + doubt + "\n";
    }
    return text;
}

std::string motors_json(const std::vector<Motor> &motors)
{
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const Motor &motor : motors) {
        json.push_back(json_of(motor));
    }
    return json.dump(2) + "\n";
}

} // namespace scenario
