#include "sil/scenario/disturbance.h"

#include <cmath>
#include <cstdint>

#include "hal/hal.h"

namespace scenario
{

namespace
{

template <double PlantScales::*scale> double &scale_of(PlantValues &values)
{
    return values.scales.*scale;
}

template <double plant::SensorConfig::*member> double &sensing_of(PlantValues &values)
{
    return values.sensors.*member;
}

template <double PlantValues::*member> double &value_of(PlantValues &values)
{
    return values.*member;
}

/* Ranges are those of [plant]; an inertia may jump further, as when a load is clutched in. */
const std::vector<DriftField> &drift_fields()
{
    using Sensing = plant::SensorConfig;
    constexpr PlantPart motor = PlantPart::motor, sensors = PlantPart::sensors;
    static const std::vector<DriftField> fields = {
        {"resistance_scale", motor, scale_of<&PlantScales::resistance>, 0.01, 100},
        {"inductance_scale", motor, scale_of<&PlantScales::inductance>, 0.01, 100},
        {"km_scale", motor, scale_of<&PlantScales::km>, 0.01, 100},
        {"inertia_scale", motor, scale_of<&PlantScales::inertia>, 0.01, 1000},
        {"viscous_friction_scale", motor, scale_of<&PlantScales::viscous_friction>, 0.01, 100},
        {"coulomb_friction", PlantPart::friction, value_of<&PlantValues::coulomb_friction>, 0, 10},
        {"bridge_temperature_C", PlantPart::bridge_temperature,
         value_of<&PlantValues::bridge_temperature_C>, -50, 180},
        {"magnet_rise_K", PlantPart::magnet, value_of<&PlantValues::magnet_rise_K>, -100, 200},
        {"bus_V", PlantPart::bus, value_of<&PlantValues::bus_V>, 1, 1000},
        {"current_offset_a_A", sensors, sensing_of<&Sensing::current_offset_a_A>, -10, 10},
        {"current_offset_b_A", sensors, sensing_of<&Sensing::current_offset_b_A>, -10, 10},
        {"current_residual_a_A", sensors, sensing_of<&Sensing::current_residual_a_A>, -10, 10},
        {"current_residual_b_A", sensors, sensing_of<&Sensing::current_residual_b_A>, -10, 10},
        {"phase_voltage_residual_a_V", sensors, sensing_of<&Sensing::phase_voltage_residual_a_V>,
         -100, 100},
        {"phase_voltage_residual_b_V", sensors, sensing_of<&Sensing::phase_voltage_residual_b_V>,
         -100, 100},
        {"divider_mismatch_a", sensors, sensing_of<&Sensing::divider_mismatch_a>, -0.1, 0.1},
        {"divider_mismatch_b", sensors, sensing_of<&Sensing::divider_mismatch_b>, -0.1, 0.1},
        {"current_gain_a", sensors, sensing_of<&Sensing::current_gain_a>, 0.1, 10},
        {"current_gain_b", sensors, sensing_of<&Sensing::current_gain_b>, 0.1, 10},
        {"current_noise_rms_A", sensors, sensing_of<&Sensing::current_noise_rms_A>, 0, 10},
        {"phase_voltage_offset_a_V", sensors, sensing_of<&Sensing::phase_voltage_offset_a_V>, -100,
         100},
        {"phase_voltage_offset_b_V", sensors, sensing_of<&Sensing::phase_voltage_offset_b_V>, -100,
         100},
        {"phase_voltage_noise_rms_V", sensors, sensing_of<&Sensing::phase_voltage_noise_rms_V>, 0,
         100},
    };
    return fields;
}

const std::vector<std::string> &channel_names()
{
    static const std::vector<std::string> names = {
        "current_a",       "current_b", "phase_voltage_a",
        "phase_voltage_b", "bus",       "bridge_temperature"};
    return names;
}

PlantFault read_jam(TableReader &event)
{
    bool jammed = true;
    double torque_Nm = plant::Plant::held_Nm;
    event.boolean("jam", jammed);
    if (event.number("jam_torque_Nm", torque_Nm, 1e-6, 1e6) && !jammed) {
        event.fail("jam_torque_Nm", "expected with jam = true only");
    }
    return [torque_Nm = jammed ? torque_Nm : 0.0](plant::Plant &plant) { plant.jam(torque_Nm); };
}

PlantFault read_open_phase(TableReader &event)
{
    std::size_t phase = 0;
    bool open = true;
    event.choice("open_phase", phase, {"a", "b"});
    event.boolean("open", open);
    return [phase = static_cast<int>(phase), open](plant::Plant &plant) {
        plant.open_phase(phase, open);
    };
}

PlantFault read_stuck_adc(TableReader &event)
{
    std::size_t index = 0;
    bool stuck = true;
    std::int64_t value = 0;
    event.choice("stuck_adc", index, channel_names());
    event.boolean("stuck", stuck);
    const bool given = event.integer("code", value, -32768, 65535);
    if (given && !stuck) {
        event.fail("code", "expected without stuck = false only");
    }
    const plant::Channel channel = static_cast<plant::Channel>(index);
    const int code = static_cast<int>(value);
    return [channel, stuck, given, code](plant::Plant &plant) {
        if (!stuck) {
            plant.release(channel);
        } else if (given) {
            plant.stick(channel, code);
        } else {
            plant.stick(channel);
        }
    };
}

PlantFault read_noisy_adc(TableReader &event)
{
    std::size_t index = 0;
    double rms = 0;
    event.choice("noisy_adc", index, channel_names());
    event.require("noise_codes");
    event.number("noise_codes", rms, 0, 1e4);
    const plant::Channel channel = static_cast<plant::Channel>(index);
    return [channel, rms](plant::Plant &plant) { plant.add_noise(channel, rms); };
}

PlantFault read_encoder(TableReader &event)
{
    std::size_t condition = 0;
    double rate = 0;
    event.choice("encoder", condition, {"sound", "frozen", "reversed", "half", "noisy", "lossy"});
    const plant::EncoderCondition given = static_cast<plant::EncoderCondition>(condition);
    if (given == plant::EncoderCondition::noisy) {
        event.require("miscounts_per_s");
        event.number("miscounts_per_s", rate, 0, 1e6);
    } else if (given == plant::EncoderCondition::lossy) {
        event.require("lost_share");
        event.number("lost_share", rate, 0, 1);
    }
    return [given, rate](plant::Plant &plant) { plant.set_encoder(given, rate); };
}

/* Both anew: what is not given is none, or as by default. */
PlantFault read_stops_anew(TableReader &event)
{
    bool present = true;
    plant::StopConfig stops;
    event.boolean("stops", present);
    read_stops(event, stops);
    if (present == (std::isinf(stops.low_rad) && std::isinf(stops.high_rad))) {
        event.fail("stops", "expected true with stop_low_rad or stop_high_rad, or false without");
    }
    return [stops](plant::Plant &plant) { plant.set_stops(stops); };
}

struct FaultReader {
    const char *name;
    PlantFault (*read)(TableReader &event);
};

constexpr FaultReader fault_readers[] = {
    {"jam", read_jam},
    {"open_phase", read_open_phase},
    {"stuck_adc", read_stuck_adc},
    {"noisy_adc", read_noisy_adc},
    {"encoder", read_encoder},
    {"stops", read_stops_anew},
};

constexpr double furthest_rad = 1e7; /* what belongs to the machine */

} // namespace

const std::vector<PlantScaleField> &plant_scale_fields()
{
    static const std::vector<PlantScaleField> fields = {
        {"resistance_scale", &PlantScales::resistance},
        {"inductance_scale", &PlantScales::inductance},
        {"km_scale", &PlantScales::km},
        {"inertia_scale", &PlantScales::inertia},
        {"viscous_friction_scale", &PlantScales::viscous_friction},
    };
    return fields;
}

std::vector<Drift> read_drifts(const Value &table, const std::string &path)
{
    TableReader plant(table, path + ".plant");
    std::vector<Drift> drifts;
    for (const DriftField &field : drift_fields()) {
        double to = 0;
        if (plant.number(field.key, to, field.min, field.max)) {
            drifts.push_back({&field, to});
        }
    }
    plant.finish();
    if (drifts.empty()) {
        throw InputError(table.location.text() + ": " + path +
                         ".plant: expected a scale or another key that can change in a run");
    }
    return drifts;
}

void read_stops(TableReader &reader, plant::StopConfig &stops)
{
    const bool low = reader.number("stop_low_rad", stops.low_rad, -furthest_rad, furthest_rad);
    if (reader.number("stop_high_rad", stops.high_rad, -furthest_rad, furthest_rad) && low &&
        stops.high_rad <= stops.low_rad) {
        reader.fail("stop_high_rad", "expected more than stop_low_rad");
    }
    reader.number("stop_stiffness_Nm_rad", stops.stiffness_Nm_rad, 0.1, 1e5);
    reader.number("stop_damping", stops.damping, 0, 2);
}

std::uint32_t MachineSwitches::active(double angle_rad) const
{
    std::uint32_t inputs = 0;
    inputs |= angle_rad < limit_low_rad ? HAL_INPUT_LIMIT_MINUS : 0;
    inputs |= angle_rad > limit_high_rad ? HAL_INPUT_LIMIT_PLUS : 0;
    inputs |=
        angle_rad > home_switch_low_rad && angle_rad < home_switch_high_rad ? HAL_INPUT_HOME : 0;
    return inputs & wired;
}

void read_switches(TableReader &reader, MachineSwitches &switches)
{
    const auto read = [&](const char *key, double &angle_rad, std::uint32_t input) {
        if (reader.number(key, angle_rad, -furthest_rad, furthest_rad)) {
            switches.wired |= input;
        }
    };
    read("limit_switch_low_rad", switches.limit_low_rad, HAL_INPUT_LIMIT_MINUS);
    read("limit_switch_high_rad", switches.limit_high_rad, HAL_INPUT_LIMIT_PLUS);
    read("home_switch_low_rad", switches.home_switch_low_rad, HAL_INPUT_HOME);
    read("home_switch_high_rad", switches.home_switch_high_rad, HAL_INPUT_HOME);
    if (switches.home_switch_high_rad <= switches.home_switch_low_rad) {
        reader.fail("home_switch_high_rad", "expected more than home_switch_low_rad");
    }
    if ((switches.wired & HAL_INPUT_LIMIT_MINUS) != 0 &&
        (switches.wired & HAL_INPUT_LIMIT_PLUS) != 0 &&
        switches.limit_high_rad <= switches.limit_low_rad) {
        reader.fail("limit_switch_high_rad", "expected more than limit_switch_low_rad");
    }
}

const char *const load_torque_key = "load_torque_Nm";
const char *const load_vibration_key = "load_vibration_Nm";

LoadChange read_load_change(TableReader &event)
{
    constexpr double largest_Nm = 100, lowest_Hz = 0.01, highest_Hz = 1000;
    LoadChange change;
    if (event.number(load_torque_key, change.torque_Nm, -largest_Nm, largest_Nm)) {
        event.number("ramp_s", change.ramp_s, 0, longest_ramp_s);
        return change;
    }
    change.vibrates = true;
    event.number(load_vibration_key, change.torque_Nm, 0, largest_Nm);
    if (change.torque_Nm > 0) {
        event.require("load_vibration_Hz");
    }
    event.number("load_vibration_Hz", change.frequency_Hz, lowest_Hz, highest_Hz);
    return change;
}

void put_load(const LoadChange &change, plant::Plant &plant)
{
    if (change.vibrates) {
        plant.vibrate(change.torque_Nm, change.frequency_Hz);
    } else {
        plant.set_load_torque(change.torque_Nm, change.ramp_s);
    }
}

const std::vector<std::string> &plant_fault_names()
{
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const FaultReader &reader : fault_readers) {
            all.push_back(reader.name);
        }
        return all;
    }();
    return names;
}

PlantFault read_plant_fault(TableReader &event, const std::string &name)
{
    for (const FaultReader &reader : fault_readers) {
        if (name == reader.name) {
            return reader.read(event);
        }
    }
    event.fail(name, "expected " + one_of(name, plant_fault_names()));
}

} // namespace scenario
