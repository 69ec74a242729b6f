#include "sil/plant/plant.h"

#include <variant>

#include "sil/plant/bridge.h"
#include "sil/plant/motor.h"
#include "sil/plant/real_motor.h"
#include "sil/plant/require.h"
#include "sil/plant/sensors.h"
#include "sil/plant/shaft_load.h"
#include "sil/plant/stops.h"

namespace plant
{

namespace
{

bool any(const ImperfectionConfig &x)
{
    return x.saturation_depth != 0.0 || x.flux_harmonic_3 != 0.0 || x.detent_4 != 0.0 ||
           x.detent_2 != 0.0 || x.detent_1 != 0.0 || x.coulomb_friction != 0.0 ||
           x.bridge_resistance_ohm != 0.0 || x.phase_voltage_filter_s != 0.0 ||
           x.iron.hysteresis != 0.0 || x.iron.eddy_time_s != 0.0 || x.belt.inertia_share != 0.0 ||
           x.resistance_a_scale != 1.0 || x.resistance_b_scale != 1.0 ||
           x.inductance_a_scale != 1.0 || x.inductance_b_scale != 1.0 || x.magnet_rise_K != 0.0;
}

bool is_real(const Config &config)
{
    return any(config.imperfections) || config.supply.bus_source_ohm != 0.0 ||
           stops_of(config.stops).present();
}

std::variant<Motor, RealMotor> motor_of(const Config &config)
{
    if (is_real(config)) {
        return RealMotor(config);
    }
    return Motor(config.motor, config.initial_theta_rad, config.initial_omega_rad_s,
                 config.track_energy);
}

/* A real motor multiplies by the bus voltage and the diodes' drop itself. */
constexpr double unit_V = 1.0;

BridgeConfig bridge_of(const Config &config)
{
    require_bridge(config.bridge);
    BridgeConfig bridge = config.bridge;
    if (is_real(config)) {
        bridge.bus_V = unit_V;
        bridge.diode_drop_V = unit_V;
    }
    return bridge;
}

double bus_of(const Motor &, double source_V)
{
    return source_V;
}

double bus_of(const RealMotor &motor, double)
{
    return motor.bus_V();
}

/* A plain motor's bus is stiff. */
void connect_brake(Motor &, bool)
{
}

void connect_brake(RealMotor &motor, bool on)
{
    motor.connect_brake(on);
}

double capacitor_of(const Motor &)
{
    return 0.0;
}

double capacitor_of(const RealMotor &motor)
{
    return motor.capacitor_J();
}

double spring_of(const Motor &)
{
    return 0.0;
}

double spring_of(const RealMotor &motor)
{
    return motor.spring_J() + motor.stop_J();
}

double stop_loss_of(const Motor &)
{
    return 0.0;
}

double stop_loss_of(const RealMotor &motor)
{
    return motor.stop_loss_J();
}

/* Of a phase's legs: means of their commanded shares of the bus, and whether they differ. */
struct Legs {
    Phases sum_share;
    bool asked; /* for a voltage */
};

Legs legs_of(const Duties &duties, int half_period_counts)
{
    const std::uint16_t *high = duties.high_counts;
    const double per_count = 1.0 / half_period_counts;
    return {Phases{per_count * (high[0] + high[1]), per_count * (high[2] + high[3])},
            high[0] != high[1] || high[2] != high[3]};
}

} // namespace

struct Plant::Parts {
    explicit Parts(const Config &configured)
        : config(configured), bridge(bridge_of(config)), sensors(config.sensors, config.seed),
          motor(motor_of(config)), period_s(config.bridge.period_s), shaft_load(period_s),
          delayed(config.bridge.delay_periods == 1), track_energy(config.track_energy)
    {
        std::visit([this](const auto &machine) { take_reference(machine); }, motor);
    }

    /* The stored energies count from here. */
    template <typename AnyMotor> void take_reference(const AnyMotor &machine)
    {
        magnetic_reference_J = machine.magnetic_J();
        kinetic_reference_J = machine.kinetic_J();
        capacitor_reference_J = capacitor_of(machine);
        spring_reference_J = spring_of(machine);
    }

    /* What a change adds to the stored energies came from nowhere: it is not counted. */
    template <typename AnyMotor, typename Change>
    void without_energy(const AnyMotor &machine, const Change &change)
    {
        if (!track_energy) {
            change();
            return;
        }
        magnetic_reference_J -= machine.magnetic_J();
        kinetic_reference_J -= machine.kinetic_J();
        change();
        magnetic_reference_J += machine.magnetic_J();
        kinetic_reference_J += machine.kinetic_J();
    }

    Config config; /* motor and bus as they are by now */
    Bridge bridge;
    Sensors sensors;
    std::variant<Motor, RealMotor> motor;
    const double period_s;
    ShaftLoad shaft_load;
    const bool delayed;
    const bool track_energy;
    double magnetic_reference_J = 0.0;
    double kinetic_reference_J = 0.0;
    double capacitor_reference_J = 0.0;
    double spring_reference_J = 0.0;
    Phases measured_V = {0.0, 0.0}; /* phase voltages as they reach the converters */
    bool bridge_on = false;         /* in the period that ends at the present S(k) */
    bool asked = false;             /* for a voltage, since the bridge came on */
    Phases legs_share = {0.0, 0.0}; /* of the bus: sum of the legs of each phase in that period */
    Duties pending;                 /* computed from S(k-1), in force from S(k) on */
    std::uint64_t period = 0;       /* k of the present S(k) */
};

Plant::Plant(const Config &config) : parts_(std::make_unique<Parts>(config))
{
    observe();
}

Plant::~Plant() = default;

void Plant::step(const Duties &duties)
{
    Parts &plant = *parts_;
    Duties in_force = plant.delayed ? plant.pending : duties;
    in_force.bridge_on = in_force.bridge_on && duties.bridge_on; /* off acts at once */
    plant.pending = duties;
    plant.bridge_on = in_force.bridge_on;
    const Legs legs = legs_of(in_force, plant.config.bridge.half_period_counts);
    plant.legs_share = legs.sum_share;
    plant.asked = in_force.bridge_on && (plant.asked || legs.asked);

    const Timetable &timetable = plant.bridge.period(in_force);
    std::visit(
        [&timetable, &duties](auto &motor) {
            motor.begin_period();
            connect_brake(motor, duties.brake_on);
            motor.advance(timetable);
        },
        plant.motor);
    plant.period++;
    if (plant.shaft_load.moves(plant.period)) {
        load_shaft();
    }
    observe();
}

/* True values, codes and energies of the present S(k). */
void Plant::observe()
{
    Parts &plant = *parts_;
    std::visit([this](const auto &motor) { observe(motor); }, plant.motor);
    samples_ =
        plant.sensors.sample(plant.period, {Phases{state_.i_a_A, state_.i_b_A}, plant.measured_V,
                                            state_.bus_V, state_.theta_rad, plant.bridge_on,
                                            plant.asked, plant.legs_share * state_.bus_V});
}

/* What a change from outside can do to the true values; voltages are means of the period before. */
void Plant::look()
{
    std::visit(
        [this](const auto &motor) {
            const Phases current_A = motor.current_A();
            state_.theta_rad = motor.theta_rad();
            state_.omega_rad_s = motor.omega_rad_s();
            state_.i_a_A = current_A[0];
            state_.i_b_A = current_A[1];
            state_.torque_Nm = motor.torque_Nm();
            state_.bus_V = bus_of(motor, parts_->config.bridge.bus_V);
        },
        parts_->motor);
}

template <typename AnyMotor> void Plant::observe(const AnyMotor &motor)
{
    Parts &plant = *parts_;
    const MotorIntegrals &integrals = motor.integrals();
    const Phases mean_V = integrals.voltage_Vs * (1.0 / plant.period_s);
    plant.measured_V = motor.filtered_Vs() * (1.0 / plant.period_s);
    look();
    state_.u_a_V = mean_V[0];
    state_.u_b_V = mean_V[1];
    if (plant.track_energy) {
        energy_.supplied = integrals.supplied_J;
        energy_.copper = integrals.copper_J;
        energy_.magnetic = motor.magnetic_J() - plant.magnetic_reference_J;
        energy_.kinetic = motor.kinetic_J() - plant.kinetic_reference_J;
        energy_.friction = integrals.friction_J;
        energy_.load = integrals.load_J;
        energy_.diode = integrals.diode_J;
        energy_.coulomb = integrals.coulomb_J;
        energy_.arc = integrals.arc_J;
        energy_.source = integrals.source_J;
        energy_.brake = integrals.brake_J;
        energy_.capacitor = capacitor_of(motor) - plant.capacitor_reference_J;
        energy_.iron = integrals.iron_J;
        energy_.damping = integrals.damping_J + stop_loss_of(motor);
        energy_.spring = spring_of(motor) - plant.spring_reference_J;
    }
}

/* From the present S(k) on. */
void Plant::load_shaft()
{
    const double torque_Nm = parts_->shaft_load.torque_Nm(parts_->period);
    std::visit([torque_Nm](auto &motor) { motor.set_load_torque(torque_Nm); }, parts_->motor);
    state_.load_torque_Nm = torque_Nm;
}

void Plant::set_load_torque(double load_torque_Nm, double ramp_s)
{
    require(magnitude(load_torque_Nm) <= 1e3, "load_torque_Nm", load_torque_Nm, "-1000...1000 N m");
    require(ramp_s >= 0 && ramp_s <= 1e6, "ramp_s", ramp_s, "0...1e6 s");
    parts_->shaft_load.go_to(load_torque_Nm, ramp_s, parts_->period);
    load_shaft();
}

void Plant::vibrate(double load_torque_Nm, double frequency_Hz)
{
    require(load_torque_Nm >= 0 && load_torque_Nm <= 1e3, "vibration", load_torque_Nm,
            "0...1000 N m");
    require(frequency_Hz >= 0 && frequency_Hz <= 1e6, "frequency_Hz", frequency_Hz, "0...1e6 Hz");
    parts_->shaft_load.vibrate(load_torque_Nm, frequency_Hz, parts_->period);
    load_shaft();
}

void Plant::set_motor(const MotorConfig &config)
{
    Parts &plant = *parts_;
    std::visit(
        [&](auto &motor) { plant.without_energy(motor, [&] { motor.set_parameters(config); }); },
        plant.motor);
    plant.config.motor = config;
    look();
}

/* What the plain motor does not know makes it a real one, from here on. */
template <typename Change> void Plant::change_real_motor(const Change &change)
{
    Parts &plant = *parts_;
    if (const Motor *plain = std::get_if<Motor>(&plant.motor)) {
        plant.motor = RealMotor(plant.config, *plain, state_.load_torque_Nm);
        plant.bridge.set_levels(unit_V, unit_V);
    }
    change(std::get<RealMotor>(plant.motor));
    look();
}

void Plant::set_coulomb_friction(double share)
{
    change_real_motor([share](RealMotor &motor) { motor.set_coulomb_friction(share); });
}

void Plant::set_magnet_rise(double rise_K)
{
    Parts &plant = *parts_;
    change_real_motor([&](RealMotor &motor) {
        plant.without_energy(motor, [&] { motor.set_magnet_rise(rise_K); });
    });
    plant.config.imperfections.magnet_rise_K = rise_K;
}

/* A stiff bus takes or gives no energy of its own; that of a capacitor changes by currents only. */
void Plant::set_bus(double bus_V)
{
    Parts &plant = *parts_;
    BridgeConfig bridge = plant.config.bridge;
    bridge.bus_V = bus_V;
    require_bridge(bridge);
    if (RealMotor *real = std::get_if<RealMotor>(&plant.motor)) {
        real->set_bus(plant.config.supply, bus_V);
    } else {
        plant.bridge.set_levels(bus_V, bridge.diode_drop_V);
    }
    plant.config.bridge = bridge;
    look();
}

void Plant::set_sensors(const SensorConfig &sensors)
{
    parts_->sensors.set(sensors);
}

void Plant::set_bridge_temperature(double bridge_C)
{
    parts_->sensors.set_bridge_temperature(bridge_C);
}

void Plant::jam(double torque_Nm)
{
    change_real_motor([torque_Nm](RealMotor &motor) { motor.jam(torque_Nm); });
}

/* As with a motor's parameters. */
void Plant::set_stops(const StopConfig &stops)
{
    Parts &plant = *parts_;
    stops_of(stops);
    change_real_motor([&](RealMotor &motor) {
        plant.spring_reference_J -= spring_of(motor);
        motor.set_stops(stops);
        plant.spring_reference_J += spring_of(motor);
    });
    plant.config.stops = stops;
}

void Plant::open_phase(int phase, bool open)
{
    require(phase == 0 || phase == 1, "phase", phase, "0 or 1");
    change_real_motor([phase, open](RealMotor &motor) { motor.open_phase(phase, open); });
}

void Plant::stick(Channel channel)
{
    stick(channel, code_of(samples_, channel));
}

void Plant::stick(Channel channel, int code)
{
    parts_->sensors.stick(channel, code);
}

void Plant::release(Channel channel)
{
    parts_->sensors.release(channel);
}

void Plant::add_noise(Channel channel, double rms)
{
    parts_->sensors.add_noise(channel, rms);
}

void Plant::set_encoder(EncoderCondition condition, double rate)
{
    const bool noisy = condition == EncoderCondition::noisy;
    require(rate >= 0.0 && rate * (noisy ? parts_->period_s : 1.0) <= 1.0,
            noisy ? "miscounts_per_s" : "lost_share", rate,
            noisy ? "at most one in a period" : "0...1");
    parts_->sensors.set_encoder(condition, state_.theta_rad,
                                noisy ? rate * parts_->period_s : rate);
}

} // namespace plant
