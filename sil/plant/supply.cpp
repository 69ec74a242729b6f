#include "sil/plant/supply.h"

#include <limits>

#include "sil/plant/require.h"

namespace plant
{

Supply supply_of(const SupplyConfig &config, double source_V)
{
    constexpr double brake_hysteresis = 0.98;
    Supply supply;
    supply.source_V = source_V;
    require(config.bus_source_ohm >= 0.0 && config.bus_source_ohm <= 100.0, "bus_source_ohm",
            config.bus_source_ohm, "0...100 ohm");
    if (config.bus_source_ohm == 0.0) {
        return supply;
    }
    const double time_constant_s = config.bus_source_ohm * config.bus_capacitance_F;
    require(time_constant_s >= 1e-6 && time_constant_s <= 1.0, "bus_capacitance_F",
            config.bus_capacitance_F, "bus_source_ohm x bus_capacitance_F of 1e-6...1 s");
    require(config.brake_ohm == 0.0 || (config.brake_ohm >= 0.1 && config.brake_ohm <= 1e6),
            "brake_ohm", config.brake_ohm, "0 (not fitted) or 0.1...1e6 ohm");
    supply.source_rate = 1.0 / time_constant_s;
    supply.per_capacitance = 1.0 / config.bus_capacitance_F;
    supply.capacitance_F = config.bus_capacitance_F;
    if (config.brake_ohm > 0.0) {
        supply.brake_rate = 1.0 / (config.brake_ohm * config.bus_capacitance_F);
        supply.brake_by_drive = config.brake_by_drive;
    }
    if (config.brake_ohm > 0.0 && config.brake_by_drive) {
        supply.brake_on_V = std::numeric_limits<double>::max();
        supply.brake_off_V = -supply.brake_on_V;
    } else if (config.brake_ohm > 0.0) {
        supply.brake_on_V = config.brake_V;
        supply.brake_off_V = brake_hysteresis * config.brake_V;
        require(supply.brake_off_V > source_V, "brake_V", config.brake_V,
                "above the source's voltage by 3 %");
    }
    return supply;
}

} // namespace plant
