/*
 * The simulated motor, bridge, load and sensors: double precision, no firmware, no clock, no
 * library function whose result may differ between compilers.
 *
 * Model and signs: see sil/plant/README.md. All quantities SI.
 */
#ifndef STEADYSTEP_PLANT_H
#define STEADYSTEP_PLANT_H

#include <cstdint>
#include <memory>

namespace plant
{

enum class BridgeModel {
    averaged, /* the commanded mean voltage acts; no dead time, no ripple */
    switched  /* two H-bridges, every edge solved exactly, dead time with diode conduction */
};

struct MotorConfig {
    double resistance_ohm = 0;
    double inductance_H = 0;
    double torque_constant_Nm_A = 0;
    double viscous_friction_Nms_rad = 0;
    double inertia_kgm2 = 0;
    int rotor_teeth = 0;
};

struct BridgeConfig {
    BridgeModel model = BridgeModel::switched;
    double bus_V = 24.0;
    double dead_time_s = 1e-6; /* both gates of a leg off after each edge */
    double diode_drop_V = 1.0; /* a leg in dead time sits at -drop or bus + drop by current sign */
    double period_s = 1e-4;
    int half_period_counts = 8500; /* resolution of the duties */
    int delay_periods = 1; /* 1: duties computed from S(k) act S(k+1)...S(k+2); 0: at once */
};

struct SensorConfig {
    bool exact = false;           /* true: no noise and no offset; codes stay 12 bit */
    double current_range_A = 6.0; /* +- full scale, 12 bit */
    double current_noise_rms_A = 3e-3;
    double current_offset_a_A = 0.0;
    double current_offset_b_A = 0.0;
    double phase_voltage_range_V = 31.2; /* +- full scale, 12 bit; 1.3 x nominal bus */
    double phase_voltage_noise_rms_V = 20e-3;
    double phase_voltage_offset_a_V = 0.0;
    double phase_voltage_offset_b_V = 0.0;
    double bus_range_V = 31.2; /* full scale, 12 bit */
};

struct Config {
    MotorConfig motor;
    BridgeConfig bridge;
    SensorConfig sensors;
    std::uint64_t seed = 1;
    double initial_theta_rad = 0.0;
    double initial_omega_rad_s = 0.0;
    bool track_energy = false; /* keep Energy; costs about a fifth of the speed */
};

/* Times high per half period of the four half-bridges: A+, A-, B+, B-; as in hal_outputs. */
struct Duties {
    std::uint16_t high_counts[4] = {0, 0, 0, 0};
    bool bridge_on = false;
};

/* Raw codes at S(k); the fields and scales are those of hal_samples. */
struct Samples {
    std::uint16_t current_a = 0, current_b = 0, bus_voltage = 0;
    std::int16_t phase_voltage_a = 0, phase_voltage_b = 0;
};

/* True values at S(k). Voltages: means over S(k-1)...S(k). */
struct State {
    double theta_rad = 0, omega_rad_s = 0;
    double i_a_A = 0, i_b_A = 0;
    double u_a_V = 0, u_b_V = 0;
    double torque_Nm = 0, load_torque_Nm = 0, bus_V = 0;
};

/* Energy bookkeeping since the start, J: supplied (by the bus) = copper + magnetic + kinetic +
   friction + load + diode, to 1e-6 of the energy supplied. All 0 without Config::track_energy. */
struct Energy {
    double supplied = 0, copper = 0, magnetic = 0, kinetic = 0, friction = 0, load = 0;
    double diode = 0; /* lost in the bridge's diodes during dead time and with the bridge off */
};

class Plant
{
  public:
    explicit Plant(const Config &config); /* throws std::invalid_argument naming the field */
    ~Plant();
    Plant(const Plant &) = delete;
    Plant &operator=(const Plant &) = delete;

    /* Advances from S(k) to S(k+1). `duties` were computed from the samples of S(k); the plant
       applies the configured delay. */
    void step(const Duties &duties);

    const State &state() const
    {
        return state_;
    }
    const Samples &samples() const
    {
        return samples_;
    } /* of the present S(k) */
    const Energy &energy() const
    {
        return energy_;
    }

    /* Changes that act from the present S(k) on. */
    void set_load_torque(double load_torque_Nm);
    void set_motor(const MotorConfig &motor); /* drift and faults: currents, angle, speed go on */

  private:
    struct Parts; /* motor, bridge, sensors */

    void observe();

    std::unique_ptr<Parts> parts_;
    State state_;
    Samples samples_;
    Energy energy_;
};

} // namespace plant

#endif
