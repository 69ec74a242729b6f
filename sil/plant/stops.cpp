#include "sil/plant/stops.h"

#include <cmath>

#include "sil/plant/require.h"

namespace plant
{

namespace
{

constexpr double furthest_rad = 1e7;

bool is_angle_or_none(double angle_rad)
{
    return std::isinf(angle_rad) || std::fabs(angle_rad) <= furthest_rad;
}

} // namespace

bool Stops::present() const
{
    return std::isfinite(low_rad) || std::isfinite(high_rad);
}

double Stops::nearer(double angle_rad) const
{
    if (!present()) {
        return 0.0;
    }
    return high_rad - angle_rad <= angle_rad - low_rad ? 1.0 : -1.0;
}

double Stops::beyond_rad(double angle_rad, double side) const
{
    return side == 0.0 ? 0.0 : side > 0.0 ? angle_rad - high_rad : low_rad - angle_rad;
}

Stops stops_of(const StopConfig &config)
{
    require(is_angle_or_none(config.low_rad), "stop_low_rad", config.low_rad, "-1e7...1e7 rad");
    require(is_angle_or_none(config.high_rad), "stop_high_rad", config.high_rad, "-1e7...1e7 rad");
    require(config.low_rad < config.high_rad, "stop_low_rad", config.low_rad,
            "less than stop_high_rad");
    require(config.stiffness_Nm_rad >= 0.1 && config.stiffness_Nm_rad <= 1e5,
            "stop_stiffness_Nm_rad", config.stiffness_Nm_rad, "0.1...1e5 N m/rad");
    require(config.damping >= 0.0 && config.damping <= 2.0, "stop_damping", config.damping,
            "0...2");
    return {config.low_rad, config.high_rad, config.stiffness_Nm_rad, config.damping};
}

} // namespace plant
