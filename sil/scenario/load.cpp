#include "sil/scenario/load.h"

#include <algorithm>
#include <cmath>

#include "sil/plant/elementary.h"

namespace scenario
{

namespace
{

constexpr double largest_Nm = 100;
constexpr double lowest_Hz = 0.01, highest_Hz = 1000;

} // namespace

const char *const load_torque_key = "load_torque_Nm";
const char *const load_vibration_key = "load_vibration_Nm";

LoadChange read_load_change(TableReader &event)
{
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
    event.number("load_vibration_Hz", change.vibration_Hz, lowest_Hz, highest_Hz);
    return change;
}

void Load::change(const LoadChange &change, std::uint32_t n)
{
    changed_ = n;
    if (change.vibrates) {
        amplitude_Nm_ = change.torque_Nm;
        vibration_Hz_ = change.vibration_Hz;
        vibration_start_ = n;
        return;
    }
    from_Nm_ = steady_Nm(n);
    to_Nm_ = change.torque_Nm;
    ramp_start_ = n;
    ramp_periods_ =
        std::max(1u, static_cast<std::uint32_t>(std::floor(change.ramp_s / period_s_ + 0.5)));
}

double Load::steady_Nm(std::uint32_t n) const
{
    const std::uint32_t passed = n - ramp_start_;
    return passed + 1 < ramp_periods_
               ? from_Nm_ +
                     (to_Nm_ - from_Nm_) * ((passed + 1) / static_cast<double>(ramp_periods_))
               : to_Nm_;
}

double Load::torque_Nm(std::uint32_t n) const
{
    if (amplitude_Nm_ == 0) {
        return steady_Nm(n);
    }
    const double cycles = vibration_Hz_ * ((n - vibration_start_) * period_s_);
    const double turn = 2 * plant::pi * (cycles - std::floor(cycles));
    return steady_Nm(n) + amplitude_Nm_ * plant::unit_vector(turn)[1];
}

} // namespace scenario
