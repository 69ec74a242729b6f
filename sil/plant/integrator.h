/*
 * The Taylor-series integrator of the motor's equations (motor.h), step by step through a
 * timetable. Internal to motor.cpp.
 */
#ifndef STEADYSTEP_PLANT_INTEGRATOR_H
#define STEADYSTEP_PLANT_INTEGRATOR_H

#include "sil/plant/in_place.h"
#include "sil/plant/motor.h"
#include "sil/plant/taylor.h"

namespace plant
{

namespace integrator
{

/*
 * A series of order P over a step h leaves out about (rate h)^(P+1) / (P+1)! of what happens in
 * the step: the lowest order that a segment's length allows, the highest in as many steps as it
 * takes. These are the greatest rate x step of each; they leave out at most 1.4e-9. The second
 * order serves dead times alone, so that it adds up over a small part of the time.
 */
constexpr double reach_2 = 0.0012, reach_3 = 0.01, reach_4 = 0.04, reach_5 = 0.1;
constexpr double least_progress = 1e-9; /* of a step to an event, however rounding falls */

/* The unknowns as power series in the time since the start of the step. The speed stands in both
   lanes, so that it multiplies vectors as it is. */
template <int order> struct Series {
    Phases current[order + 1];
    Phases q_axis[order + 1];
    Phases omega[order + 1];
    Phases omega_q[order]; /* back-EMF / Km */
};

/* What the bridge offers the phases. */
struct Terminals {
    Phases voltage_V;  /* 0 where the phase floats */
    Phases conducting; /* 1, or 0 where the phase floats */
    Phases direction;  /* of the current where only diodes let it flow: 1 or -1; else 0 */
};

/* Coefficients k + 1 and later from those before; the equations are in motor.h. */
template <bool floating, int k, int order>
IN_PLACE void expand(Series<order> &x, const MotorCoefficients &motor, Phases voltage_V,
                     Phases conducting)
{
    const MotorCoefficients::Share &share = motor.share[k];
    Phases current = share.resistance * x.current[k];
    Phases omega = share.friction * x.omega[k];
    if constexpr (k == 0) {
        current += motor.inverse_inductance * voltage_V;
        omega -= motor.deceleration;
    }
    const Phases omega_q = cauchy_product<k>(x.omega, x.q_axis);
    const Phases i_q = cauchy_product<k>(x.current, x.q_axis);
    current += share.emf * omega_q;
    if constexpr (floating) {
        current *= conducting;
    }
    x.omega_q[k] = omega_q;
    x.current[k + 1] = current;
    x.omega[k + 1] = omega + share.torque * sum_in_both_lanes(i_q);
    x.q_axis[k + 1] = share.quarter_turn * exchanged(omega_q);
    if constexpr (k + 1 < order) {
        expand<floating, k + 1>(x, motor, voltage_V, conducting);
    }
}

template <bool floating, int order>
IN_PLACE void expand(Series<order> &x, const MotorState &start, const MotorCoefficients &motor,
                     Phases voltage_V, Phases conducting)
{
    x.current[0] = start.current_A;
    x.q_axis[0] = start.q_axis;
    x.omega[0] = in_both_lanes(start.omega_rad_s);
    expand<floating, 0>(x, motor, voltage_V, conducting);
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

inline Terminals terminals_of(const BridgeOutput &output, const MotorCoefficients &motor,
                              const MotorState &state)
{
    const Phases emf_V = (motor.torque_constant * state.omega_rad_s) * state.q_axis;
    const Terminal a =
        terminal(output.if_positive_V[0], output.if_negative_V[0], state.current_A[0], emf_V[0]);
    const Terminal b =
        terminal(output.if_positive_V[1], output.if_negative_V[1], state.current_A[1], emf_V[1]);
    return {Phases{a.voltage_V, b.voltage_V}, Phases{a.conducting, b.conducting},
            Phases{a.direction, b.direction}};
}

constexpr Phases none = {0.0, 0.0}, both_conduct = {1.0, 1.0};

/* One motor on its way: what it is, where it is, and what has flowed. */
struct Course {
    const MotorCoefficients &motor;
    MotorState &state;
    MotorIntegrals &integrals;
};

template <int order>
void add_energies(const Course &course, const Series<order> &x, const BridgeOutput &output,
                  Phases voltage_V, double h)
{
    const MotorCoefficients &motor = course.motor;
    MotorIntegrals &integrals = course.integrals;
    const Phases charge = integral<order>(x.current, in_both_lanes(h));
    const Phases current_squared = integral_of_square<order>(x.current, h);
    const double diode_J =
        output.diode_V[0] * magnitude(charge[0]) + output.diode_V[1] * magnitude(charge[1]);
    integrals.diode_J += diode_J;
    integrals.supplied_J += dot(voltage_V, charge) + diode_J;
    integrals.copper_J += motor.resistance * (current_squared[0] + current_squared[1]);
    integrals.friction_J += motor.friction * integral_of_square<order>(x.omega, h)[0];
    integrals.load_J += motor.load_torque * integral<order>(x.omega, in_both_lanes(h))[0];
}

/* The state at the end of the step. */
template <bool track_energy, int order>
IN_PLACE void accept(const Course &course, const Series<order> &x, const BridgeOutput &output,
                     Phases voltage_V, double h)
{
    const Phases step = in_both_lanes(h);
    course.integrals.voltage_Vs += step * voltage_V;
    if constexpr (track_energy) {
        add_energies(course, x, output, voltage_V, h);
    }
    course.state.current_A = value<order>(x.current, step);
    course.state.q_axis = value<order>(x.q_axis, step);
    course.state.omega_rad_s = value<order>(x.omega, step)[0];
    course.state.electrical_rad += course.motor.teeth * integral<order>(x.omega, step)[0];
}

/*
 * What the diodes demand of a phase, as a series that is >= 0 as long as they have it: a current
 * must not turn, and the back-EMF of a floating phase must stay within the blocking voltages.
 */
template <int order> struct Margin {
    double coefficient[order + 1];
};

template <int order>
Margin<order> margin_of(int phase, const Series<order> &x, const MotorCoefficients &motor,
                        const BridgeOutput &output, const Terminals &terminals, double h)
{
    Margin<order> margin = {};
    if (terminals.conducting[phase] == 0.0) {
        const bool negative = value<order - 1>(x.omega_q, in_both_lanes(h))[phase] < 0.0;
        const double sign = negative ? motor.torque_constant : -motor.torque_constant;
        for (int k = 0; k < order; k++) {
            margin.coefficient[k] = sign * x.omega_q[k][phase];
        }
        margin.coefficient[0] +=
            negative ? -output.if_positive_V[phase] : output.if_negative_V[phase];
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
Event first_event(const Series<order> &x, const MotorCoefficients &motor,
                  const BridgeOutput &output, const Terminals &terminals, double h)
{
    Event first = {h};
    const Phases along = terminals.direction * value<order>(x.current, in_both_lanes(h));
    for (int phase = 0; phase < 2; phase++) {
        if (terminals.conducting[phase] != 0.0 && !(along[phase] < 0.0)) {
            continue; /* its current goes on */
        }
        const Margin<order> margin = margin_of(phase, x, motor, output, terminals, h);
        const double at_end = value<order>(margin.coefficient, h);
        if (at_end < 0.0) {
            const double zero_s = falling_zero<order>(margin.coefficient, h, at_end);
            const double time_s = zero_s > least_progress * h ? zero_s : least_progress * h;
            if (time_s < first.time_s) {
                first = {time_s, terminals.conducting[phase] == 0.0 ? -1 : phase};
            }
        }
    }
    return first;
}

/* A step in dead time in which a phase may float or a current end: goes as far as the first event.
 */
template <int order, bool track_energy>
[[gnu::noinline]] double step_to_event(const Course &course, const BridgeOutput &output, double h)
{
    const Terminals terminals = terminals_of(output, course.motor, course.state);
    Series<order> x;
    expand<true>(x, course.state, course.motor, terminals.voltage_V, terminals.conducting);
    const Event event = first_event(x, course.motor, output, terminals, h);
    const Phases emf_Vs =
        course.motor.torque_constant * integral<order - 1>(x.omega_q, in_both_lanes(event.time_s));
    course.integrals.voltage_Vs += (1.0 - terminals.conducting) * emf_Vs;
    accept<track_energy>(course, x, output, terminals.voltage_V, event.time_s);
    if (event.blocking >= 0) {
        course.state.current_A[event.blocking] = 0.0;
    }
    return event.time_s;
}

/* A step in dead time: advances by h or to the first event before; returns the time that passed. */
template <int order, bool track_energy>
IN_PLACE double step_in_dead_time(const Course &course, const BridgeOutput &output, double h)
{
    const Phases before_A = course.state.current_A;
    const Phases diodes_V = output.if_negative_V - output.if_positive_V;
    const auto idle = (before_A == none) & (diodes_V != none);
    if ((idle[0] | idle[1]) != 0) {
        return step_to_event<order, track_energy>(course, output, h);
    }
    const Phases voltage_V = before_A > none ? output.if_positive_V : output.if_negative_V;
    Series<order> x;
    expand<false>(x, course.state, course.motor, voltage_V, both_conduct);
    const Phases along = diodes_V * (before_A * value<order>(x.current, in_both_lanes(h)));
    if (along[0] < 0.0 || along[1] < 0.0) {
        return step_to_event<order, track_energy>(course, output, h);
    }
    accept<track_energy>(course, x, output, voltage_V, h);
    return h;
}

template <int order, bool track_energy>
IN_PLACE double step(const Course &course, const BridgeOutput &output, double h)
{
    if (output.dead_time) {
        return step_in_dead_time<order, track_energy>(course, output, h);
    }
    Series<order> x;
    expand<false>(x, course.state, course.motor, output.if_positive_V, both_conduct);
    accept<track_energy>(course, x, output, output.if_positive_V, h);
    return h;
}

/* Through a stretch of constant switches, in steps of at most longest_s. */
template <int order, bool track_energy>
IN_PLACE void cross(const Course &course, const BridgeOutput &output, double duration_s,
                    double longest_s)
{
    double left_s = duration_s;
    while (left_s > 0.0) {
        const double h = left_s < longest_s ? left_s : longest_s;
        left_s -= step<order, track_energy>(course, output, h);
    }
}

/* Through a timetable; rate: how fast the solution can change, 1/s. */
template <bool track_energy>
IN_PLACE void follow(const Course &course, const Timetable &timetable, double rate)
{
    for (const Segment &segment : timetable) {
        const BridgeOutput &output = *segment.output;
        const double duration_s = segment.duration_s;
        const double extent = rate * duration_s;
        if (output.dead_time && extent < reach_2) {
            cross<2, track_energy>(course, output, duration_s, duration_s);
        } else if (extent < reach_3) {
            cross<3, track_energy>(course, output, duration_s, duration_s);
        } else if (extent < reach_4) {
            cross<4, track_energy>(course, output, duration_s, duration_s);
        } else {
            cross<5, track_energy>(course, output, duration_s, reach_5 / rate);
        }
    }
}

} // namespace integrator

} // namespace plant

#endif
