/*
 * The torque of the machine on the shaft: what is asked for at once or within a ramp, and a
 * vibration on top of it. Counts in periods.
 */
#ifndef STEADYSTEP_PLANT_SHAFT_LOAD_H
#define STEADYSTEP_PLANT_SHAFT_LOAD_H

#include <cstdint>

namespace plant
{

class ShaftLoad
{
  public:
    explicit ShaftLoad(double period_s) : period_s_(period_s)
    {
    }

    /* From period n on; the last of the ramp's periods has the whole torque. */
    void go_to(double torque_Nm, double ramp_s, std::uint64_t n);
    void vibrate(double amplitude_Nm, double frequency_Hz, std::uint64_t n);
    /* Whether the torque of period n may be another than that of the period before. */
    bool moves(std::uint64_t n) const
    {
        return amplitude_Nm_ != 0 || n - ramp_start_ < ramp_periods_;
    }
    double torque_Nm(std::uint64_t n) const;

  private:
    double period_s_;
    double from_Nm_ = 0, to_Nm_ = 0;
    std::uint64_t ramp_start_ = 0, ramp_periods_ = 0;
    double amplitude_Nm_ = 0, frequency_Hz_ = 0;
    std::uint64_t vibration_start_ = 0;

    double steady_Nm(std::uint64_t n) const;
};

} // namespace plant

#endif
