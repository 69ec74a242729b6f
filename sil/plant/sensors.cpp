#include "sil/plant/sensors.h"

#include "sil/plant/gaussian.h"
#include "sil/plant/require.h"

namespace plant
{

namespace
{

/* Channels of the noise; each serves both phases. */
enum Channel : std::uint64_t { current_channel = 1, phase_voltage_channel = 2 };

/* A code 0...4095; the clamp first, so that no conversion is out of range. */
int converted(double codes)
{
    constexpr double highest = converter_codes - 1;
    const double clamped = codes > 0.0 ? (codes < highest ? codes : highest) : 0.0;
    return static_cast<int>(clamped + 0.5);
}

void require_noise(double rms, const char *field)
{
    require(rms >= 0.0 && rms <= 1e3, field, rms, "0...1000");
}

void require_offset(double offset, const char *field)
{
    require(magnitude(offset) <= 1e3, field, offset, "-1000...1000");
}

void require_range(double range, const char *field)
{
    require(range > 0.0 && range <= 1e4, field, range, "0...10000, not 0");
}

} // namespace

double current_A_per_code(const SensorConfig &config)
{
    return 2.0 * config.current_range_A / converter_codes;
}

double phase_voltage_V_per_code(const SensorConfig &config)
{
    return 2.0 * config.phase_voltage_range_V / converter_codes;
}

double bus_V_per_code(const SensorConfig &config)
{
    return config.bus_range_V / converter_codes;
}

Sensors::Sensors(const SensorConfig &config, std::uint64_t seed) : config_(config), seed_(seed)
{
    require_range(config.current_range_A, "current_range_A");
    require_range(config.phase_voltage_range_V, "phase_voltage_range_V");
    require_range(config.bus_range_V, "bus_range_V");
    require_noise(config.current_noise_rms_A, "current_noise_rms_A");
    require_noise(config.phase_voltage_noise_rms_V, "phase_voltage_noise_rms_V");
    require_offset(config.current_offset_a_A, "current_offset_a_A");
    require_offset(config.current_offset_b_A, "current_offset_b_A");
    require_offset(config.phase_voltage_offset_a_V, "phase_voltage_offset_a_V");
    require_offset(config.phase_voltage_offset_b_V, "phase_voltage_offset_b_V");
    current_offset_A_ = Phases{config.current_offset_a_A, config.current_offset_b_A};
    phase_voltage_offset_V_ =
        Phases{config.phase_voltage_offset_a_V, config.phase_voltage_offset_b_V};
    codes_per_A_ = 1.0 / current_A_per_code(config);
    codes_per_phase_V_ = 1.0 / phase_voltage_V_per_code(config);
    codes_per_bus_V_ = 1.0 / bus_V_per_code(config);
}

Samples Sensors::sample(std::uint64_t period, Phases current_A, Phases phase_voltage_V,
                        double bus_V) const
{
    if (!config_.exact) {
        current_A += current_offset_A_ +
                     config_.current_noise_rms_A * gaussian_pair(seed_, current_channel, period);
        phase_voltage_V +=
            phase_voltage_offset_V_ +
            config_.phase_voltage_noise_rms_V * gaussian_pair(seed_, phase_voltage_channel, period);
    }
    const Phases current = current_A * codes_per_A_ + current_zero_code;
    const Phases voltage = phase_voltage_V * codes_per_phase_V_ + converter_codes / 2;
    Samples samples;
    samples.current_a = static_cast<std::uint16_t>(converted(current[0]));
    samples.current_b = static_cast<std::uint16_t>(converted(current[1]));
    samples.bus_voltage = static_cast<std::uint16_t>(converted(bus_V * codes_per_bus_V_));
    samples.phase_voltage_a =
        static_cast<std::int16_t>(converted(voltage[0]) - converter_codes / 2);
    samples.phase_voltage_b =
        static_cast<std::int16_t>(converted(voltage[1]) - converter_codes / 2);
    return samples;
}

} // namespace plant
