#include "sil/plant/motor.h"

#include <cmath>

#include "sil/plant/elementary.h"
#include "sil/plant/require.h"
#include "sil/plant/taylor.h"

namespace plant
{

namespace
{

/*
 * A series of order P over a step h leaves out about (rate h)^(P+1) / (P+1)! of what happens in
 * the step. Dead times are so short that the low order does; elsewhere the high order, in steps of
 * at most longest_step / rate.
 */
constexpr int low_order = 3;
constexpr int high_order = MotorCoefficients::highest_order;
constexpr double low_order_step = 1.0 / 100.0;
constexpr double longest_step = 0.2;
constexpr double fastest_rate = 1e9; /* 1/s: a runaway motor ends, if not accurately */
constexpr double least_progress = 1e-9; /* of a step to an event, however rounding falls */

/* The unknowns as power series in the time since the start of the step. */
template <int order> struct Series {
    Phases current[order + 1];
    Phases q_axis[order + 1];
    double omega[order + 1];
    Phases omega_q[order]; /* back-EMF / Km */
};

/* What the bridge offers the phases. */
struct Terminals {
    Phases voltage_V;  /* 0 where the phase floats */
    Phases conducting; /* 1, or 0 where the phase floats */
    Phases direction;  /* of the current where only diodes let it flow: 1 or -1; else 0 */
    bool floating;     /* some phase floats */
};

/* Coefficients k + 1 and later from those before; the equations are in motor.h. */
template <bool floating, int k, int order>
[[gnu::always_inline]] inline void expand(Series<order> &x, const MotorCoefficients &motor,
                                          const Terminals &terminals)
{
    const MotorCoefficients::Share &share = motor.share[k];
    Phases current = share.resistance * x.current[k];
    double omega = share.friction * x.omega[k];
    if constexpr (k == 0) {
        current += motor.inverse_inductance * terminals.voltage_V;
        omega -= motor.inverse_inertia * motor.load_torque;
    }
    const Phases omega_q = cauchy_product<k>(x.omega, x.q_axis);
    const Phases i_q = cauchy_product<k>(x.current, x.q_axis);
    current += share.emf * omega_q;
    if constexpr (floating) {
        current *= terminals.conducting;
    }
    x.omega_q[k] = omega_q;
    x.current[k + 1] = current;
    x.omega[k + 1] = omega + share.torque * (i_q[0] + i_q[1]);
    x.q_axis[k + 1] = share.teeth * quarter_turn(omega_q);
    if constexpr (k + 1 < order) {
        expand<floating, k + 1>(x, motor, terminals);
    }
}

template <bool floating, int order>
[[gnu::always_inline]] inline void expand(Series<order> &x, const MotorState &start,
                                          const MotorCoefficients &motor,
                                          const Terminals &terminals)
{
    x.current[0] = start.current_A;
    x.q_axis[0] = start.q_axis;
    x.omega[0] = start.omega_rad_s;
    expand<floating, 0>(x, motor, terminals);
}

/*
 * With a leg in dead time a phase conducts against its current; without current it floats, unless
 * the back-EMF overcomes what the diodes hold against it.
 */
struct Terminal {
    double voltage_V, conducting, direction;
};

inline Terminal terminal(double positive_V, double negative_V, double current_A, double emf_V)
{
    if (positive_V == negative_V) {
        return {positive_V, 1.0, 0.0};
    }
    if (current_A > 0.0 || (current_A == 0.0 && emf_V < positive_V)) {
        return {positive_V, 1.0, 1.0};
    }
    if (current_A < 0.0 || emf_V > negative_V) {
        return {negative_V, 1.0, -1.0};
    }
    return {0.0, 0.0, 0.0};
}

inline Terminals terminals_of(const Segment &segment, const MotorCoefficients &motor,
                              const MotorState &state)
{
    const Phases emf_V = (motor.torque_constant * state.omega_rad_s) * state.q_axis;
    const Terminal a = terminal(segment.if_positive_V[0], segment.if_negative_V[0],
                                state.current_A[0], emf_V[0]);
    const Terminal b = terminal(segment.if_positive_V[1], segment.if_negative_V[1],
                                state.current_A[1], emf_V[1]);
    return {Phases{a.voltage_V, b.voltage_V}, Phases{a.conducting, b.conducting},
            Phases{a.direction, b.direction}, a.conducting * b.conducting == 0.0};
}

template <int order>
void add_energies(MotorIntegrals &integrals, const Series<order> &x,
                  const MotorCoefficients &motor, const Segment &segment,
                  const Terminals &terminals, double h)
{
    const Phases charge = integral<order>(x.current, h);
    const Phases current_squared = integral_of_square<order>(x.current, h);
    const double diode_J = segment.diode_V[0] * magnitude(charge[0]) +
                           segment.diode_V[1] * magnitude(charge[1]);
    integrals.diode_J += diode_J;
    integrals.supplied_J += dot(terminals.voltage_V, charge) + diode_J;
    integrals.copper_J += motor.resistance * (current_squared[0] + current_squared[1]);
    integrals.friction_J += motor.friction * integral_of_square<order>(x.omega, h);
    integrals.load_J += motor.load_torque * integral<order>(x.omega, h);
}

/* The state at the end of the step. */
template <int order, bool track_energy>
[[gnu::always_inline]] inline void accept(MotorState &state, MotorIntegrals &integrals,
                                          const Series<order> &x, const MotorCoefficients &motor,
                                          const Segment &segment, const Terminals &terminals,
                                          double h)
{
    integrals.voltage_Vs += h * terminals.voltage_V;
    if constexpr (track_energy) {
        add_energies(integrals, x, motor, segment, terminals, h);
    }
    state.current_A = value<order>(x.current, h);
    state.q_axis = value<order>(x.q_axis, h);
    state.omega_rad_s = value<order>(x.omega, h);
    state.electrical_rad += motor.teeth * integral<order>(x.omega, h);
}

/* What the diodes demand of a phase, as a series: its current must not turn, and while it floats
   its back-EMF must stay within the blocking voltages. >= 0 as long as they have it. */
template <int order> struct Margin {
    double coefficient[order + 1];
};

template <int order>
inline Margin<order> margin_of(int phase, const Series<order> &x, const MotorCoefficients &motor,
                               const Segment &segment, const Terminals &terminals, double h)
{
    Margin<order> margin = {};
    if (terminals.conducting[phase] == 0.0) {
        const bool negative = value<order - 1>(x.omega_q, h)[phase] < 0.0;
        const double sign = negative ? motor.torque_constant : -motor.torque_constant;
        for (int k = 0; k < order; k++) {
            margin.coefficient[k] = sign * x.omega_q[k][phase];
        }
        margin.coefficient[0] +=
            negative ? -segment.if_positive_V[phase] : segment.if_negative_V[phase];
    } else {
        for (int k = 0; k <= order; k++) {
            margin.coefficient[k] = terminals.direction[phase] * x.current[k][phase];
        }
    }
    return margin;
}

/* When a diode stops or starts to conduct. */
struct Event {
    double time_s;     /* after the start of the step, at most its length */
    int blocking = -1; /* the phase whose current ends */
};

template <int order>
Event first_event(const Series<order> &x, const MotorCoefficients &motor, const Segment &segment,
                  const Terminals &terminals, double h)
{
    Event first = {h};
    for (int phase = 0; phase < 2; phase++) {
        const Margin<order> margin = margin_of(phase, x, motor, segment, terminals, h);
        if (value<order>(margin.coefficient, h) < 0.0) {
            const double zero_s = falling_zero(margin.coefficient, order, h);
            const double time_s = zero_s > least_progress * h ? zero_s : least_progress * h;
            if (time_s < first.time_s) {
                first = {time_s, terminals.conducting[phase] == 0.0 ? -1 : phase};
            }
        }
    }
    return first;
}

/* A step in which a phase floats or a current ends: goes as far as the first event. */
template <int order, bool track_energy>
[[gnu::noinline]] double step_to_event(MotorState &state, MotorIntegrals &integrals,
                                       const MotorCoefficients &motor, const Segment &segment,
                                       const Terminals &terminals, double h)
{
    Series<order> x;
    expand<true>(x, state, motor, terminals);
    const Event event = first_event(x, motor, segment, terminals, h);
    const Phases emf_Vs = motor.torque_constant * integral<order - 1>(x.omega_q, event.time_s);
    integrals.voltage_Vs += (1.0 - terminals.conducting) * emf_Vs;
    accept<order, track_energy>(state, integrals, x, motor, segment, terminals, event.time_s);
    if (event.blocking >= 0) {
        state.current_A[event.blocking] = 0.0;
    }
    return event.time_s;
}

/* Advances by h or to the first event before; returns the time that passed. */
template <int order, bool track_energy>
[[gnu::always_inline]] inline double step(MotorState &state, MotorIntegrals &integrals,
                                          const MotorCoefficients &motor, const Segment &segment,
                                          double h)
{
    Terminals terminals = {segment.if_positive_V, {}, {}, false};
    if (segment.dead_time) {
        terminals = terminals_of(segment, motor, state);
        if (terminals.floating) {
            return step_to_event<order, track_energy>(state, integrals, motor, segment, terminals,
                                                      h);
        }
    }
    Series<order> x;
    expand<false>(x, state, motor, terminals);
    if (segment.dead_time) {
        const Phases along = terminals.direction * value<order>(x.current, h);
        if (along[0] < 0.0 || along[1] < 0.0) {
            return step_to_event<order, track_energy>(state, integrals, motor, segment, terminals,
                                                      h);
        }
    }
    accept<order, track_energy>(state, integrals, x, motor, segment, terminals, h);
    return h;
}

template <bool track_energy>
void advance_through(MotorState &state, MotorIntegrals &integrals, const MotorCoefficients &motor,
                     const Timetable &timetable, double rate)
{
    for (const Segment &segment : timetable) {
        double left_s = segment.duration_s;
        if (rate * left_s < low_order_step) {
            while (left_s > 0.0) {
                left_s -=
                    step<low_order, track_energy>(state, integrals, motor, segment, left_s);
            }
        } else {
            const double longest_s = longest_step / rate;
            while (left_s > 0.0) {
                const double h = left_s < longest_s ? left_s : longest_s;
                left_s -= step<high_order, track_energy>(state, integrals, motor, segment, h);
            }
        }
    }
}

} // namespace

Motor::Motor(const MotorConfig &config, double theta_rad, double omega_rad_s, bool track_energy)
    : track_energy_(track_energy)
{
    require(magnitude(theta_rad) <= 1e9, "initial_theta_rad", theta_rad, "-1e9...1e9 rad");
    require(magnitude(omega_rad_s) <= 1e4, "initial_omega_rad_s", omega_rad_s, "-1e4...1e4 rad/s");
    set_parameters(config);
    state_.omega_rad_s = omega_rad_s;
    state_.electrical_rad = coefficients_.teeth * theta_rad;
    begin_period();
}

void Motor::set_parameters(const MotorConfig &config)
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
        coefficients_.share[k].teeth = both * (share * config.rotor_teeth);
        coefficients_.share[k].torque = per_J * config.torque_constant_Nm_A;
        coefficients_.share[k].friction = -per_J * config.viscous_friction_Nms_rad;
    }
}

void Motor::set_load_torque(double load_torque_Nm)
{
    coefficients_.load_torque = load_torque_Nm;
}

void Motor::begin_period()
{
    const MotorCoefficients &motor = coefficients_;
    if (magnitude(state_.electrical_rad) > pi) {
        const double turns = nearest_whole(state_.electrical_rad * (0.5 / pi));
        state_.electrical_rad -= turns * (2.0 * pi);
        state_.electrical_turns += turns;
    }
    state_.q_axis = quarter_turn(unit_vector(state_.electrical_rad));
    integrals_.voltage_Vs = Phases{0.0, 0.0};

    /* Rotation, L/R, and the exchange of current and magnet energy with the kinetic energy. */
    const double current = magnitude(state_.current_A[0]) + magnitude(state_.current_A[1]);
    const double stiffness = motor.torque_constant * (motor.torque_constant *
                             motor.inverse_inductance + motor.teeth * current);
    const double rate = motor.teeth * magnitude(state_.omega_rad_s) +
                        motor.resistance * motor.inverse_inductance +
                        std::sqrt(stiffness * motor.inverse_inertia);
    rate_ = rate < fastest_rate ? rate : fastest_rate; /* also if not a number */
}

void Motor::advance(const Timetable &timetable)
{
    if (track_energy_) {
        advance_through<true>(state_, integrals_, coefficients_, timetable, rate_);
    } else {
        advance_through<false>(state_, integrals_, coefficients_, timetable, rate_);
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
