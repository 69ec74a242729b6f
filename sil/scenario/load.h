/*
 * The torque of the machine on the shaft: what is asked for at once or within a ramp, and a
 * vibration on top of it.
 */
#ifndef STEADYSTEP_SCENARIO_LOAD_H
#define STEADYSTEP_SCENARIO_LOAD_H

#include <cstdint>

#include "sil/scenario/table_reader.h"

namespace scenario
{

/* The longest way of a load, or of another value that goes somewhere. */
constexpr double longest_ramp_s = 600;

/* One or the other. */
struct LoadChange {
    bool vibrates = false;
    double torque_Nm = 0; /* where to; of a vibration the amplitude, 0 ends it */
    double ramp_s = 0;
    double vibration_Hz = 0;
};

/* The keys of an event that say so. */
extern const char *const load_torque_key;
extern const char *const load_vibration_key;

/* Of an event that has one of them; throws InputError. */
LoadChange read_load_change(TableReader &event);

/* Counts in control periods. */
class Load
{
  public:
    explicit Load(double period_s) : period_s_(period_s)
    {
    }

    void change(const LoadChange &change, std::uint32_t n);
    /* Whether the torque of period n may be another than that of the period before. */
    bool moves(std::uint32_t n) const
    {
        return n == changed_ || amplitude_Nm_ != 0 || n - ramp_start_ < ramp_periods_;
    }
    /* Of period n, which comes behind those asked for before. */
    double torque_Nm(std::uint32_t n) const;

  private:
    double period_s_;
    double from_Nm_ = 0, to_Nm_ = 0;
    std::uint32_t ramp_start_ = 0, ramp_periods_ = 0;
    double amplitude_Nm_ = 0, vibration_Hz_ = 0;
    std::uint32_t vibration_start_ = 0, changed_ = UINT32_MAX;

    double steady_Nm(std::uint32_t n) const;
};

} // namespace scenario

#endif
