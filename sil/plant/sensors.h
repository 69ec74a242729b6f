/*
 * From true values to the codes of the converters: offset, Gaussian noise, 12 bits, saturation. A
 * faulty converter sticks at a code, or has more noise than its kind; a faulty encoder's count goes
 * another way than its rotor.
 * Rounding is to the nearest code, ties upwards; codes clamp at the ends of their range. An encoder
 * counts whole steps: the floor of the angle. Its index is on the same disc, high for a count a
 * turn; what a timer would capture at its edges is in the samples.
 */
#ifndef STEADYSTEP_PLANT_SENSORS_H
#define STEADYSTEP_PLANT_SENSORS_H

#include "sil/plant/phases.h"
#include "sil/plant/plant.h"

namespace plant
{

/* 12 bits; 16 where sensing is exact: as fine as the HAL's codes allow. */
int converter_codes(const SensorConfig &config);
int current_zero_code(const SensorConfig &config);

/* Size of a code, SI units. */
double current_A_per_code(const SensorConfig &config);
double phase_voltage_V_per_code(const SensorConfig &config);
double bus_V_per_code(const SensorConfig &config);

constexpr int channels = 6;
int code_of(const Samples &samples, Channel channel);

/* The quantities that are sensed, as they are. */
struct True {
    Phases current_A, phase_voltage_V;
    double bus_V, theta_rad;
    bool bridge_on;
    bool asked = false;         /* for a voltage, since it came on */
    Phases legs_V = {0.0, 0.0}; /* sum of the voltages of a phase's legs */
};

class Sensors
{
  public:
    Sensors(const SensorConfig &config, std::uint64_t seed); /* throws std::invalid_argument */

    /* The same converters with other offsets, gains and noise; their faults stay. */
    void set(const SensorConfig &config);

    void set_bridge_temperature(double bridge_C);
    void stick(Channel channel, int code);
    void release(Channel channel);
    void add_noise(Channel channel, double rms_codes);
    /* From this angle on. share: of the periods in which a noisy one miscounts, of the edges that a
       lossy one does not count. */
    void set_encoder(EncoderCondition condition, double theta_rad, double share = 0.0);

    /* At S(period); phase_voltage_V: mean over the period that ends there, in which the bridge
       was on or off. */
    Samples sample(std::uint64_t period, const True &now);

  private:
    void apply_faults(Samples &samples, std::uint64_t period) const;
    void write(Samples &samples, Channel channel, int code) const;
    void miscount(std::uint64_t period, double theta_rad);
    double encoder_travel(double theta_rad) const;
    std::int32_t encoder_edges(double theta_rad) const;
    std::int32_t encoder_counted(std::int32_t edges) const;
    std::int32_t encoder_count(double theta_rad) const;
    void pass_index(Samples &samples, double travel) const;

    SensorConfig config_;
    std::uint64_t seed_, current_noise_, phase_voltage_noise_; /* the latter two are keys of it */
    /* With the bridge off and on. */
    Phases current_offset_A_[2], phase_voltage_offset_V_[2];
    Phases current_residual_A_, phase_voltage_residual_V_;
    Phases divider_mismatch_;
    Phases current_gain_;
    double codes_per_A_, codes_per_phase_V_, codes_per_bus_V_;
    double middle_code_, highest_code_;
    double encoder_error_at_zero_rad_ = 0.0;
    struct Fault {
        bool stuck = false;
        int code = 0; /* at which it is stuck */
        double noise_rms = 0.0;
    };
    Fault faults_[channels];
    struct Encoder {
        EncoderCondition condition = EncoderCondition::sound;
        std::int32_t edges = 0, count = 0; /* where it came into this condition, or miscounted */
        double share = 0.0;
    };
    Encoder encoder_;
    double index_travel_ = 0.0; /* of the encoder at the last sample */
    bool index_followed_ = false;
    bool faulty_ = false;
    std::uint16_t bridge_temperature_code_ = 0;
};

} // namespace plant

#endif
