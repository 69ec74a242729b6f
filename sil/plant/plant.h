/*
 * The simulated motor, bridge, load and sensors: double precision, no firmware, no clock, no
 * library function whose result may differ between compilers.
 *
 * Model and signs: see sil/plant/README.md. All quantities SI.
 */
#ifndef STEADYSTEP_PLANT_H
#define STEADYSTEP_PLANT_H

#include <cstdint>
#include <limits>
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

/* Iron under the winding's flux linkage, the magnet's included; equations: iron.h. */
struct IronConfig {
    double hysteresis = 0;         /* coercive current / rated current; 0: none */
    double hysteresis_flux = 0.32; /* flux linkage that turns the iron / (Km / N) */
    double eddy_time_s = 0;        /* inductance of a phase / loss resistance beside it; 0: none */
    double eddy_lag_s = 100e-6;    /* behind the voltage induced */
};

/* Part of the inertia behind a spring and a damper; equations: belt.h. */
struct BeltConfig {
    double inertia_share = 0;  /* of the inertia, on the far side; 0: all is one mass */
    double frequency_Hz = 100; /* at which the two masses swing against one another, */
    double damping = 0.02;     /* and its damping ratio */
};

/* What a real motor has beyond its six parameters; all 0: the plain equations. Shares are of the
   holding torque, sqrt 2 x torque constant x rated current. Equations: magnetics.h, real_motor.h.
 */
struct ImperfectionConfig {
    double rated_current_A = 0;  /* needed by every share */
    double saturation_depth = 0; /* fall of the incremental inductance of a phase from the
                                    unsaturated one, with magnet and rated current aligned */
    double flux_harmonic_3 = 0;  /* third harmonic of the back-EMF / its fundamental */
    double detent_4 = 0, detent_2 = 0, detent_1 = 0; /* shares; of period 4, 2, 1 per tooth */
    double coulomb_friction = 0;                     /* share; sticks at rest */
    double bridge_resistance_ohm = 0;  /* both conducting switches, in series with each phase */
    double phase_voltage_filter_s = 0; /* time constant before the phase voltage is averaged */
    IronConfig iron = {};
    BeltConfig belt = {};
    /* Of one phase, relative to the motor's; bridge_resistance_ohm is apart. */
    double resistance_a_scale = 1.0, resistance_b_scale = 1.0;
    double inductance_a_scale = 1.0, inductance_b_scale = 1.0;
    double magnet_rise_K = 0;            /* above the temperature of the torque constant */
    double magnet_flux_per_K = -0.11e-2; /* what its flux changes by, relative */
};

/* Where the machine ends; equations: stops.h. */
struct StopConfig {
    double low_rad = -std::numeric_limits<double>::infinity(); /* mechanical; none */
    double high_rad = std::numeric_limits<double>::infinity();
    double stiffness_Nm_rad = 100.0;
    double damping = 0.1; /* ratio, of the inertia that strikes it */
};

/* The bus: a source that cannot take current back, a capacitor, a brake resistor. */
struct SupplyConfig {
    double bus_source_ohm = 0;         /* 0: a stiff source, nothing of the rest */
    double bus_capacitance_F = 470e-6; /* bus_source_ohm x bus_capacitance_F: 1e-6...1 s */
    double brake_ohm = 0;              /* 0: not fitted */
    double brake_V = 30.0;             /* connects it; below 98 % of this it is off again */
    bool brake_by_drive = false;       /* Duties::brake_on connects it instead */
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
    double low_state_s = 4e-6;    /* for which currents are to be seen around each S(k) */
    bool exact = false;           /* true: no noise, no offset, and codes of 16 bits, not 12 */
    double current_range_A = 6.0; /* +- full scale */
    double current_noise_rms_A = 3e-3;
    /* What converters that do not run from one clock do to the currents of each other, rms codes;
       on real ones most around the middle of their range, here everywhere. */
    double converter_crosstalk_codes = 0.0;
    double current_offset_a_A = 0.0;
    double current_offset_b_A = 0.0;
    double current_offset_on_a_A = 0.0; /* only while the bridge is on: calibration misses it */
    double current_offset_on_b_A = 0.0;
    /* What appears once a voltage is asked for, and goes with the bridge: calibration misses it. */
    double current_residual_a_A = 0.0;
    double current_residual_b_A = 0.0;
    double current_gain_a = 1.0;
    double current_gain_b = 1.0;
    double phase_voltage_range_V = 31.2; /* +- full scale; 1.3 x nominal bus */
    double phase_voltage_noise_rms_V = 20e-3;
    double phase_voltage_offset_a_V = 0.0;
    double phase_voltage_offset_b_V = 0.0;
    double phase_voltage_offset_on_a_V = 0.0; /* only while the bridge is on */
    double phase_voltage_offset_on_b_V = 0.0;
    double phase_voltage_residual_a_V = 0.0;
    double phase_voltage_residual_b_V = 0.0;
    /* Half of what the dividers of a phase's two legs differ by: a share of the sum of the legs'
       voltages, which is the bus voltage, while the bridge is on. */
    double divider_mismatch_a = 0.0;
    double divider_mismatch_b = 0.0;
    double bus_range_V = 31.2;             /* full scale */
    double bridge_ntc_beta_K = 3435.0;     /* hal.h */
    int encoder_counts_per_turn = 0;       /* quadrature counts; 0: no encoder */
    double encoder_eccentricity_rad = 0.0; /* amplitude of an error that repeats every turn, */
    double encoder_phase_rad = 0.0;        /* sin(theta + phase) less its value at angle 0 */
    double encoder_index_rad = 1.0; /* where its index begins, a count long; below 0: it has none */
};

struct Config {
    MotorConfig motor;
    ImperfectionConfig imperfections;
    SupplyConfig supply;
    BridgeConfig bridge;
    SensorConfig sensors;
    StopConfig stops;
    std::uint64_t seed = 1;
    double initial_theta_rad = 0.0;
    double initial_omega_rad_s = 0.0;
    bool track_energy = false; /* keep Energy; costs about a fifth of the speed */
};

/* A converter of the samples. */
enum class Channel {
    current_a,
    current_b,
    phase_voltage_a,
    phase_voltage_b,
    bus_voltage,
    bridge_temperature
};

/* Times high per half period of the four half-bridges: A+, A-, B+, B-; as in hal_outputs. */
struct Duties {
    std::uint16_t high_counts[4] = {0, 0, 0, 0};
    bool bridge_on = false;
    bool brake_on = false; /* at once, with SupplyConfig::brake_by_drive */
};

/* An edge of an encoder's index, and the count there. */
struct IndexEdge {
    bool passed = false; /* since S(k-1) */
    std::int32_t count = 0;
};

/* Raw codes at S(k); the fields and scales are those of hal_samples, and of hal's
   bridge_temperature. */
struct Samples {
    std::uint16_t current_a = 0, current_b = 0, bus_voltage = 0, bridge_temperature = 0;
    std::int16_t phase_voltage_a = 0, phase_voltage_b = 0;
    std::int32_t encoder_count = 0; /* 0 at angle 0, wraps at 2^31 */
    IndexEdge index_rise, index_fall;
};

/* True values at S(k). Voltages: means over S(k-1)...S(k). */
struct State {
    double theta_rad = 0, omega_rad_s = 0;
    double i_a_A = 0, i_b_A = 0;
    double u_a_V = 0, u_b_V = 0;
    double torque_Nm = 0, load_torque_Nm = 0, bus_V = 0;
};

/* What an incremental encoder makes of its rotor's motion. */
enum class EncoderCondition {
    sound,
    frozen,   /* no edge comes: a broken cable, a loose disc */
    reversed, /* its channels are exchanged */
    half,     /* counts half of what passes: one channel of two */
    noisy,    /* now and then a count too many or too few, which stays: interference */
    lossy     /* an edge now and then is not counted: dirt, a weak signal */
};

/* Energy bookkeeping since the start, J: supplied = the sum of the others, to 1e-6 of it. All 0
   without Config::track_energy. */
struct Energy {
    double supplied = 0; /* by the source (before its resistance) */
    double copper = 0;   /* and in the bridge's resistance */
    double magnetic = 0; /* of currents, saturation and detent; what changed since the start */
    double kinetic = 0, friction = 0, load = 0;
    double diode = 0;   /* lost in the bridge's diodes during dead time and with the bridge off */
    double coulomb = 0; /* and in a jam */
    double arc = 0;     /* of a lead that breaks while current flows */
    double source = 0, brake = 0, capacitor = 0; /* the bus: two losses, and what is stored */
    double iron = 0;                /* hysteresis, of which a little is stored, and eddies */
    double spring = 0, damping = 0; /* of the belt, whose mass is in kinetic, too, and of stops */
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

    /*
     * Drift and faults: act from the present S(k) on, those of the sensing in the samples from
     * S(k+1) on. All throw std::invalid_argument naming the field.
     */
    void set_load_torque(double load_torque_Nm, double ramp_s = 0); /* from where it stands */
    void vibrate(double load_torque_Nm, double frequency_Hz); /* amplitude of a sine beside it */
    void set_motor(const MotorConfig &motor);                 /* currents, angle and speed go on */
    void set_coulomb_friction(double share);                  /* as in ImperfectionConfig */
    void set_magnet_rise(double rise_K);                      /* likewise */
    void set_bus(double bus_V);                    /* the source's; a capacitor follows */
    void set_bridge_temperature(double bridge_C);  /* 25 degrees Celsius until then */
    void set_sensors(const SensorConfig &sensors); /* offsets, gains and noise may differ */
    /* Friction beside the motor's own; 0 frees the rotor, held_Nm stops it within this S(k). */
    static constexpr double held_Nm = 1e9;
    void jam(double torque_Nm);
    void set_stops(const StopConfig &stops);     /* from here on; they may be within what turns */
    void open_phase(int phase, bool open);       /* 0 a, 1 b: a lead of the winding is broken */
    void stick(Channel channel);                 /* at the code of the present samples */
    void stick(Channel channel, int code);       /* at this one */
    void release(Channel channel);               /* sticks no more */
    void add_noise(Channel channel, double rms); /* Gaussian, in codes, beside the channel's own */
    /* Its count goes on from where it is. rate: of noisy, miscounts in a second, at most one in a
       period; of lossy, the share of the edges that is lost. */
    void set_encoder(EncoderCondition condition, double rate = 0);

  private:
    struct Parts; /* motor, bridge, sensors */

    template <typename Change> void change_real_motor(const Change &change);
    void look();
    void observe();
    void load_shaft();
    template <typename AnyMotor> void observe(const AnyMotor &motor);

    std::unique_ptr<Parts> parts_;
    State state_;
    Samples samples_;
    Energy energy_;
};

} // namespace plant

#endif
