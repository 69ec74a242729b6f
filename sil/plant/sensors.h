/*
 * From true values to the codes of the converters: offset, Gaussian noise, 12 bits, saturation.
 * Rounding is to the nearest code, ties upwards; codes clamp at the ends of their range.
 */
#ifndef STEADYSTEP_PLANT_SENSORS_H
#define STEADYSTEP_PLANT_SENSORS_H

#include "sil/plant/phases.h"
#include "sil/plant/plant.h"

namespace plant
{

constexpr int converter_codes = 4096; /* 12 bits */
constexpr int current_zero_code = converter_codes / 2;

/* Size of a code, SI units. */
double current_A_per_code(const SensorConfig &config);
double phase_voltage_V_per_code(const SensorConfig &config);
double bus_V_per_code(const SensorConfig &config);

class Sensors
{
  public:
    Sensors(const SensorConfig &config, std::uint64_t seed); /* throws std::invalid_argument */

    /* current_A at S(period); phase_voltage_V: mean over the period that ends there. */
    Samples sample(std::uint64_t period, Phases current_A, Phases phase_voltage_V,
                   double bus_V) const;

  private:
    SensorConfig config_;
    std::uint64_t seed_;
    Phases current_offset_A_, phase_voltage_offset_V_;
    double codes_per_A_, codes_per_phase_V_, codes_per_bus_V_;
};

} // namespace plant

#endif
