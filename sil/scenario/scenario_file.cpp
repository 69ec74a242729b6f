#include "sil/scenario/scenario_file.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>

#include "sil/board/board.h"
#include "sil/scenario/number_formats.h"
#include "sil/scenario/settings_file.h"
#include "sil/scenario/table_reader.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace fs = std::filesystem;

namespace
{

constexpr double supply_headroom = 1.3; /* full scale of voltage sensing / nominal supply */
constexpr std::size_t most_bases = 16;  /* each is held until the last one has been read */
constexpr double longest_run_s = 600;
constexpr double most_rows = 6e6; /* 25 columns: 1.2 GB */
constexpr double largest_position_rad = 1e7;
/* Of the converters' ranges: 10 mA of 6 A, 5 mV of 31.2 V. */
constexpr double residual_current = 10e-3 / 6.0, residual_voltage = 5e-3 / 31.2;
static_assert(residual_current <= sil::current_offset_codes * 2.0 / 4096.0,
              "a board as built drifts by no more than its drive assumes");

/* `plant = "real"` is short for its model alone. */
void spell_out_plant(Value &document)
{
    const Value *plant = document.find("plant");
    if (plant == nullptr || plant->kind != Value::Kind::text) {
        return;
    }
    Value table;
    table.kind = Value::Kind::table;
    table.location = plant->location;
    table.set("model", *plant);
    document.set("plant", table);
}

/* The file with its bases under it; `chain` holds the files that wait for this one. */
Value read_with_bases(const Catalogue &catalogue, const fs::path &file, std::vector<fs::path> chain)
{
    Value document = read_toml(file);
    spell_out_plant(document);
    const Value *base = document.find("base");
    if (base == nullptr) {
        return document;
    }
    const std::string where = base->location.text() + ": base";
    if (base->kind != Value::Kind::text) {
        throw InputError(where + ": expected the name or path of a scenario in quotes");
    }
    if (chain.size() >= most_bases) {
        throw InputError(where + ": expected at most " + std::to_string(most_bases) +
                         " scenarios on top of one another");
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

/* The number formats that the scenario is judged in; the first is the default of `run`. */
void read_numerics(TableReader &reader, std::vector<std::string> &numerics)
{
    const char *const key = "numerics";
    const Value *list = reader.list(key, "an array of number formats");
    if (list == nullptr) {
        return;
    }
    const std::vector<std::string> &formats = number_formats();
    numerics.clear();
    for (const Value &item : list->items) {
        const bool known = item.kind == Value::Kind::text &&
                           std::find(formats.begin(), formats.end(), item.text) != formats.end();
        if (!known) {
            reader.fail(key, "expected " + one_of(item.text, formats));
        }
        if (std::find(numerics.begin(), numerics.end(), item.text) != numerics.end()) {
            reader.fail(key, "\"" + item.text + "\" is given twice");
        }
        numerics.push_back(item.text);
    }
    if (numerics.empty()) {
        reader.fail(key, "expected at least " + one_of("", formats));
    }
}

/* Lays `over` on the [drive] of `document`. */
void merge_drive(Value &document, const Value &over)
{
    Value drive;
    drive.set("drive", over);
    merge(document, drive);
}

/* Folder from which a path at `where` is meant; the present one on the command line. */
fs::path folder_of(const Location &where)
{
    return where.line == 0 ? fs::path() : fs::path(where.file).parent_path();
}

/* Under the drive settings of `document` those of the set that it names. */
void lay_parameters_under(Value &document, const Catalogue &catalogue, std::string &name)
{
    if (!TableReader(document, "").text("parameters", name)) {
        return;
    }
    const Location where = document.find("parameters")->location;
    const ParameterSet set = read_parameters(
        catalogue.parameters(name, where.text() + ": parameters", folder_of(where)));
    const Value *own = document.find("drive");
    const Value above = own != nullptr ? *own : Value();
    document.set("drive", set.drive);
    merge_drive(document, above);
}

/* Those of --set that are of the drive, or those that are not. */
std::vector<std::string> sets_of(const CommandLine &given, bool of_drive)
{
    std::vector<std::string> sets;
    std::copy_if(given.settings.begin(), given.settings.end(), std::back_inserter(sets),
                 [&](const std::string &set) {
                     return of_drive == (set.substr(0, set.find_first_of(".=")) == "drive");
                 });
    return sets;
}

/* What the command line gives over all files, and the parameter set, wherever it is named. A file
   of settings and the --set of the drive above it come later. */
void apply_command_line(Value &document, const Catalogue &catalogue, const CommandLine &given,
                        std::string &parameters)
{
    const std::vector<std::string> sets = with_plant_spelled_out(
        given.settings_file.empty() ? given.settings : sets_of(given, false));
    if (given.parameters.empty()) {
        apply_settings(document, sets);
        lay_parameters_under(document, catalogue, parameters);
        return;
    }
    const std::string where = "--parameters " + given.parameters;
    merge_drive(document, read_parameters(catalogue.parameters(given.parameters, where, {})).drive);
    apply_settings(document, sets);
    parameters = given.parameters;
}

/* Over the settings of the scenario those of the file, and over these what --set gives. Complaints
   find them in the scenario's document. */
void lay_settings_over(Scenario &scenario, const CommandLine &given)
{
    Value file = read_toml(given.settings_file);
    file.location = {given.settings_file, 0};
    read_settings(file, scenario.drive);
    merge_drive(scenario.document, file);

    Value above;
    apply_settings(above, sets_of(given, true));
    if (const Value *drive = above.find("drive")) {
        read_drive(*drive, scenario.drive);
        merge(scenario.document, above);
    }
}

/* Harmonics 4, 2 and 1 of the detent torque, as shares of the holding torque. A motor file's detent
   torque is the peak of their sum and keeps their ratio. */
void set_detent(plant::ImperfectionConfig &imperfections, const Motor &motor)
{
    constexpr double detent_4 = 0.05, detent_2 = 0.015, detent_1 = 0.0075;
    constexpr double peak = 1.2789059088441; /* of sin 4x + 0.3 sin 2x + 0.15 sin x */
    const double scale =
        motor.detent_torque_Nm.has_value()
            ? *motor.detent_torque_Nm / (peak * detent_4 * motor.holding_torque_Nm())
            : 1.0;
    imperfections.detent_4 = detent_4 * scale;
    imperfections.detent_2 = detent_2 * scale;
    imperfections.detent_1 = detent_1 * scale;
}

/* What `real` adds to `bench`; sources: sil/plant/README.md. */
void make_real(plant::Config &plant, const Motor &motor)
{
    const double current_code_A = 2 * plant.sensors.current_range_A / 4096.0;
    plant.imperfections.saturation_depth = 0.10;
    plant.imperfections.flux_harmonic_3 = 0.02;
    set_detent(plant.imperfections, motor);
    plant.imperfections.coulomb_friction = 0.015;
    plant.imperfections.bridge_resistance_ohm = 2 * 0.11;
    plant.imperfections.phase_voltage_filter_s = 10e-6;
    plant.supply.bus_source_ohm = 0.1;
    plant.supply.bus_capacitance_F = 470e-6;
    plant.supply.brake_ohm = 10;
    plant.sensors.current_gain_a = 1.005;
    plant.sensors.current_gain_b = 0.995;
    plant.sensors.current_offset_on_a_A = 3 * current_code_A;
    plant.sensors.current_offset_on_b_A = -2 * current_code_A;
    plant.sensors.phase_voltage_offset_on_a_V = 5e-3;
    plant.sensors.phase_voltage_offset_on_b_V = 5e-3;
}

/* What `as-built` adds to `real`; sources: sil/plant/README.md. */
void make_as_built(plant::Config &plant, const Motor &motor)
{
    make_real(plant, motor);
    plant::ImperfectionConfig &imperfections = plant.imperfections;
    imperfections.iron.hysteresis = 0.02;
    imperfections.iron.eddy_time_s = 6e-6;
    imperfections.resistance_a_scale = 0.985;
    imperfections.resistance_b_scale = 1.015;
    imperfections.inductance_a_scale = 1.01;
    imperfections.inductance_b_scale = 0.99;
    imperfections.magnet_rise_K = 70;
    plant::SensorConfig &sensors = plant.sensors;
    sensors.current_gain_a = 1.015;
    sensors.current_gain_b = 0.985;
    sensors.divider_mismatch_a = 2.5e-3;
    sensors.divider_mismatch_b = -2.5e-3;
    sensors.current_residual_a_A = residual_current * sensors.current_range_A;
    sensors.current_residual_b_A = -residual_current * sensors.current_range_A;
    sensors.phase_voltage_residual_a_V = residual_voltage * sensors.phase_voltage_range_V;
    sensors.phase_voltage_residual_b_V = -residual_voltage * sensors.phase_voltage_range_V;
}

void read_iron_and_belt(TableReader &reader, plant::ImperfectionConfig &imperfections)
{
    plant::IronConfig &iron = imperfections.iron;
    plant::BeltConfig &belt = imperfections.belt;
    reader.number("hysteresis", iron.hysteresis, 0, 0.2);
    reader.number("hysteresis_flux", iron.hysteresis_flux, 0.02, 10);
    reader.number("eddy_time_s", iron.eddy_time_s, 0, 1e-4);
    reader.number("eddy_lag_s", iron.eddy_lag_s, 0, 1e-2);
    reader.number("belt_inertia_share", belt.inertia_share, 0, 0.99);
    reader.number("belt_frequency_Hz", belt.frequency_Hz, 1, 2000);
    reader.number("belt_damping", belt.damping, 0, 1);
    reader.number("resistance_a_scale", imperfections.resistance_a_scale, 0.5, 2);
    reader.number("resistance_b_scale", imperfections.resistance_b_scale, 0.5, 2);
    reader.number("inductance_a_scale", imperfections.inductance_a_scale, 0.5, 2);
    reader.number("inductance_b_scale", imperfections.inductance_b_scale, 0.5, 2);
    reader.number("magnet_rise_K", imperfections.magnet_rise_K, -100, 200);
    reader.number("magnet_flux_per_K", imperfections.magnet_flux_per_K, -0.01, 0);
}

void read_imperfections(TableReader &reader, plant::ImperfectionConfig &imperfections)
{
    reader.number("saturation_depth", imperfections.saturation_depth, 0, 0.5);
    reader.number("flux_harmonic_3", imperfections.flux_harmonic_3, -0.2, 0.2);
    reader.number("detent_4", imperfections.detent_4, -1, 1);
    reader.number("detent_2", imperfections.detent_2, -1, 1);
    reader.number("detent_1", imperfections.detent_1, -1, 1);
    reader.number("coulomb_friction", imperfections.coulomb_friction, 0, 10);
    reader.number("bridge_resistance_ohm", imperfections.bridge_resistance_ohm, 0, 100);
    reader.number("phase_voltage_filter_s", imperfections.phase_voltage_filter_s, 0, 1e-3);
    read_iron_and_belt(reader, imperfections);
}

/* A residual is what is left of a calibration, or comes behind it. */
void read_mismatches(TableReader &reader, plant::SensorConfig &sensors)
{
    reader.number("current_residual_a_A", sensors.current_residual_a_A, -10, 10);
    reader.number("current_residual_b_A", sensors.current_residual_b_A, -10, 10);
    reader.number("phase_voltage_residual_a_V", sensors.phase_voltage_residual_a_V, -100, 100);
    reader.number("phase_voltage_residual_b_V", sensors.phase_voltage_residual_b_V, -100, 100);
    reader.number("divider_mismatch_a", sensors.divider_mismatch_a, -0.1, 0.1);
    reader.number("divider_mismatch_b", sensors.divider_mismatch_b, -0.1, 0.1);
}

void read_supply(TableReader &reader, plant::Config &plant)
{
    plant::SupplyConfig &supply = plant.supply;
    reader.number("bus_V", plant.bridge.bus_V, 1, 1000);
    reader.number("bus_source_ohm", supply.bus_source_ohm, 0, 100);
    reader.number("bus_capacitance_F", supply.bus_capacitance_F, 1e-9, 10);
    reader.number("brake_ohm", supply.brake_ohm, 0, 1e6);
    supply.brake_by_drive = !reader.number("brake_V", supply.brake_V, 1, 2000);
}

/* The range of the current sensing, in A or in rated currents; its noise stays the same in codes.
 */
void read_current_range(TableReader &reader, plant::SensorConfig &sensors, const Motor &motor)
{
    const char *const rated = "current_range_rated";
    const double default_range_A = sensors.current_range_A;
    double ratio = 0;
    const bool in_A = reader.number("current_range_A", sensors.current_range_A, 0.1, 1000);
    if (reader.number(rated, ratio, 1, 100)) {
        if (in_A) {
            reader.fail(rated, "expected either this or current_range_A");
        }
        sensors.current_range_A = ratio * motor.params.rated_current_A;
    }
    sensors.current_noise_rms_A *= sensors.current_range_A / default_range_A;
}

void read_plant_model(TableReader &reader, plant::Config &plant, const Motor &motor)
{
    std::size_t model = 1, bridge = 0;
    reader.choice("model", model, {"ideal", "bench", "real", "as-built"});
    const bool ideal = model == 0;
    if (model == 2) {
        make_real(plant, motor);
    } else if (model == 3) {
        make_as_built(plant, motor);
    }
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
    std::int64_t half_period_counts = bridge.half_period_counts;
    std::int64_t encoder_counts_per_turn = sensors.encoder_counts_per_turn;

    read_current_range(reader, sensors, scenario.motor);
    scenario.comparator_trip_A = sil::comparator_trip_A(sensors.current_range_A);
    reader.number("comparator_trip_A", scenario.comparator_trip_A, 0, 1000);
    read_plant_model(reader, plant, scenario.motor);
    read_imperfections(reader, plant.imperfections);
    read_supply(reader, plant);
    read_stops(reader, plant.stops);
    read_switches(reader, scenario.switches);
    read_mismatches(reader, sensors);
    reader.number("dead_time_s", bridge.dead_time_s, 0, 1e-5);
    reader.number("diode_drop_V", bridge.diode_drop_V, 0, 5);
    reader.number("period_s", bridge.period_s, 1e-6, 1e-3);
    reader.number("low_state_s", sensors.low_state_s, 0, 1e-4);
    reader.integer("half_period_counts", half_period_counts, 1, 65535);
    reader.integer("delay_periods", delay_periods, 0, 1);
    reader.number("current_noise_rms_A", sensors.current_noise_rms_A, 0, 10);
    reader.number("converter_crosstalk_codes", sensors.converter_crosstalk_codes, 0, 100);
    reader.number("current_offset_a_A", sensors.current_offset_a_A, -10, 10);
    reader.number("current_offset_b_A", sensors.current_offset_b_A, -10, 10);
    reader.number("current_offset_on_a_A", sensors.current_offset_on_a_A, -10, 10);
    reader.number("current_offset_on_b_A", sensors.current_offset_on_b_A, -10, 10);
    reader.number("current_gain_a", sensors.current_gain_a, 0.1, 10);
    reader.number("current_gain_b", sensors.current_gain_b, 0.1, 10);
    reader.number("phase_voltage_range_V", sensors.phase_voltage_range_V, 1, 2000);
    reader.number("phase_voltage_noise_rms_V", sensors.phase_voltage_noise_rms_V, 0, 100);
    reader.number("phase_voltage_offset_a_V", sensors.phase_voltage_offset_a_V, -100, 100);
    reader.number("phase_voltage_offset_b_V", sensors.phase_voltage_offset_b_V, -100, 100);
    reader.number("phase_voltage_offset_on_a_V", sensors.phase_voltage_offset_on_a_V, -100, 100);
    reader.number("phase_voltage_offset_on_b_V", sensors.phase_voltage_offset_on_b_V, -100, 100);
    reader.number("bus_range_V", sensors.bus_range_V, 1, 2000);
    reader.integer("encoder_counts_per_turn", encoder_counts_per_turn, 0, 1 << 30);
    reader.number("encoder_eccentricity_rad", sensors.encoder_eccentricity_rad, -0.1, 0.1);
    reader.number("encoder_phase_rad", sensors.encoder_phase_rad, -6.28, 6.28);
    reader.number("encoder_index_rad", sensors.encoder_index_rad, -1, 6.28);
    reader.number("initial_theta_rad", plant.initial_theta_rad, -largest_position_rad,
                  largest_position_rad);
    reader.number("initial_omega_rad_s", plant.initial_omega_rad_s, -1e4, 1e4);
    for (const PlantScaleField &field : plant_scale_fields()) {
        reader.number(field.key, scenario.scales.*field.scale, 0.01, 100);
    }
    reader.finish();
    bridge.delay_periods = static_cast<int>(delay_periods);
    bridge.half_period_counts = static_cast<int>(half_period_counts);
    sensors.encoder_counts_per_turn = static_cast<int>(encoder_counts_per_turn);
}

/* What follows from the motor, before [plant] and [drive] are read. */
void set_defaults(Scenario &scenario)
{
    const motor_params &motor = scenario.motor.params;
    drive_settings_default(&scenario.drive, &motor);
    scenario.plant.bridge.bus_V = motor.supply_V;
    scenario.comparator_trip_A = sil::comparator_trip_A(scenario.plant.sensors.current_range_A);
    scenario.plant.imperfections.rated_current_A = motor.rated_current_A;
    scenario.plant.sensors.phase_voltage_range_V = supply_headroom * motor.supply_V;
    scenario.plant.sensors.bus_range_V = supply_headroom * motor.supply_V;
}

} // namespace

ParameterSet read_parameters(const fs::path &file)
{
    Value document = read_toml(file);
    document.location = {file.string(), 0};
    TableReader reader(document, "");
    ParameterSet set;
    reader.require("description");
    reader.text("description", set.description);
    reader.require("drive");
    set.drive = *reader.table("drive");
    reader.finish();
    return set;
}

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

namespace
{

/* What `document` means. */
Scenario interpreted(const Catalogue &catalogue, const Value &document, const CommandLine &given,
                     const Motor *own_motor)
{
    Scenario scenario;
    scenario.given = given;
    scenario.document = document;
    spell_out_plant(scenario.document);
    apply_command_line(scenario.document, catalogue, given, scenario.parameters);

    TableReader reader(scenario.document, "");
    std::string motor;
    std::int64_t seed = 1;
    std::int64_t record_every = 1;
    reader.any("base");
    reader.any("parameters");
    reader.require("description");
    reader.text("description", scenario.description);
    reader.require("motor");
    if (reader.text("motor", motor)) {
        const Location &where = scenario.document.find("motor")->location;
        scenario.motor =
            own_motor != nullptr
                ? *own_motor
                : read_motor(catalogue.motor(motor, where.text() + ": motor", folder_of(where)));
    }
    reader.require("duration_s");
    reader.number("duration_s", scenario.duration_s, 1e-3, longest_run_s);
    reader.integer("seed", seed, 0, std::int64_t{1} << 53);
    reader.boolean("record_enabling", scenario.record_enabling);
    reader.integer("record_every", record_every, 1, 1000000);
    read_numerics(reader, scenario.numerics);
    reader.number("settling_band_rad", scenario.settling_band_rad, 1e-9, 10);
    scenario.seed = static_cast<std::uint64_t>(seed);

    set_defaults(scenario);
    if (const Value *plant = reader.table("plant")) {
        read_plant(*plant, scenario);
    }
    scenario.record_every = static_cast<std::uint32_t>(record_every);
    if (scenario.duration_s > most_rows * scenario.plant.bridge.period_s * scenario.record_every) {
        reader.fail("record_every", "too many periods to record all of them: record every n-th");
    }
    scenario.plant.motor = scaled(scenario.motor.params, scenario.scales);
    scenario.drive.initial_angle_rad = scenario.plant.initial_theta_rad;
    if (const Value *drive = reader.table("drive")) {
        read_drive(*drive, scenario.drive);
    }
    if (!given.settings_file.empty()) {
        lay_settings_over(scenario, given);
    }
    scenario.events = read_events(reader, scenario.duration_s);
    scenario.expectations = read_expectations(reader, scenario.duration_s);
    scenario.reports = read_reports(reader, scenario.duration_s);
    reader.finish();

    char error[DRIVE_ERROR_TEXT] = "";
    if (!drive_settings_check(&scenario.drive, error)) {
        throw InputError(scenario.locate(error) + error);
    }
    return scenario;
}

} // namespace

std::vector<std::string> with_plant_spelled_out(std::vector<std::string> sets)
{
    const std::string brief = "plant=";
    for (std::string &set : sets) {
        if (set.rfind(brief, 0) == 0) {
            set = "plant.model=" + set.substr(brief.size());
        }
    }
    return sets;
}

Scenario read_scenario(const Catalogue &catalogue, const std::string &name,
                       const CommandLine &given, const std::string &asked_by)
{
    const fs::path file = catalogue.scenario(name, asked_by);
    Value document = read_with_bases(catalogue, file, {});
    document.location = {file.string(), 0};
    Scenario scenario = interpreted(catalogue, document, given, nullptr);
    scenario.name = file.stem().string();
    scenario.asked = name;
    return scenario;
}

Scenario read_scenario_text(const Catalogue &catalogue, const std::string &text,
                            const std::string &name, const CommandLine &given,
                            const Motor *own_motor)
{
    Value document = parse_toml(text, name);
    document.location = {name, 0};
    Scenario scenario = interpreted(catalogue, document, given, own_motor);
    scenario.name = scenario.asked = name;
    return scenario;
}

} // namespace scenario
