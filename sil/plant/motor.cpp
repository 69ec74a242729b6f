#include "sil/plant/motor.h"

#include <cmath>

#include "sil/plant/elementary.h"
#include "sil/plant/in_place.h"
#include "sil/plant/integrator.h"
#include "sil/plant/require.h"

namespace plant
{

namespace
{

constexpr double fastest_rate = 1e9; /* 1/s: a runaway motor ends, if not accurately */

}

void require_motor(const MotorConfig &config)
{
    require(config.resistance_ohm >= 0.0 && config.resistance_ohm <= 1e4, "resistance_ohm",
            config.resistance_ohm, "0...1e4 ohm");
    require(config.inductance_H >= 1e-6 && config.inductance_H <= 10.0, "inductance_H",
            config.inductance_H, "1e-6...10 H");
    require(config.torque_constant_Nm_A >= 0.0 && config.torque_constant_Nm_A <= 100.0,
            "torque_constant_Nm_A", config.torque_constant_Nm_A, "0...100 N m/A");
    require(config.viscous_friction_Nms_rad >= 0.0 && config.viscous_friction_Nms_rad <= 100.0,
            "viscous_friction_Nms_rad", config.viscous_friction_Nms_rad, "0...100 N m s/rad");
    require(config.inertia_kgm2 >= 1e-9 && config.inertia_kgm2 <= 1e9, "inertia_kgm2",
            config.inertia_kgm2, "1e-9...1e9 kg m^2");
    require(config.rotor_teeth >= 1 && config.rotor_teeth <= 1000, "rotor_teeth",
            config.rotor_teeth, "1...1000");
}

void require_motion(double theta_rad, double omega_rad_s)
{
    require(magnitude(theta_rad) <= 1e9, "initial_theta_rad", theta_rad, "-1e9...1e9 rad");
    require(magnitude(omega_rad_s) <= 1e4, "initial_omega_rad_s", omega_rad_s, "-1e4...1e4 rad/s");
}

void wrap(double &electrical_turns, double &electrical_rad)
{
    if (magnitude(electrical_rad) > pi) {
        const double turns = nearest_whole(electrical_rad * (0.5 / pi));
        electrical_rad -= turns * (2.0 * pi);
        electrical_turns += turns;
    }
}

Motor::Motor(const MotorConfig &config, double theta_rad, double omega_rad_s, bool track_energy)
    : track_energy_(track_energy)
{
    require_motion(theta_rad, omega_rad_s);
    set_parameters(config);
    state_.omega_rad_s = omega_rad_s;
    state_.electrical_rad = coefficients_.teeth * theta_rad;
    begin_period();
}

void Motor::set_parameters(const MotorConfig &config)
{
    require_motor(config);
    coefficients_.resistance = config.resistance_ohm;
    coefficients_.torque_constant = config.torque_constant_Nm_A;
    coefficients_.friction = config.viscous_friction_Nms_rad;
    coefficients_.inverse_inductance = 1.0 / config.inductance_H;
    coefficients_.inverse_inertia = 1.0 / config.inertia_kgm2;
    coefficients_.teeth = config.rotor_teeth;
    for (int k = 0; k < MotorCoefficients::highest_order; k++) {
        const double share = 1.0 / (k + 1);
        const double per_L = share * coefficients_.inverse_inductance;
        const double per_J = share * coefficients_.inverse_inertia;
        const Phases both = {1.0, 1.0};
        coefficients_.share[k].resistance = both * (-per_L * config.resistance_ohm);
        coefficients_.share[k].emf = both * (-per_L * config.torque_constant_Nm_A);
        coefficients_.share[k].quarter_turn = Phases{-1.0, 1.0} * (share * config.rotor_teeth);
        coefficients_.share[k].torque = both * (per_J * config.torque_constant_Nm_A);
        coefficients_.share[k].friction = both * (-per_J * config.viscous_friction_Nms_rad);
    }
    set_load_torque(coefficients_.load_torque);
}

void Motor::set_load_torque(double load_torque_Nm)
{
    coefficients_.load_torque = load_torque_Nm;
    coefficients_.deceleration = in_both_lanes(coefficients_.inverse_inertia * load_torque_Nm);
}

void Motor::begin_period()
{
    const MotorCoefficients &motor = coefficients_;
    wrap(state_.electrical_turns, state_.electrical_rad);
    state_.q_axis = quarter_turn(unit_vector(state_.electrical_rad));
    integrals_.voltage_Vs = Phases{0.0, 0.0};

    /* Rotation, L/R, and the exchange of current and magnet energy with the kinetic energy. */
    const double current = magnitude(state_.current_A[0]) + magnitude(state_.current_A[1]);
    const double stiffness =
        motor.torque_constant *
        (motor.torque_constant * motor.inverse_inductance + motor.teeth * current);
    const double rate = motor.teeth * magnitude(state_.omega_rad_s) +
                        motor.resistance * motor.inverse_inductance +
                        std::sqrt(stiffness * motor.inverse_inertia);
    rate_ = rate < fastest_rate ? rate : fastest_rate; /* also if not a number */
}

FOR_EACH_PROCESSOR void Motor::advance(const Timetable &timetable)
{
    const integrator::Course course = {coefficients_, state_, integrals_};
    if (track_energy_) {
        integrator::follow<true>(course, timetable, rate_);
    } else {
        integrator::follow<false>(course, timetable, rate_);
    }
}

double Motor::theta_rad() const
{
    return (state_.electrical_turns * (2.0 * pi) + state_.electrical_rad) / coefficients_.teeth;
}

double Motor::torque_Nm() const
{
    return coefficients_.torque_constant * dot(state_.current_A, state_.q_axis);
}

double Motor::magnetic_J() const
{
    return 0.5 * dot(state_.current_A, state_.current_A) / coefficients_.inverse_inductance;
}

double Motor::kinetic_J() const
{
    return 0.5 * state_.omega_rad_s * state_.omega_rad_s / coefficients_.inverse_inertia;
}

} // namespace plant
