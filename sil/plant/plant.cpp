#include "sil/plant/plant.h"

#include "sil/plant/bridge.h"
#include "sil/plant/motor.h"
#include "sil/plant/require.h"
#include "sil/plant/sensors.h"

namespace plant
{

struct Plant::Parts {
    explicit Parts(const Config &config)
        : bridge(config.bridge), sensors(config.sensors, config.seed),
          motor(config.motor, config.initial_theta_rad, config.initial_omega_rad_s,
                config.track_energy),
          period_s(config.bridge.period_s), bus_V(config.bridge.bus_V),
          delayed(config.bridge.delay_periods == 1), track_energy(config.track_energy),
          magnetic_reference_J(motor.magnetic_J()), kinetic_reference_J(motor.kinetic_J())
    {
    }

    Bridge bridge;
    Sensors sensors;
    Motor motor;
    const double period_s;
    const double bus_V;
    const bool delayed;
    const bool track_energy;
    double magnetic_reference_J; /* where the stored energies count from */
    double kinetic_reference_J;
    Duties pending;           /* computed from S(k-1), in force from S(k) on */
    std::uint64_t period = 0; /* k of the present S(k) */
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

    plant.motor.begin_period();
    plant.motor.advance(plant.bridge.period(in_force));
    plant.period++;
    observe();
}

/* True values, codes and energies of the present S(k). */
void Plant::observe()
{
    const Parts &plant = *parts_;
    const Motor &motor = plant.motor;
    const MotorIntegrals &integrals = motor.integrals();
    const Phases mean_V = integrals.voltage_Vs * (1.0 / plant.period_s);
    const Phases current_A = motor.state().current_A;
    state_.theta_rad = motor.theta_rad();
    state_.omega_rad_s = motor.state().omega_rad_s;
    state_.i_a_A = current_A[0];
    state_.i_b_A = current_A[1];
    state_.u_a_V = mean_V[0];
    state_.u_b_V = mean_V[1];
    state_.torque_Nm = motor.torque_Nm();
    state_.bus_V = plant.bus_V;
    samples_ = plant.sensors.sample(plant.period, current_A, mean_V, plant.bus_V);
    if (plant.track_energy) {
        energy_.supplied = integrals.supplied_J;
        energy_.copper = integrals.copper_J;
        energy_.magnetic = motor.magnetic_J() - plant.magnetic_reference_J;
        energy_.kinetic = motor.kinetic_J() - plant.kinetic_reference_J;
        energy_.friction = integrals.friction_J;
        energy_.load = integrals.load_J;
        energy_.diode = integrals.diode_J;
    }
}

void Plant::set_load_torque(double load_torque_Nm)
{
    require(magnitude(load_torque_Nm) <= 1e3, "load_torque_Nm", load_torque_Nm, "-1000...1000 N m");
    parts_->motor.set_load_torque(load_torque_Nm);
    state_.load_torque_Nm = load_torque_Nm;
}

/* Energy that a change of L or J adds to what is stored came from nowhere: it is not counted. */
void Plant::set_motor(const MotorConfig &motor)
{
    Parts &plant = *parts_;
    plant.magnetic_reference_J -= plant.motor.magnetic_J();
    plant.kinetic_reference_J -= plant.motor.kinetic_J();
    plant.motor.set_parameters(motor);
    plant.magnetic_reference_J += plant.motor.magnetic_J();
    plant.kinetic_reference_J += plant.motor.kinetic_J();
    state_.theta_rad = plant.motor.theta_rad();
    state_.torque_Nm = plant.motor.torque_Nm();
}

} // namespace plant
