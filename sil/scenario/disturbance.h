/*
 * What the timeline does to the plant, unseen by the drive: parameters, bus and sensing that drift
 * or jump, and parts that fail.
 */
#ifndef STEADYSTEP_SCENARIO_DISTURBANCE_H
#define STEADYSTEP_SCENARIO_DISTURBANCE_H

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "sil/plant/plant.h"
#include "sil/scenario/table_reader.h"

namespace scenario
{

/* The true motor, relative to the motor file; the drive goes on believing the file. */
struct PlantScales {
    double resistance = 1, inductance = 1, km = 1, inertia = 1, viscous_friction = 1;
};

struct PlantScaleField {
    const char *key; /* as written under [plant] */
    double PlantScales::*scale;
};

const std::vector<PlantScaleField> &plant_scale_fields();

/* All that can drift, as it is at a time of the run. */
struct PlantValues {
    PlantScales scales;
    plant::SensorConfig sensors;
    double bus_V = 0;            /* of the source */
    double coulomb_friction = 0; /* share of the holding torque */
    double magnet_rise_K = 0;
    double bridge_temperature_C = 25;
};

/* What a value belongs to; each is handed to the plant as a whole. */
enum class PlantPart { motor, sensors, bus, friction, bridge_temperature, magnet };

struct DriftField {
    const char *key; /* as written under [plant] */
    PlantPart part;
    double &(*of)(PlantValues &values);
    double min, max;
};

/* A value that goes somewhere; the event says how long it takes. */
struct Drift {
    const DriftField *field = nullptr;
    double to = 0;
};

/* The keys of an event's `plant`, at least one; throws InputError. */
std::vector<Drift> read_drifts(const Value &table, const std::string &path);

/* The longest way of a load, or of another value that goes somewhere. */
constexpr double longest_ramp_s = 600;

/* Of the machine's torque on the shaft: its steady part goes somewhere, or it vibrates. */
struct LoadChange {
    bool vibrates = false;
    double torque_Nm = 0; /* where to; of a vibration the amplitude, 0 ends it */
    double ramp_s = 0;
    double frequency_Hz = 0;
};

/* The keys by which an event is recognised as one. */
extern const char *const load_torque_key;
extern const char *const load_vibration_key;

/* Of an event that has one of the two; throws InputError. */
LoadChange read_load_change(TableReader &event);
void put_load(const LoadChange &change, plant::Plant &plant);

/* The keys of the machine's stops; throws InputError. */
void read_stops(TableReader &reader, plant::StopConfig &stops);

/* Switches that the machine works as it turns, on inputs that count as HAL_INPUT_...: at which
   angles of the rotor, mechanical, they are active. */
struct MachineSwitches {
    double home_switch_low_rad = -std::numeric_limits<double>::infinity();
    double home_switch_high_rad = std::numeric_limits<double>::infinity();
    double limit_low_rad = 0, limit_high_rad = 0; /* from there down, up */
    std::uint32_t wired = 0;

    std::uint32_t active(double angle_rad) const;
};

/* Their keys; throws InputError. */
void read_switches(TableReader &reader, MachineSwitches &switches);

/* The names of the faults, by which an event is recognised as one. */
const std::vector<std::string> &plant_fault_names();

/* What the plant suffers at the S(k) of its event. */
using PlantFault = std::function<void(plant::Plant &plant)>;

/* The fault `name` of an event; throws InputError. */
PlantFault read_plant_fault(TableReader &event, const std::string &name);

} // namespace scenario

#endif
