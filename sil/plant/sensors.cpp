#include "sil/plant/sensors.h"

#include "sil/plant/elementary.h"
#include "sil/plant/gaussian.h"
#include "sil/plant/require.h"

namespace plant
{

namespace
{

/* Streams of the noise; each but those of faults serves both phases. */
enum Stream : std::uint64_t {
    current_stream = 1,
    phase_voltage_stream = 2,
    fault_stream = 3,     /* and behind it, one a channel of the first five */
    crosstalk_stream = 8, /* and of the sixth, behind this one */
    encoder_stream = 10
};

/* A code 0...highest; the clamp first, so that no conversion is out of range. */
int converted(double codes, double highest)
{
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

void require_gain(double gain, const char *field)
{
    require(gain >= 0.1 && gain <= 10.0, field, gain, "0.1...10");
}

void require_mismatch(double share, const char *field)
{
    require(magnitude(share) <= 0.1, field, share, "-0.1...0.1");
}

/* Not above a number within 64 bits. */
std::int64_t whole(double number)
{
    const auto towards_zero = static_cast<std::int64_t>(number);
    return towards_zero - (static_cast<double>(towards_zero) > number ? 1 : 0);
}

bool is_signed(Channel channel)
{
    return channel == Channel::phase_voltage_a || channel == Channel::phase_voltage_b;
}

void require_range(double range, const char *field)
{
    require(range > 0.0 && range <= 1e4, field, range, "0...10000, not 0");
}

} // namespace

int converter_codes(const SensorConfig &config)
{
    return config.exact ? 65536 : 4096;
}

int current_zero_code(const SensorConfig &config)
{
    return converter_codes(config) / 2;
}

int code_of(const Samples &samples, Channel channel)
{
    switch (channel) {
    case Channel::current_a:
        return samples.current_a;
    case Channel::current_b:
        return samples.current_b;
    case Channel::phase_voltage_a:
        return samples.phase_voltage_a;
    case Channel::phase_voltage_b:
        return samples.phase_voltage_b;
    case Channel::bridge_temperature:
        return samples.bridge_temperature;
    case Channel::bus_voltage:
        break;
    }
    return samples.bus_voltage;
}

double current_A_per_code(const SensorConfig &config)
{
    return 2.0 * config.current_range_A / converter_codes(config);
}

double phase_voltage_V_per_code(const SensorConfig &config)
{
    return 2.0 * config.phase_voltage_range_V / converter_codes(config);
}

double bus_V_per_code(const SensorConfig &config)
{
    return config.bus_range_V / converter_codes(config);
}

Sensors::Sensors(const SensorConfig &config, std::uint64_t seed)
    : seed_(seed), current_noise_(gaussian_key(seed, current_stream)),
      phase_voltage_noise_(gaussian_key(seed, phase_voltage_stream))
{
    set(config);
    set_bridge_temperature(25.0);
}

/* An NTC resistor to ground, its value at 25 degrees Celsius to the converter's supply. */
void Sensors::set_bridge_temperature(double bridge_C)
{
    constexpr double zero_C_K = 273.15, at_25_C_K = 298.15;
    require(bridge_C >= -50.0 && bridge_C <= 180.0, "bridge_temperature_C", bridge_C, "-50...180");
    const double exponent =
        config_.bridge_ntc_beta_K * (1.0 / (zero_C_K + bridge_C) - 1.0 / at_25_C_K);
    const double share = falling_exponential(-magnitude(exponent)); /* the smaller of the two */
    const double of_supply = (exponent < 0.0 ? share : 1.0) / (1.0 + share);
    bridge_temperature_code_ =
        static_cast<std::uint16_t>(converted(of_supply * converter_codes(config_), highest_code_));
}

void Sensors::set(const SensorConfig &config)
{
    config_ = config;
    require_range(config.current_range_A, "current_range_A");
    require_range(config.phase_voltage_range_V, "phase_voltage_range_V");
    require_range(config.bus_range_V, "bus_range_V");
    require_noise(config.current_noise_rms_A, "current_noise_rms_A");
    require_noise(config.phase_voltage_noise_rms_V, "phase_voltage_noise_rms_V");
    require_noise(config.converter_crosstalk_codes, "converter_crosstalk_codes");
    require_offset(config.current_offset_a_A, "current_offset_a_A");
    require_offset(config.current_offset_b_A, "current_offset_b_A");
    require_offset(config.phase_voltage_offset_a_V, "phase_voltage_offset_a_V");
    require_offset(config.phase_voltage_offset_b_V, "phase_voltage_offset_b_V");
    require_offset(config.current_offset_on_a_A, "current_offset_on_a_A");
    require_offset(config.current_offset_on_b_A, "current_offset_on_b_A");
    require_offset(config.phase_voltage_offset_on_a_V, "phase_voltage_offset_on_a_V");
    require_offset(config.phase_voltage_offset_on_b_V, "phase_voltage_offset_on_b_V");
    require_offset(config.current_residual_a_A, "current_residual_a_A");
    require_offset(config.current_residual_b_A, "current_residual_b_A");
    require_offset(config.phase_voltage_residual_a_V, "phase_voltage_residual_a_V");
    require_offset(config.phase_voltage_residual_b_V, "phase_voltage_residual_b_V");
    require_mismatch(config.divider_mismatch_a, "divider_mismatch_a");
    require_mismatch(config.divider_mismatch_b, "divider_mismatch_b");
    require_gain(config.current_gain_a, "current_gain_a");
    require_gain(config.current_gain_b, "current_gain_b");
    current_offset_A_[0] = Phases{config.current_offset_a_A, config.current_offset_b_A};
    current_offset_A_[1] =
        current_offset_A_[0] + Phases{config.current_offset_on_a_A, config.current_offset_on_b_A};
    phase_voltage_offset_V_[0] =
        Phases{config.phase_voltage_offset_a_V, config.phase_voltage_offset_b_V};
    phase_voltage_offset_V_[1] =
        phase_voltage_offset_V_[0] +
        Phases{config.phase_voltage_offset_on_a_V, config.phase_voltage_offset_on_b_V};
    current_residual_A_ = Phases{config.current_residual_a_A, config.current_residual_b_A};
    phase_voltage_residual_V_ =
        Phases{config.phase_voltage_residual_a_V, config.phase_voltage_residual_b_V};
    divider_mismatch_ = Phases{config.divider_mismatch_a, config.divider_mismatch_b};
    current_gain_ = Phases{config.current_gain_a, config.current_gain_b};
    codes_per_A_ = 1.0 / current_A_per_code(config);
    codes_per_phase_V_ = 1.0 / phase_voltage_V_per_code(config);
    codes_per_bus_V_ = 1.0 / bus_V_per_code(config);
    middle_code_ = 0.5 * converter_codes(config);
    highest_code_ = converter_codes(config) - 1;

    constexpr int most_counts = 1 << 30; /* a turn is far from wrapping the count */
    require(config.encoder_counts_per_turn >= 0 && config.encoder_counts_per_turn <= most_counts,
            "encoder_counts_per_turn", config.encoder_counts_per_turn, "0...2^30");
    require(magnitude(config.encoder_eccentricity_rad) <= 0.1, "encoder_eccentricity_rad",
            config.encoder_eccentricity_rad, "-0.1...0.1 rad");
    require(magnitude(config.encoder_phase_rad) <= 2.0 * pi, "encoder_phase_rad",
            config.encoder_phase_rad, "-2 pi...2 pi");
    require(config.encoder_index_rad <= 2.0 * pi, "encoder_index_rad", config.encoder_index_rad,
            "0...2 pi, or below 0: none");
    encoder_error_at_zero_rad_ =
        config.encoder_eccentricity_rad * unit_vector(config.encoder_phase_rad)[1];
}

/* In counts, their fractions too. */
double Sensors::encoder_travel(double theta_rad) const
{
    double seen_rad = theta_rad;
    if (config_.encoder_eccentricity_rad != 0.0) {
        const double angle = theta_rad + config_.encoder_phase_rad;
        const double within_turn = angle - 2.0 * pi * nearest_whole(angle * (0.5 / pi));
        seen_rad += config_.encoder_eccentricity_rad * unit_vector(within_turn)[1] -
                    encoder_error_at_zero_rad_;
    }
    constexpr double limit = 9e18; /* of what 64 bits hold */
    const double counts = seen_rad * (0.5 / pi) * config_.encoder_counts_per_turn;
    return counts > -limit ? (counts < limit ? counts : limit) : -limit;
}

std::int32_t Sensors::encoder_edges(double theta_rad) const
{
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(whole(encoder_travel(theta_rad))));
}

std::int32_t Sensors::encoder_count(double theta_rad) const
{
    return encoder_counted(encoder_edges(theta_rad));
}

/* Wraps as its edges do. */
std::int32_t Sensors::encoder_counted(std::int32_t edges) const
{
    const auto from = static_cast<std::uint32_t>(encoder_.edges);
    const auto passed = static_cast<std::int32_t>(static_cast<std::uint32_t>(edges) - from);
    std::uint32_t counted = 0;
    switch (encoder_.condition) {
    case EncoderCondition::sound:
    case EncoderCondition::noisy:
    case EncoderCondition::lossy:
        counted = static_cast<std::uint32_t>(passed);
        break;
    case EncoderCondition::frozen:
        break;
    case EncoderCondition::reversed:
        counted = 0u - static_cast<std::uint32_t>(passed);
        break;
    case EncoderCondition::half:
        counted = static_cast<std::uint32_t>(passed / 2);
        break;
    }
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(encoder_.count) + counted);
}

void Sensors::set_encoder(EncoderCondition condition, double theta_rad, double share)
{
    require(config_.encoder_counts_per_turn > 0, "encoder_counts_per_turn",
            config_.encoder_counts_per_turn, "1 at least: without an encoder none can fail");
    encoder_.count = encoder_count(theta_rad);
    encoder_.edges = encoder_edges(theta_rad);
    encoder_.condition = condition;
    encoder_.share = share;
}

/* What goes wrong with the edges since the last period; the count goes on from here. */
void Sensors::miscount(std::uint64_t period, double theta_rad)
{
    const double drawn = uniform_number(gaussian_key(seed_, encoder_stream), period);
    const std::int32_t count = encoder_count(theta_rad);
    const std::int32_t edges = encoder_edges(theta_rad);
    const auto passed = static_cast<std::int32_t>(static_cast<std::uint32_t>(edges) -
                                                  static_cast<std::uint32_t>(encoder_.edges));
    std::int32_t wrong = 0;
    if (encoder_.condition == EncoderCondition::lossy) {
        const double lost = magnitude(static_cast<double>(passed)) * encoder_.share + drawn;
        wrong = static_cast<std::int32_t>(lost) * (passed > 0 ? -1 : 1);
    } else if (drawn < encoder_.share) {
        wrong = drawn < 0.5 * encoder_.share ? 1 : -1;
    }
    encoder_.edges = edges;
    encoder_.count = static_cast<std::int32_t>(static_cast<std::uint32_t>(count) +
                                               static_cast<std::uint32_t>(wrong));
}

/* On the way from the last sample to this one: what begins upwards ends downwards. */
void Sensors::pass_index(Samples &samples, double travel) const
{
    const double turn = config_.encoder_counts_per_turn;
    const double begins = config_.encoder_index_rad * (0.5 / pi) * turn;
    for (const bool lower : {true, false}) {
        const double edge = begins + (lower ? 0.0 : 1.0);
        const std::int64_t before = whole((index_travel_ - edge) / turn);
        const std::int64_t now = whole((travel - edge) / turn);
        if (now == before) {
            continue;
        }
        const double at = edge + static_cast<double>(now > before ? now : before) * turn;
        const auto edges = static_cast<std::int32_t>(static_cast<std::uint32_t>(whole(at)));
        IndexEdge &passed = (now > before) == lower ? samples.index_rise : samples.index_fall;
        passed = {true, encoder_counted(edges)};
    }
}

Samples Sensors::sample(std::uint64_t period, const True &now)
{
    Phases current_A = now.current_A;
    Phases phase_voltage_V = now.phase_voltage_V;
    if (!config_.exact) {
        const int on = now.bridge_on ? 1 : 0;
        current_A = current_gain_ * current_A + current_offset_A_[on] +
                    config_.current_noise_rms_A * gaussian_pair(current_noise_, period);
        phase_voltage_V +=
            phase_voltage_offset_V_[on] +
            config_.phase_voltage_noise_rms_V * gaussian_pair(phase_voltage_noise_, period);
        if (now.asked) {
            current_A += current_residual_A_;
            phase_voltage_V += phase_voltage_residual_V_;
        }
        if (now.bridge_on) {
            phase_voltage_V += divider_mismatch_ * now.legs_V;
        }
    }
    Phases current = current_A * codes_per_A_ + middle_code_;
    if (config_.converter_crosstalk_codes > 0.0 && !config_.exact) {
        current += config_.converter_crosstalk_codes *
                   gaussian_pair(gaussian_key(seed_, crosstalk_stream), period);
    }
    const Phases voltage = phase_voltage_V * codes_per_phase_V_ + middle_code_;
    const int zero_V_code = static_cast<int>(middle_code_);
    Samples samples;
    samples.current_a = static_cast<std::uint16_t>(converted(current[0], highest_code_));
    samples.current_b = static_cast<std::uint16_t>(converted(current[1], highest_code_));
    samples.bus_voltage =
        static_cast<std::uint16_t>(converted(now.bus_V * codes_per_bus_V_, highest_code_));
    samples.phase_voltage_a =
        static_cast<std::int16_t>(converted(voltage[0], highest_code_) - zero_V_code);
    samples.phase_voltage_b =
        static_cast<std::int16_t>(converted(voltage[1], highest_code_) - zero_V_code);
    samples.bridge_temperature = bridge_temperature_code_;
    if (config_.encoder_counts_per_turn > 0) {
        if (encoder_.condition >= EncoderCondition::noisy) {
            miscount(period, now.theta_rad);
        }
        samples.encoder_count = encoder_count(now.theta_rad);
        const double travel = encoder_travel(now.theta_rad);
        if (index_followed_ && config_.encoder_index_rad >= 0.0) {
            pass_index(samples, travel);
        }
        index_travel_ = travel;
        index_followed_ = true;
    }
    if (faulty_) {
        apply_faults(samples, period);
    }
    return samples;
}

/* Clamped to what the converter can say. */
void Sensors::write(Samples &samples, Channel channel, int code) const
{
    const int codes = converter_codes(config_);
    const int lowest = is_signed(channel) ? -codes / 2 : 0;
    const int highest = lowest + codes - 1;
    const int written = code < lowest ? lowest : (code > highest ? highest : code);
    switch (channel) {
    case Channel::current_a:
        samples.current_a = static_cast<std::uint16_t>(written);
        break;
    case Channel::current_b:
        samples.current_b = static_cast<std::uint16_t>(written);
        break;
    case Channel::phase_voltage_a:
        samples.phase_voltage_a = static_cast<std::int16_t>(written);
        break;
    case Channel::phase_voltage_b:
        samples.phase_voltage_b = static_cast<std::int16_t>(written);
        break;
    case Channel::bus_voltage:
        samples.bus_voltage = static_cast<std::uint16_t>(written);
        break;
    case Channel::bridge_temperature:
        samples.bridge_temperature = static_cast<std::uint16_t>(written);
        break;
    }
}

void Sensors::apply_faults(Samples &samples, std::uint64_t period) const
{
    for (int n = 0; n < channels; n++) {
        const Fault &fault = faults_[n];
        const Channel channel = static_cast<Channel>(n);
        if (fault.stuck) {
            write(samples, channel, fault.code);
        } else if (fault.noise_rms > 0.0) {
            const std::uint64_t stream = channel == Channel::bridge_temperature
                                             ? crosstalk_stream + std::uint64_t{1}
                                             : fault_stream + static_cast<std::uint64_t>(n);
            const double noise =
                fault.noise_rms * gaussian_pair(gaussian_key(seed_, stream), period)[0];
            write(samples, channel,
                  code_of(samples, channel) + static_cast<int>(nearest_whole(noise)));
        }
    }
}

void Sensors::stick(Channel channel, int code)
{
    const int codes = converter_codes(config_);
    const int lowest = is_signed(channel) ? -codes / 2 : 0;
    require(code >= lowest && code < lowest + codes, "code", code,
            is_signed(channel) ? (config_.exact ? "-32768...32767" : "-2048...2047")
                               : (config_.exact ? "0...65535" : "0...4095"));
    Fault &fault = faults_[static_cast<int>(channel)];
    fault.stuck = true;
    fault.code = code;
    faulty_ = true;
}

void Sensors::release(Channel channel)
{
    faults_[static_cast<int>(channel)].stuck = false;
}

void Sensors::add_noise(Channel channel, double rms_codes)
{
    require(rms_codes >= 0.0 && rms_codes <= 1e4, "noise_codes", rms_codes, "0...10000");
    faults_[static_cast<int>(channel)].noise_rms = rms_codes;
    faulty_ = true;
}

} // namespace plant
