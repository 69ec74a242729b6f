#include "sil/scenario/plant_events.h"

#include <algorithm>
#include <cmath>

namespace scenario
{

PlantValues plant_values_of(const Scenario &scenario)
{
    return {scenario.scales, scenario.plant.sensors, scenario.plant.bridge.bus_V,
            scenario.plant.imperfections.coulomb_friction,
            scenario.plant.imperfections.magnet_rise_K};
}

void put_plant_part(const Scenario &scenario, const PlantValues &values, PlantPart part,
                    plant::Plant &plant)
{
    switch (part) {
    case PlantPart::motor:
        plant.set_motor(scaled(scenario.motor.params, values.scales));
        break;
    case PlantPart::sensors:
        plant.set_sensors(values.sensors);
        break;
    case PlantPart::bus:
        plant.set_bus(values.bus_V);
        break;
    case PlantPart::friction:
        plant.set_coulomb_friction(values.coulomb_friction);
        break;
    case PlantPart::magnet:
        plant.set_magnet_rise(values.magnet_rise_K);
        break;
    case PlantPart::bridge_temperature:
        plant.set_bridge_temperature(values.bridge_temperature_C);
        break;
    }
}

PlantEvents::PlantEvents(const Scenario &scenario, sil::DriveBoard &board)
    : scenario_(scenario), board_(board), values_(plant_values_of(scenario)),
      motor_(scaled(scenario.motor.params, scenario.scales))
{
}

void PlantEvents::act(const Event &event, std::uint32_t n)
{
    if (event.shorted_leg) {
        board_.short_circuit(*event.shorted_leg, event.short_circuit_A);
    } else if (event.inputs) {
        inputs_ = *event.inputs;
        board_.put_inputs(inputs_);
    } else if (event.stall_us) {
        board_.stall_control_interrupt(*event.stall_us * 1e-6);
    } else if (event.load) {
        put_load(*event.load, board_.plant());
    } else if (event.fault) {
        event.fault(board_.plant());
    } else {
        const double ramp = std::floor(event.drift_ramp_s / scenario_.plant.bridge.period_s + 0.5);
        for (const Drift &drift : event.drifts) {
            courses_.push_back({drift, drift.field->of(values_), n,
                                std::max(1u, static_cast<std::uint32_t>(ramp))});
        }
    }
}

/* Active at the level at which the drive's settings say that they are. */
void PlantEvents::put_switches()
{
    const MachineSwitches &switches = scenario_.switches;
    const auto low = static_cast<std::uint32_t>(scenario_.drive.inputs_low);
    if (switches.wired != 0) {
        const std::uint32_t levels = switches.active(board_.plant().state().theta_rad) ^ low;
        board_.put_inputs((inputs_ & ~switches.wired) | (levels & switches.wired));
    }
}

void PlantEvents::go_on(std::uint32_t n)
{
    drift(n);
    put_switches();
}

void PlantEvents::drift(std::uint32_t n)
{
    for (const Course &course : courses_) {
        const double part = (n - course.start + 1) / static_cast<double>(course.periods);
        course.drift.field->of(values_) =
            part < 1 ? course.from + (course.drift.to - course.from) * part : course.drift.to;
        put_plant_part(scenario_, values_, course.drift.field->part, board_.plant());
    }
    if (!courses_.empty()) {
        motor_ = scaled(scenario_.motor.params, values_.scales);
    }
    courses_.erase(std::remove_if(courses_.begin(), courses_.end(),
                                  [n](const Course &course) {
                                      return n - course.start + 1 >= course.periods;
                                  }),
                   courses_.end());
}

} // namespace scenario
