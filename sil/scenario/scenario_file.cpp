#include "sil/scenario/scenario_file.h"

#include <cctype>
#include <filesystem>

#include "sil/scenario/table_reader.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace fs = std::filesystem;

namespace
{

constexpr double supply_headroom = 1.3; /* full scale of voltage sensing / nominal supply */
constexpr double longest_run_s = 600;   /* 25 columns of 10 kHz: 1.2 GB */
constexpr double largest_position_rad = 1e7;

/* The file with its bases under it; `chain` holds the files that wait for this one. */
Value read_with_bases(const Catalogue &catalogue, const fs::path &file, std::vector<fs::path> chain)
{
    Value document = read_toml(file);
    const Value *base = document.find("base");
    if (base == nullptr) {
        return document;
    }
    const std::string where = base->location.text() + ": base";
    if (base->kind != Value::Kind::text) {
        throw InputError(where + ": expected the name or path of a scenario in quotes");
    }
    chain.push_back(file);
    const fs::path base_file = catalogue.scenario(base->text, where, file.parent_path());
    for (const fs::path &waiting : chain) {
        std::error_code error;
        if (fs::equivalent(waiting, base_file, error)) {
            throw InputError(where + ": " + base->text + " is built on this scenario itself");
        }
    }
    Value merged = read_with_bases(catalogue, base_file, chain);
    merge(merged, document);
    merged.location = document.location;
    return merged;
}

void read_drive(const Value &table, drive_settings &drive)
{
    TableReader reader(table, "drive");
    std::size_t law = 0, estimator = 0;
    if (reader.choice("law", law, names_of(drive_law_name, POSITION_LAW_COUNT))) {
        drive.law = static_cast<position_law>(law);
    }
    if (reader.choice("estimator", estimator, names_of(drive_estimator_name, DRIVE_ESTIMATORS))) {
        drive.estimator = static_cast<drive_estimator>(estimator);
    }
    reader.number("law_bandwidth_rad_s", drive.law_bandwidth_rad_s, 1, 1e5);
    reader.boolean("feed_forward", drive.feed_forward);
    reader.number("current_bandwidth_rad_s", drive.current_bandwidth_rad_s, 1, 1e5);
    reader.number("current_limit_A", drive.current_limit_A, 0, 1000);
    reader.number("overcurrent_trip_A", drive.overcurrent_trip_A, 0, 1000);
    reader.number("speed_limit_rad_s", drive.speed_limit_rad_s, 0, 1e5);
    reader.boolean("resistance_adaptation", drive.resistance_adaptation);
    reader.number("hold_current_A", drive.hold_current_A, 0, 1000);
    reader.number("hold_ramp_s", drive.hold_ramp_s, 0, 10);
    reader.number("hold_delay_s", drive.hold_delay_s, 0, 10);
    reader.boolean("calibrate_offsets", drive.calibrate_offsets);
    reader.boolean("hold_on_enable", drive.hold_on_enable);
    reader.number("hold_on_enable_s", drive.hold_on_enable_s, 0, 10);
    reader.number("initial_angle_rad", drive.initial_angle_rad, -largest_position_rad,
                  largest_position_rad);
    reader.number("initial_angle_error_rad", drive.initial_angle_error_rad, -1, 1);
    reader.finish();
}

void read_plant_model(TableReader &reader, plant::Config &plant)
{
    std::size_t model = 1, bridge = 0;
    reader.choice("model", model, {"ideal", "bench"});
    const bool ideal = model == 0;
    plant.bridge.model = ideal ? plant::BridgeModel::averaged : plant::BridgeModel::switched;
    plant.sensors.exact = ideal;
    if (reader.choice("bridge", bridge, {"averaged", "switched"})) {
        plant.bridge.model =
            bridge == 0 ? plant::BridgeModel::averaged : plant::BridgeModel::switched;
    }
    reader.boolean("exact_sensors", plant.sensors.exact);
}

void read_plant(const Value &table, Scenario &scenario)
{
    TableReader reader(table, "plant");
    plant::Config &plant = scenario.plant;
    plant::BridgeConfig &bridge = plant.bridge;
    plant::SensorConfig &sensors = plant.sensors;
    std::int64_t delay_periods = bridge.delay_periods;

    read_plant_model(reader, plant);
    reader.number("bus_V", bridge.bus_V, 1, 1000);
    reader.number("dead_time_s", bridge.dead_time_s, 0, 1e-5);
    reader.number("diode_drop_V", bridge.diode_drop_V, 0, 5);
    reader.number("period_s", bridge.period_s, 1e-5, 1e-3);
    reader.integer("delay_periods", delay_periods, 0, 1);
    reader.number("current_range_A", sensors.current_range_A, 0.1, 1000);
    reader.number("current_noise_rms_A", sensors.current_noise_rms_A, 0, 10);
    reader.number("current_offset_a_A", sensors.current_offset_a_A, -10, 10);
    reader.number("current_offset_b_A", sensors.current_offset_b_A, -10, 10);
    reader.number("phase_voltage_range_V", sensors.phase_voltage_range_V, 1, 2000);
    reader.number("phase_voltage_noise_rms_V", sensors.phase_voltage_noise_rms_V, 0, 100);
    reader.number("phase_voltage_offset_a_V", sensors.phase_voltage_offset_a_V, -100, 100);
    reader.number("phase_voltage_offset_b_V", sensors.phase_voltage_offset_b_V, -100, 100);
    reader.number("bus_range_V", sensors.bus_range_V, 1, 2000);
    reader.number("initial_theta_rad", plant.initial_theta_rad, -largest_position_rad,
                  largest_position_rad);
    reader.number("initial_omega_rad_s", plant.initial_omega_rad_s, -1e4, 1e4);
    for (const PlantScaleField &field : plant_scale_fields()) {
        reader.number(field.key, scenario.scales.*field.scale, 0.01, 100);
    }
    reader.finish();
    bridge.delay_periods = static_cast<int>(delay_periods);
}

/* What follows from the motor, before [plant] and [drive] are read. */
void set_defaults(Scenario &scenario)
{
    const motor_params &motor = scenario.motor.params;
    drive_settings_default(&scenario.drive, &motor);
    scenario.plant.bridge.bus_V = motor.supply_V;
    scenario.plant.sensors.phase_voltage_range_V = supply_headroom * motor.supply_V;
    scenario.plant.sensors.bus_range_V = supply_headroom * motor.supply_V;
}

} // namespace

plant::MotorConfig scaled(const motor_params &motor, const PlantScales &scales)
{
    plant::MotorConfig config;
    config.resistance_ohm = motor.resistance_ohm * scales.resistance;
    config.inductance_H = motor.inductance_H * scales.inductance;
    config.torque_constant_Nm_A = motor.torque_constant_Nm_A * scales.km;
    config.viscous_friction_Nms_rad = motor.viscous_friction_Nms_rad * scales.viscous_friction;
    config.inertia_kgm2 = motor.inertia_kgm2 * scales.inertia;
    config.rotor_teeth = motor.rotor_teeth;
    return config;
}

std::string Scenario::locate(const std::string &complaint) const
{
    std::string word;
    for (const char letter : complaint + " ") {
        if (std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_') {
            word += letter;
            continue;
        }
        for (const Value *table :
             {document.find("drive"), document.find("plant"), &motor.document}) {
            const Value *value = table != nullptr ? table->find(word) : nullptr;
            if (value != nullptr) {
                return value->location.text() + ": ";
            }
        }
        word.clear();
    }
    return document.location.text() + ": ";
}

Scenario read_scenario(const Catalogue &catalogue, const std::string &name,
                       const std::vector<std::string> &settings, const std::string &asked_by)
{
    const fs::path file = catalogue.scenario(name, asked_by);
    Scenario scenario;
    scenario.name = file.stem().string();
    scenario.asked = name;
    scenario.settings = settings;
    scenario.document = read_with_bases(catalogue, file, {});
    scenario.document.location = {file.string(), 0};
    apply_settings(scenario.document, settings);

    TableReader reader(scenario.document, "");
    std::string motor;
    std::int64_t seed = 1;
    reader.any("base");
    reader.require("description");
    reader.text("description", scenario.description);
    reader.require("motor");
    if (reader.text("motor", motor)) {
        const Location &where = scenario.document.find("motor")->location;
        scenario.motor = read_motor(
            catalogue.motor(motor, where.text() + ": motor",
                            where.line == 0 ? fs::path() : fs::path(where.file).parent_path()));
    }
    reader.require("duration_s");
    reader.number("duration_s", scenario.duration_s, 1e-3, longest_run_s);
    reader.integer("seed", seed, 0, std::int64_t{1} << 53);
    reader.boolean("record_enabling", scenario.record_enabling);
    reader.number("settling_band_rad", scenario.settling_band_rad, 1e-9, 10);
    scenario.seed = static_cast<std::uint64_t>(seed);

    set_defaults(scenario);
    if (const Value *plant = reader.table("plant")) {
        read_plant(*plant, scenario);
    }
    scenario.plant.motor = scaled(scenario.motor.params, scenario.scales);
    scenario.drive.initial_angle_rad = scenario.plant.initial_theta_rad;
    if (const Value *drive = reader.table("drive")) {
        read_drive(*drive, scenario.drive);
    }
    scenario.events = read_events(reader, scenario.duration_s);
    scenario.expectations = read_expectations(reader, scenario.duration_s);
    reader.finish();

    char error[DRIVE_ERROR_TEXT] = "";
    if (!drive_settings_check(&scenario.drive, error)) {
        throw InputError(scenario.locate(error) + error);
    }
    return scenario;
}

} // namespace scenario
