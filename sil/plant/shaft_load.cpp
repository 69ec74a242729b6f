#include "sil/plant/shaft_load.h"

#include "sil/plant/elementary.h"

namespace plant
{

void ShaftLoad::go_to(double torque_Nm, double ramp_s, std::uint64_t n)
{
    const double periods = nearest_whole(ramp_s / period_s_);
    from_Nm_ = steady_Nm(n);
    to_Nm_ = torque_Nm;
    ramp_start_ = n;
    ramp_periods_ = periods > 1 ? static_cast<std::uint64_t>(periods) : 1;
}

void ShaftLoad::vibrate(double amplitude_Nm, double frequency_Hz, std::uint64_t n)
{
    amplitude_Nm_ = amplitude_Nm;
    frequency_Hz_ = frequency_Hz;
    vibration_start_ = n;
}

double ShaftLoad::steady_Nm(std::uint64_t n) const
{
    const std::uint64_t passed = n - ramp_start_ + 1;
    const double part = static_cast<double>(passed) / static_cast<double>(ramp_periods_);
    return passed < ramp_periods_ ? from_Nm_ + (to_Nm_ - from_Nm_) * part : to_Nm_;
}

double ShaftLoad::torque_Nm(std::uint64_t n) const
{
    if (amplitude_Nm_ == 0) {
        return steady_Nm(n);
    }
    const double cycles = frequency_Hz_ * (static_cast<double>(n - vibration_start_) * period_s_);
    const double part = cycles - static_cast<double>(static_cast<std::uint64_t>(cycles));
    return steady_Nm(n) + amplitude_Nm_ * unit_vector(2 * pi * part)[1];
}

} // namespace plant
