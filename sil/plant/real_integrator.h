/*
 * The Taylor-series integrator of the equations of real_motor.h. Internal to real_motor.cpp; the
 * orders and their bounds are those of the plain motor (integrator.h).
 */
#ifndef STEADYSTEP_PLANT_REAL_INTEGRATOR_H
#define STEADYSTEP_PLANT_REAL_INTEGRATOR_H

#include <utility>

#include "sil/plant/elementary.h"
#include "sil/plant/in_place.h"
#include "sil/plant/integrator.h"
#include "sil/plant/real_motor.h"
#include "sil/plant/taylor.h"

namespace plant
{

namespace real_integrator
{

/*
 * A series of order P over a step h leaves out about (rate h)^(P+1) / (P+1)!, of the motor and of
 * the bus each with its own rate. Orders are lower than the plain motor's, because each costs
 * thrice as much: the lowest that a segment's length allows, the highest in as many steps as it
 * takes.
 */
struct Reach {
    double motor, bus; /* the greatest rate x step */
};
constexpr Reach reach_2 = {0.006, 0.05};
constexpr Reach reach_3 = {0.025, 0.2};
constexpr Reach reach_4 = {0.1, 0.3};

constexpr double least_progress_s = 1e-12; /* to an event, however rounding falls */
constexpr double no_current_A = 1e-12;     /* what rounding leaves of a current that has ended */

/*
 * The unknowns as power series in the time since the start of the step. Functions of the rotor
 * angle are series of psi, the angle turned since: F(psi(t)) = sum F_j psi(t)^j, and psi^j starts
 * with t^j, so that the sum is finite for every coefficient. What is no vector stands in both
 * lanes, so that it multiplies vectors as it is. elastic: the shaft has a belt or stops.
 */
template <int order, bool elastic> struct Series {
    Phases flux[order + 1]; /* x */
    Phases flux_squared[order + 1];
    Phases current[order + 1];
    Phases omega[order + 1];
    Phases acceleration[order]; /* without Coulomb friction */
    Phases bus[order + 1];
    Phases load_omega[elastic ? order + 1 : 1]; /* behind a belt, if there is one, */
    Phases twist[elastic ? order + 1 : 1];      /* and by how much it is ahead */
    Phases beyond[elastic ? order + 1 : 1];     /* the nearer stop, what strikes it */
    Phases slope[order];                        /* f */
    Phases turned[order + 1][order + 1];        /* [j][n]: coefficient j + n of psi^j, j > 0 */

    Phases iron_A;           /* part of the current, constant */
    Phases current_per_flux; /* their changes, at the start of the step */

    /* Taylor coefficients in psi: of m, of f, and of the detent torque. */
    Phases magnet_at[order + 1];
    Phases slope_at[order];
    Phases detent_at[order];
};

/* Which of its cases each part is in during a step. */
struct Mode {
    Phases share;      /* of the bus voltage that acts on a phase; 0 where it floats */
    Phases drop_V;     /* of diodes, signed */
    Phases conducting; /* 1, or 0 where the phase floats */
    Phases direction;  /* of the current where only diodes let it flow: 1 or -1; else 0 */
    bool floating;     /* some phase floats */
    bool stuck;        /* Coulomb friction holds the rotor */
    double sliding;    /* sign of the speed against which it acts; 0: none or stuck */
    bool touching;     /* the nearer stop pushes */
    bool source_conducts;
    bool relaxing;      /* no phase draws from the bus: its exponential is taken, no series */
    double source_rate; /* 1/s, as far as they act in the series */
    double brake_rate;
    double per_capacitance;
};

/* One motor on its way: what it is, where it is, and what has flowed. */
struct Course {
    const RealCoefficients &motor;
    RealMotorState &state;
    MotorIntegrals &integrals;
    Decay &filter, &source; /* of the voltage filter, and of the bus towards the source */
};

/* Sum of F_j times coefficient k of psi^j. */
template <int k, typename X, typename Turned, int... j>
IN_PLACE X composed(const X *at, const Turned &turned, std::integer_sequence<int, j...>)
{
    return ((at[j + 1] * turned[j + 1][k - 1 - j]) + ...);
}

template <int k, typename X, typename Turned> IN_PLACE X composed(const X *at, const Turned &turned)
{
    if constexpr (k == 0) {
        return at[0];
    } else {
        return composed<k>(at, turned, std::make_integer_sequence<int, k>());
    }
}

/* Coefficient k of psi and its powers from the speed's coefficients before it. */
template <int k, int j, int order, bool elastic> IN_PLACE void raise(Series<order, elastic> &x)
{
    if constexpr (j <= k) {
        x.turned[j][k - j] = cauchy_product<k - j>(x.turned[1], x.turned[j - 1]);
        raise<k, j + 1>(x);
    }
}

template <int k, int order, bool elastic>
IN_PLACE void turn(Series<order, elastic> &x, const RealCoefficients &motor)
{
    if constexpr (k > 0) {
        x.turned[1][k - 1] = motor.share[k - 1].teeth * x.omega[k - 1];
        raise<k, 2>(x);
    }
}

/*
 * Coefficient k of the current, the flux's being known: what the cube of the flux has of earlier
 * coefficients apart, because the flux's latest is what the next one waits for.
 */
template <bool turning, int k, int order, bool elastic>
IN_PLACE void magnetise(Series<order, elastic> &x, const Magnetics &magnetics)
{
    const Phases saturation = magnetics.phase_saturation;
    if constexpr (k == 0) {
        x.flux_squared[0] = x.flux[0] * x.flux[0];
        x.current_per_flux = 1.0 + 3.0 * saturation * x.flux_squared[0];
        x.current[0] = x.flux[0] + saturation * (x.flux[0] * x.flux_squared[0]) -
                       magnetics.phase_magnet_A * x.magnet_at[0] + x.iron_A;
    } else {
        x.flux_squared[k] = 2.0 * x.flux[0] * x.flux[k];
        Phases earlier = {0.0, 0.0};
        if constexpr (turning) {
            earlier -= magnetics.phase_magnet_A * composed<k>(x.magnet_at, x.turned);
        }
        if constexpr (k > 1) {
            const Phases squared = cauchy_square<k - 2>(x.flux + 1);
            const Phases cubed =
                x.flux[0] * squared + cauchy_product<k - 2>(x.flux + 1, x.flux_squared + 1);
            x.flux_squared[k] += squared;
            earlier += saturation * cubed;
        }
        x.current[k] = x.current_per_flux * x.flux[k] + earlier;
    }
}

/* Coefficient k of the belt's pull at the rotor, over its inertia; k + 1 of what is behind it. */
template <int k, int order, bool elastic>
IN_PLACE Phases pull_of_belt(Series<order, elastic> &x, const RealCoefficients &motor)
{
    constexpr double part = 1.0 / (k + 1);
    const Phases ahead = x.load_omega[k] - x.omega[k];
    const Phases pull = motor.spring * x.twist[k] + motor.damper * ahead;
    Phases far = -motor.far_ratio * pull;
    if constexpr (k == 0) {
        far -= motor.far_load;
    }
    x.load_omega[k + 1] = part * far;
    x.twist[k + 1] = part * ahead;
    return pull;
}

/* The nearer stop's push, over the inertia that strikes it, from its depth and that one's change.
 */
IN_PLACE Phases push_of_stop(const RealCoefficients &motor, Phases beyond, Phases deeper)
{
    return motor.stop_spring * beyond + motor.stop_damper * deeper;
}

/* Coefficient k of that, in the angle's direction and over the inertia that strikes; k + 1 of how
   deep it is. */
template <int k, int order, bool elastic>
IN_PLACE Phases push_back(Series<order, elastic> &x, const RealCoefficients &motor,
                          const Mode &mode)
{
    const Phases side = motor.stop_side;
    const Phases deeper = side * (motor.belted ? x.load_omega[k] : x.omega[k]);
    x.beyond[k + 1] = (1.0 / (k + 1)) * deeper;
    return mode.touching ? -side * push_of_stop(motor, x.beyond[k], deeper) : Phases{0.0, 0.0};
}

/* Coefficient k of what belt and stop do to the rotor, over its inertia; k + 1 of theirs. */
template <int k, int order, bool elastic>
IN_PLACE Phases pull_of_shaft(Series<order, elastic> &x, const RealCoefficients &motor,
                              const Mode &mode)
{
    const Phases push = push_back<k>(x, motor, mode);
    Phases pull = pull_of_belt<k>(x, motor);
    if (motor.belted) {
        x.load_omega[k + 1] += (1.0 / (k + 1)) * push;
    } else {
        pull += push;
    }
    return pull;
}

/* Coefficients k + 1 and later from those before; the equations are in real_motor.h. */
template <bool floating, bool turning, int k, int order, bool elastic>
IN_PLACE void expand(Series<order, elastic> &x, const RealCoefficients &motor, const Mode &mode)
{
    const RealCoefficients::Share &share = motor.share[k];
    const Magnetics &magnetics = motor.magnetics;
    constexpr double part = 1.0 / (k + 1);

    if constexpr (turning && !floating) {
        turn<k>(x, motor);
    }
    magnetise<turning, k>(x, magnetics);
    if constexpr (floating) {
        x.current[k] *= mode.conducting;
    }
    /* What is known earlier comes first: the next coefficients wait for the flux and the current.
     */
    x.slope[k] = x.slope_at[0];
    Phases opposed = {0.0, 0.0};
    Phases pull = {0.0, 0.0};
    if constexpr (turning) {
        x.slope[k] = composed<k>(x.slope_at, x.turned);
        pull = cauchy_product<k>(x.slope, x.flux);
        opposed = composed<k>(x.detent_at, x.turned) + motor.friction * x.omega[k];
    } else {
        pull = x.slope_at[0] * x.flux[k];
        if constexpr (k == 0) {
            opposed = x.detent_at[0];
        }
    }
    if constexpr (elastic) {
        opposed -= pull_of_shaft<k>(x, motor, mode);
    }
    Phases voltage_V = mode.share * x.bus[k];
    Phases bus = -(mode.source_rate + mode.brake_rate) * x.bus[k];
    Phases coulomb = {0.0, 0.0};
    if constexpr (k == 0) {
        opposed += motor.load;
        coulomb = in_both_lanes(mode.sliding * motor.coulomb);
        voltage_V += mode.drop_V;
        bus += in_both_lanes(mode.source_rate * motor.supply.source_V);
    }
    bus -= mode.per_capacitance * sum_in_both_lanes(mode.share * x.current[k]);
    const Phases acceleration = motor.torque * sum_in_both_lanes(pull) - opposed;
    x.acceleration[k] = acceleration;
    x.omega[k + 1] = turning ? part * (acceleration - coulomb) : Phases{0.0, 0.0};
    x.bus[k + 1] = part * bus;
    Phases flux = share.voltage * voltage_V + share.resistance * x.current[k];
    if constexpr (floating) { /* current 0: (1 + 3 b x^2) dx/dt = I_f dm/dt, divided */
        Phases rest = {0.0, 0.0};
        if constexpr (turning) {
            turn<k + 1>(x, motor);
            rest = magnetics.phase_magnet_A * composed<k + 1>(x.magnet_at, x.turned);
        }
        for (int j = 1; j <= k; j++) {
            rest -= (3.0 * magnetics.phase_saturation * part * (k + 1 - j)) * x.flux_squared[j] *
                    x.flux[k + 1 - j];
        }
        const Phases open = rest / (1.0 + 3.0 * magnetics.phase_saturation * x.flux_squared[0]);
        flux = mode.conducting * flux + (1.0 - mode.conducting) * open;
    }
    x.flux[k + 1] = flux;
    if constexpr (k + 1 < order) {
        expand<floating, turning, k + 1>(x, motor, mode);
    }
}

/* Taylor coefficients j and later in psi, of f and of the detent torque. */
template <int j, int order, bool elastic>
IN_PLACE void differentiate(Series<order, elastic> &x, const RealCoefficients &motor,
                            const Axes &axes)
{
    if constexpr (j < order) {
        const RealCoefficients::InAngle &share = motor.in_angle[j];
        constexpr bool even = j % 2 == 0;
        constexpr int lane = even ? 1 : 0; /* a sine and its derivatives */
        x.slope_at[j] = share.once * (even ? exchanged(axes.once) : axes.once) +
                        share.thrice * (even ? exchanged(axes.thrice) : axes.thrice);
        x.magnet_at[j + 1] = x.slope_at[j] * (1.0 / (j + 1));
        x.detent_at[j] =
            in_both_lanes(share.detent_4 * axes.four_times[lane] +
                          share.detent_2 * axes.twice[lane] + share.detent_1 * axes.once[lane]);
        differentiate<j + 1>(x, motor, axes);
    }
}

/* Coefficients 0, and those in psi. */
template <int order, bool elastic>
IN_PLACE void start(Series<order, elastic> &x, const RealCoefficients &motor,
                    const RealMotorState &state)
{
    const Magnetics &magnetics = motor.magnetics;
    const Axes axes = axes_of(state.axis);
    x.flux[0] = state.flux;
    x.omega[0] = in_both_lanes(state.omega_rad_s);
    x.bus[0] = in_both_lanes(state.bus_V);
    if constexpr (elastic) {
        x.load_omega[0] = in_both_lanes(state.load_omega_rad_s);
        x.twist[0] = in_both_lanes(state.twist_rad);
        x.beyond[0] = in_both_lanes(state.beyond_rad);
    }
    x.iron_A = state.iron_A;

    x.magnet_at[0] = magnetics.magnet_axis(axes.once, axes.thrice);
    differentiate<0>(x, motor, axes);
    magnetise<true, 0>(x, magnetics);
}

/* Back-EMF of an open phase: L0 dx/dt with no current. */
template <int order, bool elastic>
double open_circuit_V(const Series<order, elastic> &x, const Magnetics &magnetics, int phase)
{
    return magnetics.torque * x.omega[0][0] * x.slope_at[0][phase] /
           (1.0 + 3.0 * magnetics.phase_saturation[phase] * x.flux_squared[0][phase]);
}

/* What the bridge offers a phase. */
struct Terminal {
    double share, drop_V, conducting, direction; /* as in Mode */
};

/* Of a phase, with a leg in dead time or not: see integrator::Terminal. */
template <int order, bool elastic>
IN_PLACE Terminal terminal(int phase, const BridgeOutput &output, const Series<order, elastic> &x,
                           const RealCoefficients &motor, const RealMotorState &state)
{
    const double legs = output.diode_V[phase];
    if (legs == 0.0) {
        return {output.if_positive_V[phase], 0.0, 1.0, 0.0};
    }
    const double drop_V = legs * motor.diode_drop;
    const double positive = output.bus_if_positive_V()[phase];
    const double negative = output.bus_if_negative_V()[phase];
    double sign = x.current[0][phase];
    if (state.blocked[phase] || magnitude(sign) < no_current_A) {
        const double emf_V = open_circuit_V(x, motor.magnetics, phase);
        sign = emf_V < positive * state.bus_V - drop_V
                   ? 1.0
                   : (emf_V > negative * state.bus_V + drop_V ? -1.0 : 0.0);
    }
    if (sign > 0.0) {
        return {positive, -drop_V, 1.0, 1.0};
    }
    if (sign < 0.0) {
        return {negative, drop_V, 1.0, -1.0};
    }
    return {0.0, 0.0, 0.0, 0.0};
}

/* What the bridge offers both phases with a leg in dead time: mostly their currents say it. */
template <int order, bool elastic>
IN_PLACE void set_terminals(Mode &mode, const Series<order, elastic> &x, const BridgeOutput &output,
                            const RealCoefficients &motor, const RealMotorState &state)
{
    const Phases none = {0.0, 0.0};
    const auto carried = output.diode_V != none;
    const auto small = (x.current[0] < in_both_lanes(no_current_A)) &
                       (x.current[0] > in_both_lanes(-no_current_A)) & carried;
    if (!state.blocked[0] && !state.blocked[1] && (small[0] | small[1]) == 0) {
        const auto positive = x.current[0] > none;
        const Phases drop_V = output.diode_V * in_both_lanes(motor.diode_drop);
        mode.share = positive ? output.bus_if_positive_V() : output.bus_if_negative_V();
        mode.drop_V = positive ? -drop_V : drop_V;
        mode.conducting = Phases{1.0, 1.0};
        mode.direction = carried ? (positive ? Phases{1.0, 1.0} : Phases{-1.0, -1.0}) : none;
        mode.floating = false;
        return;
    }
    const Terminal a = terminal(0, output, x, motor, state);
    const Terminal b = terminal(1, output, x, motor, state);
    mode.share = Phases{a.share, b.share};
    mode.drop_V = Phases{a.drop_V, b.drop_V};
    mode.conducting = Phases{a.conducting, b.conducting};
    mode.direction = Phases{a.direction, b.direction};
    mode.floating = a.conducting * b.conducting == 0.0;
}

/* A stop pushes where it has been entered, unless the way out is quicker than its damper lets go.
 */
template <int order, bool elastic>
IN_PLACE void set_stop(Mode &mode, const Series<order, elastic> &x, const RealCoefficients &motor)
{
    mode.touching = false;
    if constexpr (elastic) {
        const Phases speed = motor.belted ? x.load_omega[0] : x.omega[0];
        mode.touching = x.beyond[0][0] > 0.0 &&
                        push_of_stop(motor, x.beyond[0], motor.stop_side * speed)[0] > 0.0;
    }
}

/* At rest the rotor sticks as long as friction can hold it. */
template <int order, bool elastic>
IN_PLACE void set_friction(Mode &mode, const Series<order, elastic> &x,
                           const RealCoefficients &motor, const RealMotorState &state)
{
    mode.stuck = false;
    if (motor.coulomb == 0.0) {
        mode.sliding = 0.0;
    } else if (x.omega[0][0] == 0.0) {
        double acceleration =
            motor.torque[0] * dot(x.slope_at[0], x.flux[0]) - x.detent_at[0][0] - motor.load[0];
        if constexpr (elastic) {
            acceleration += motor.spring[0] * x.twist[0][0] + motor.damper[0] * x.load_omega[0][0];
            if (mode.touching && !motor.belted) {
                acceleration -= motor.stop_side[0] * motor.stop_spring[0] * x.beyond[0][0];
            }
        }
        mode.stuck = !state.released && magnitude(acceleration) <= motor.coulomb;
        mode.sliding = mode.stuck ? 0.0 : (acceleration > 0.0 ? 1.0 : -1.0);
    } else {
        mode.sliding = x.omega[0][0] > 0.0 ? 1.0 : -1.0;
    }
}

template <int order, bool elastic>
IN_PLACE void set_bus(Mode &mode, const Series<order, elastic> &x, const RealCoefficients &motor,
                      const RealMotorState &state)
{
    const Supply &supply = motor.supply;
    mode.per_capacitance = supply.per_capacitance;
    mode.source_conducts = false;
    mode.relaxing = false;
    mode.source_rate = 0.0;
    mode.brake_rate = 0.0;
    if (supply.stiff()) {
        return;
    }
    const bool drawing = mode.share[0] != 0.0 || mode.share[1] != 0.0;
    mode.source_conducts =
        state.bus_V < supply.source_V ||
        (state.bus_V == supply.source_V && (!drawing || dot(mode.share, x.current[0]) >= 0.0));
    mode.relaxing = !drawing && mode.source_conducts && !state.braking;
    if (mode.source_conducts && !mode.relaxing) {
        mode.source_rate = supply.source_rate;
    }
    if (state.braking) {
        mode.brake_rate = supply.brake_rate;
    }
}

/* A phase with a broken lead floats whatever the bridge does. */
inline void break_open(Mode &mode, const RealMotorState &state)
{
    for (int phase = 0; phase < 2; phase++) {
        if (state.open[phase]) {
            mode.share[phase] = mode.drop_V[phase] = 0.0;
            mode.conducting[phase] = mode.direction[phase] = 0.0;
            mode.floating = true;
        }
    }
}

/* Every member by itself: clearing the structure first takes a sixth of a step's time. */
template <int order, bool elastic>
IN_PLACE Mode mode_of(const Series<order, elastic> &x, const BridgeOutput &output,
                      const RealCoefficients &motor, const RealMotorState &state)
{
    Mode mode;
    if (output.dead_time) {
        set_terminals(mode, x, output, motor, state);
    } else {
        mode.share = output.if_positive_V;
        mode.drop_V = Phases{0.0, 0.0};
        mode.conducting = Phases{1.0, 1.0};
        mode.direction = Phases{0.0, 0.0};
        mode.floating = false;
    }
    if (state.open[0] || state.open[1]) {
        break_open(mode, state);
    }
    set_stop(mode, x, motor);
    set_friction(mode, x, motor, state);
    set_bus(mode, x, motor, state);
    return mode;
}

template <int order, bool elastic>
void add_energies_of_belt(const Course &course, const Series<order, elastic> &x, double h)
{
    const RealCoefficients &motor = course.motor;
    const double inertia = 1.0 / motor.inverse_inertia;
    const double far_inertia = inertia / motor.far_ratio[0];
    Phases ahead[order + 1];
    for (int k = 0; k <= order; k++) {
        ahead[k] = x.load_omega[k] - x.omega[k];
    }
    course.integrals.damping_J +=
        motor.damper[0] * inertia * integral_of_square<order>(ahead, h)[0];
    course.integrals.load_J +=
        motor.far_load[0] * far_inertia * integral<order>(x.load_omega, in_both_lanes(h))[0];
}

/* Work that is done on the stop: what it stores apart, it is lost. */
template <int order, bool elastic>
void add_energies_of_stop(const Course &course, const Series<order, elastic> &x, const Mode &mode,
                          double h)
{
    const RealCoefficients &motor = course.motor;
    if (!mode.touching) {
        return;
    }
    Phases deeper[order + 1];
    for (int k = 0; k <= order; k++) {
        deeper[k] = motor.stop_side * (motor.belted ? x.load_omega[k] : x.omega[k]);
    }
    const double from = x.beyond[0][0];
    const double to = value<order>(x.beyond, in_both_lanes(h))[0];
    course.integrals.stop_J +=
        motor.struck_kgm2 * (0.5 * motor.stop_spring[0] * (to * to - from * from) +
                             motor.stop_damper[0] * integral_of_square<order>(deeper, h)[0]);
}

template <int order, bool elastic>
[[gnu::noinline]] void add_energies(const Course &course, const Series<order, elastic> &x,
                                    const BridgeOutput &output, const Mode &mode, double h)
{
    const RealCoefficients &motor = course.motor;
    const Supply &supply = motor.supply;
    MotorIntegrals &integrals = course.integrals;
    const double inertia = 1.0 / motor.inverse_inertia;
    const Phases span_s = in_both_lanes(h);
    const Phases charge = integral<order>(x.current, span_s);
    const Phases current_squared = integral_of_square<order>(x.current, h);
    const double way = integral<order>(x.omega, span_s)[0];
    integrals.diode_J += motor.diode_drop * (output.diode_V[0] * magnitude(charge[0]) +
                                             output.diode_V[1] * magnitude(charge[1]));
    integrals.copper_J += dot(motor.resistance, current_squared);
    integrals.friction_J += motor.friction[0] * inertia * integral_of_square<order>(x.omega, h)[0];
    integrals.load_J += motor.load[0] * inertia * way;
    if constexpr (elastic) {
        if (motor.belted) {
            add_energies_of_belt(course, x, h);
        }
        add_energies_of_stop(course, x, mode, h);
    }
    integrals.coulomb_J += mode.sliding * motor.coulomb * inertia * way;
    if (supply.stiff()) {
        integrals.supplied_J += supply.source_V * dot(mode.share, charge);
        return;
    }
    double below[order + 1]; /* Vs - V */
    for (int k = 0; k <= order; k++) {
        below[k] = -x.bus[k][0];
    }
    below[0] += supply.source_V;
    const double source_A_per_V = mode.source_rate * supply.capacitance_F;
    /* One term less: the charge that the series has put into the capacitor. */
    integrals.supplied_J += supply.source_V * source_A_per_V * integral<order - 1>(below, h);
    integrals.source_J += source_A_per_V * integral_of_square<order>(below, h);
    integrals.brake_J +=
        mode.brake_rate * supply.capacitance_F * integral_of_square<order>(x.bus, h)[0];
}

/* The bus without a load goes to the source's voltage. */
template <bool track_energy> IN_PLACE void relax(const Course &course, double h)
{
    const Supply &supply = course.motor.supply;
    const double below_V = supply.source_V - course.state.bus_V;
    const double left_V = below_V * course.source.over(h).left;
    course.state.bus_V = supply.source_V - left_V;
    if constexpr (track_energy) {
        const double capacitance_F = supply.capacitance_F;
        course.integrals.supplied_J += supply.source_V * capacitance_F * (below_V - left_V);
        course.integrals.source_J += 0.5 * capacitance_F * (below_V * below_V - left_V * left_V);
    }
}

/*
 * Share of the bus voltage between the legs of a phase that carries no current: a leg in dead time
 * is taken to stand at half the bus, between its diodes.
 */
inline double between_legs(const BridgeOutput &output, int phase)
{
    return 0.5 * (output.if_positive_V[phase] + output.if_negative_V[phase]);
}

/* Back-EMF of the phases at t = h as if open, L0 dx/dt. */
template <int order, bool elastic>
Phases induced_V(const Series<order, elastic> &x, const Magnetics &magnetics, double h)
{
    Phases rate = x.flux[1];
    double power = h;
    for (int k = 2; k <= order; k++) {
        rate += x.flux[k] * (k * power);
        power *= h;
    }
    return magnetics.phase_inductance * rate;
}

/* Voltage at the bridge of the phases at t = h, where the bus has bus_V. */
template <int order, bool elastic>
IN_PLACE Phases terminal_V(const Course &course, const Series<order, elastic> &x,
                           const BridgeOutput &output, const Mode &mode, double h, Phases bus_V)
{
    Phases voltage_V = mode.share * bus_V + mode.drop_V;
    if (mode.floating) {
        voltage_V += (1.0 - mode.conducting) * induced_V(x, course.motor.magnetics, h);
        for (int phase = 0; phase < 2; phase++) {
            if (course.state.open[phase]) {
                voltage_V[phase] = between_legs(output, phase) * bus_V[phase];
            }
        }
    }
    return voltage_V;
}

/* Behind the filter at t = h, of a voltage that is taken as a straight line within the step. */
template <int order, bool elastic>
IN_PLACE void filter(const Course &course, const Series<order, elastic> &x,
                     const BridgeOutput &output, const Mode &mode, double h, Phases bus_V)
{
    const Phases first_V = terminal_V(course, x, output, mode, 0.0, x.bus[0]);
    const Phases last_V = terminal_V(course, x, output, mode, h, bus_V);
    const Decay::Span &span = course.filter.over(h);
    const Phases lag_V = span.constants * (last_V - first_V);
    Phases &filtered_V = course.state.filtered_V;
    filtered_V = last_V - lag_V + span.left * (filtered_V - first_V + lag_V);
}

/* The state at the end of the step. */
template <bool track_energy, bool turning, int order, bool elastic>
IN_PLACE void accept(const Course &course, const Series<order, elastic> &x,
                     const BridgeOutput &output, const Mode &mode, double h)
{
    RealMotorState &state = course.state;
    const Phases span_s = in_both_lanes(h);
    const Phases bus_V = value<order>(x.bus, span_s);
    course.integrals.voltage_Vs +=
        mode.share * integral<order>(x.bus, span_s) + mode.drop_V * span_s;
    if (course.motor.filter_rate > 0.0) {
        filter(course, x, output, mode, h, bus_V);
    }
    if constexpr (track_energy) {
        add_energies(course, x, output, mode, h);
    }
    state.flux = value<order>(x.flux, span_s);
    if constexpr (turning) {
        /* By the speed that was known, and by its change. */
        const double teeth = course.motor.magnetics.teeth;
        const double at_speed_rad = teeth * (x.omega[0][0] * h);
        const double more_rad = teeth * integral_of_change<order>(x.omega, span_s)[0];
        state.omega_rad_s = value<order>(x.omega, span_s)[0];
        state.electrical_rad += at_speed_rad + more_rad;
        state.axis =
            turned_by_little<2>(turned_by_little<order>(state.axis, at_speed_rad), more_rad);
    }
    state.bus_V = bus_V[0];
    if constexpr (elastic) {
        state.load_omega_rad_s = value<order>(x.load_omega, span_s)[0];
        state.twist_rad = value<order>(x.twist, span_s)[0];
        state.beyond_rad = value<order>(x.beyond, span_s)[0];
    }
    if (mode.relaxing) {
        relax<track_energy>(course, h);
    }
    state.blocked[0] = state.blocked[1] = false;
    state.released = false;
}

/*
 * What must be >= 0 for the mode to go on, as a series: a current that diodes carry along its
 * direction, the back-EMF of a floating phase within what the diodes hold, ...
 */
template <int order> struct Margin {
    double coefficient[order + 1];
};

template <int order, bool elastic>
Margin<order> margin_of_phase(int phase, const Series<order, elastic> &x,
                              const RealCoefficients &motor, const BridgeOutput &output,
                              const Mode &mode, double h)
{
    Margin<order> margin = {};
    if (mode.conducting[phase] != 0.0) {
        for (int k = 0; k <= order; k++) {
            margin.coefficient[k] = mode.direction[phase] * x.current[k][phase];
        }
        return margin;
    }
    double emf[order];
    for (int k = 0; k < order; k++) {
        emf[k] = motor.magnetics.phase_inductance[phase] * (k + 1) * x.flux[k + 1][phase];
    }
    const double drops = output.diode_V[phase];
    const bool negative = value<order - 1>(emf, h) < 0.0;
    const double sign = negative ? 1.0 : -1.0;
    const double share =
        negative ? -output.bus_if_positive_V()[phase] : output.bus_if_negative_V()[phase];
    for (int k = 0; k < order; k++) {
        margin.coefficient[k] = sign * emf[k] + share * x.bus[k][0];
    }
    margin.coefficient[0] += drops * motor.diode_drop;
    return margin;
}

/* ... the speed while the rotor slides, what friction holds while it sticks, ... */
template <int order, bool elastic>
Margin<order> margin_of_friction(const Series<order, elastic> &x, const RealCoefficients &motor,
                                 const Mode &mode, double h)
{
    Margin<order> margin = {};
    if (!mode.stuck) {
        for (int k = 0; k <= order; k++) {
            margin.coefficient[k] = mode.sliding * x.omega[k][0];
        }
        return margin;
    }
    const double sign = value<order - 1>(x.acceleration, in_both_lanes(h))[0] < 0.0 ? 1.0 : -1.0;
    for (int k = 0; k < order; k++) {
        margin.coefficient[k] = sign * x.acceleration[k][0];
    }
    margin.coefficient[0] += motor.coulomb;
    return margin;
}

/* ... the push of a stop that is touched; of one that is not what is left of the way to it, or
   how far its damper stays behind, ... */
template <int order, bool elastic>
Margin<order> margin_of_stop(const Series<order, elastic> &x, const RealCoefficients &motor,
                             const Mode &mode)
{
    Margin<order> margin = {};
    const bool outside = !mode.touching && x.beyond[0][0] <= 0.0;
    for (int k = 0; k <= order; k++) {
        const Phases deeper = motor.stop_side * (motor.belted ? x.load_omega[k] : x.omega[k]);
        const double push = push_of_stop(motor, x.beyond[k], deeper)[0];
        margin.coefficient[k] = outside ? -x.beyond[k][0] : mode.touching ? push : -push;
    }
    return margin;
}

/* ... and the bus below or above a threshold. */
template <int order, bool elastic>
Margin<order> margin_of_bus(const Series<order, elastic> &x, double threshold_V, bool below)
{
    Margin<order> margin = {};
    const double sign = below ? -1.0 : 1.0;
    for (int k = 0; k <= order; k++) {
        margin.coefficient[k] = sign * x.bus[k][0];
    }
    margin.coefficient[0] -= sign * threshold_V;
    return margin;
}

/* By far more than rounding, so that no margin need be asked. */
inline bool clear_of(double bus_V, double threshold_V, bool below)
{
    const double distance_V = below ? threshold_V - bus_V : bus_V - threshold_V;
    return distance_V > 1e-9 * threshold_V;
}

/* The first end of a mode within a step. */
enum class End {
    of_step,
    of_current_a,
    of_current_b,
    of_floating,
    of_motion,
    of_rest,
    of_touch,
    of_source,
    of_brake
};

struct Event {
    double time_s;
    End end = End::of_step;
};

template <int order> void consider(Event &first, End end, const Margin<order> &margin, double h)
{
    const double at_end = value<order>(margin.coefficient, h);
    if (!(at_end < 0.0)) {
        return;
    }
    const double *x = margin.coefficient;
    const bool at_once = x[0] < 0.0 || (x[0] == 0.0 && x[1] <= 0.0);
    const double zero_s = at_once ? 0.0 : falling_zero<order>(x, h, at_end);
    const double least_s = least_progress_s < h ? least_progress_s : h;
    const double time_s = zero_s > least_s ? zero_s : least_s;
    if (time_s < first.time_s) {
        first = {time_s, end};
    }
}

template <int order, bool elastic>
Event first_event(const Series<order, elastic> &x, const RealCoefficients &motor,
                  const RealMotorState &state, const BridgeOutput &output, const Mode &mode,
                  double h)
{
    Event first = {h};
    const Phases span_s = in_both_lanes(h);
    const Phases along = mode.direction * value<order>(x.current, span_s);
    for (int phase = 0; phase < 2; phase++) {
        const bool goes_on = mode.conducting[phase] != 0.0 && !(along[phase] < 0.0);
        if (output.diode_V[phase] != 0.0 && !state.open[phase] && !goes_on) {
            const End current = phase == 0 ? End::of_current_a : End::of_current_b;
            consider(first, mode.conducting[phase] != 0.0 ? current : End::of_floating,
                     margin_of_phase(phase, x, motor, output, mode, h), h);
        }
    }
    if (motor.coulomb > 0.0) {
        consider(first, !mode.stuck ? End::of_motion : End::of_rest,
                 margin_of_friction(x, motor, mode, h), h);
    }
    if constexpr (elastic) {
        if (motor.stop_side[0] != 0.0) {
            consider(first, End::of_touch, margin_of_stop(x, motor, mode), h);
        }
    }
    const Supply &supply = motor.supply;
    const double bus_V = value<order>(x.bus, span_s)[0];
    if (!supply.stiff() && !clear_of(bus_V, supply.source_V, mode.source_conducts)) {
        consider(first, End::of_source, margin_of_bus(x, supply.source_V, mode.source_conducts), h);
    }
    const double brake_V = state.braking ? supply.brake_off_V : supply.brake_on_V;
    if (supply.brake_rate > 0.0 && !clear_of(bus_V, brake_V, !state.braking)) {
        consider(first, End::of_brake, margin_of_bus(x, brake_V, !state.braking), h);
    }
    return first;
}

/* Puts a floating phase's flux where its current is 0, to rounding. */
inline void hold_open(RealMotorState &state, const Magnetics &magnetics, int phase)
{
    const double flux = state.flux[phase];
    const double current_A =
        magnetics.current_A(state.flux, axes_of(state.axis))[phase] + state.iron_A[phase];
    state.flux[phase] -= current_A / (1.0 + 3.0 * magnetics.phase_saturation[phase] * flux * flux);
    state.blocked[phase] = true;
}

/* What the last term of the current is less than: five times what the reach of each order allows.
 */
template <int order, bool elastic>
IN_PLACE Phases last_term_A(const Series<order, elastic> &x, const RealCoefficients &motor)
{
    const Phases flux = x.flux[0] < 0.0 ? -x.flux[0] : x.flux[0];
    return 1e-4 * (motor.magnetics.phase_magnet_A + flux);
}

/* Whether a mode may end within a step, which is the exception. */
template <bool turning, bool dead_time, int order, bool elastic>
IN_PLACE bool mode_ends(const Series<order, elastic> &x, const RealCoefficients &motor,
                        const RealMotorState &state, const Mode &mode, double h)
{
    const Supply &supply = motor.supply;
    const Phases span_s = in_both_lanes(h);
    if (turning ? mode.sliding * value<order>(x.omega, span_s)[0] < 0.0
                : magnitude(value<order - 1>(x.acceleration, span_s)[0]) > motor.coulomb) {
        return true;
    }
    if constexpr (elastic) {
        if (motor.stop_side[0] != 0.0 &&
            value<order>(margin_of_stop(x, motor, mode).coefficient, h) < 0.0) {
            return true;
        }
    }
    if constexpr (dead_time) {
        const Phases along = mode.direction * value<order - 1>(x.current, span_s);
        const auto doubtful = along < mode.direction * mode.direction * last_term_A(x, motor);
        if ((doubtful[0] | doubtful[1]) != 0) {
            return true;
        }
    }
    if (supply.stiff()) {
        return false;
    }
    const double bus_V = value<order>(x.bus, span_s)[0];
    if (mode.source_conducts ? bus_V > supply.source_V : bus_V < supply.source_V) {
        return true;
    }
    return supply.brake_rate > 0.0 &&
           (state.braking ? bus_V < supply.brake_off_V : bus_V > supply.brake_on_V);
}

/* All series; the current's last coefficient where somebody wants it. */
template <bool floating, bool turning, bool whole_current, int order, bool elastic>
IN_PLACE void expand_all(Series<order, elastic> &x, const RealCoefficients &motor, const Mode &mode)
{
    expand<floating, turning, 0>(x, motor, mode);
    if constexpr (whole_current) {
        if constexpr (turning && !floating) {
            turn<order>(x, motor);
        }
        magnetise<turning, order>(x, motor.magnetics);
        if constexpr (floating) {
            x.current[order] *= mode.conducting;
        }
    }
}

/* As far as the first event; what ends there. */
template <bool turning, bool track_energy, int order, bool elastic>
Event accept_to_event(const Course &course, Series<order, elastic> &x, const BridgeOutput &output,
                      const Mode &mode, double h)
{
    if (mode.floating) {
        expand_all<true, turning, true>(x, course.motor, mode);
    } else {
        expand_all<false, turning, true>(x, course.motor, mode);
    }
    const Event event = first_event(x, course.motor, course.state, output, mode, h);
    accept<track_energy, turning>(course, x, output, mode, event.time_s);
    return event;
}

/*
 * A step in which a phase floats or a mode ends: goes as far as the first event. It starts anew, so
 * that the series of all other steps stay in registers.
 */
template <int order, bool elastic, bool track_energy>
[[gnu::noinline]] double step_to_event(const Course &course, const BridgeOutput &output, double h)
{
    const Magnetics &magnetics = course.motor.magnetics;
    RealMotorState &state = course.state;
    Series<order, elastic> x;
    start(x, course.motor, state);
    const Mode mode = mode_of(x, output, course.motor, state);
    const Phases before = state.flux;
    const Event event = mode.stuck
                            ? accept_to_event<false, track_energy>(course, x, output, mode, h)
                            : accept_to_event<true, track_energy>(course, x, output, mode, h);
    Phases floating_Vs =
        (1.0 - mode.conducting) * magnetics.phase_inductance * (state.flux - before);
    for (int phase = 0; phase < 2; phase++) {
        if (state.open[phase]) {
            floating_Vs[phase] = between_legs(output, phase) *
                                 integral<order>(x.bus, in_both_lanes(event.time_s))[0];
        }
    }
    course.integrals.voltage_Vs += floating_Vs;
    for (int phase = 0; phase < 2; phase++) {
        const End current = phase == 0 ? End::of_current_a : End::of_current_b;
        if (mode.conducting[phase] == 0.0 || event.end == current) {
            hold_open(state, magnetics, phase);
        }
    }
    if (event.end == End::of_motion) {
        state.omega_rad_s = 0.0;
    } else if (event.end == End::of_rest) {
        state.released = true;
    } else if (event.end == End::of_source) {
        state.bus_V = course.motor.supply.source_V;
    } else if (event.end == End::of_brake) {
        state.braking = !state.braking;
    }
    return event.time_s;
}

/* A step in which no phase floats; returns the time that passed. */
template <bool turning, bool dead_time, bool track_energy, int order, bool elastic>
IN_PLACE double step_through(const Course &course, Series<order, elastic> &x,
                             const BridgeOutput &output, const Mode &mode, double h)
{
    expand_all<false, turning, track_energy>(x, course.motor, mode);
    if (mode_ends<turning, dead_time>(x, course.motor, course.state, mode, h)) {
        return step_to_event<order, elastic, track_energy>(course, output, h);
    }
    accept<track_energy, turning>(course, x, output, mode, h);
    return h;
}

/* Advances by h or to the first event before; returns the time that passed. */
template <int order, bool elastic, bool track_energy, bool dead_time>
IN_PLACE double step(const Course &course, const BridgeOutput &output, double h)
{
    Series<order, elastic> x;
    start(x, course.motor, course.state);
    const Mode mode = mode_of(x, output, course.motor, course.state);
    if (mode.floating) {
        return step_to_event<order, elastic, track_energy>(course, output, h);
    }
    return mode.stuck ? step_through<false, dead_time, track_energy>(course, x, output, mode, h)
                      : step_through<true, dead_time, track_energy>(course, x, output, mode, h);
}

/* Through a stretch of constant switches, in steps of step_s as long as no mode ends. */
template <int order, bool elastic, bool track_energy>
IN_PLACE void cross(const Course &course, const BridgeOutput &output, double duration_s,
                    double step_s)
{
    double left_s = duration_s;
    while (left_s > 0.0) { /* what rounding leaves is no step of its own */
        const double h = left_s < 1.000001 * step_s ? left_s : step_s;
        left_s -= output.dead_time ? step<order, elastic, track_energy, true>(course, output, h)
                                   : step<order, elastic, track_energy, false>(course, output, h);
    }
}

/* Of the fewest equal parts of a duration that are at most longest_s. */
IN_PLACE double equal_part(double duration_s, double longest_s)
{
    const double parts = duration_s / longest_s;
    const double whole = static_cast<double>(static_cast<int>(parts));
    return duration_s / (whole < parts ? whole + 1.0 : whole);
}

/* Through a timetable; rate: how fast the solution can change, 1/s. */
template <bool elastic, bool track_energy>
IN_PLACE void follow(const Course &course, const Timetable &timetable, double rate)
{
    const Supply &supply = course.motor.supply;
    for (const Segment &segment : timetable) {
        const BridgeOutput &output = *segment.output;
        const double duration_s = segment.duration_s;
        const double bus_rate = supply.brake_rate + (output.draws ? supply.source_rate : 0.0);
        if (rate * duration_s < reach_2.motor && bus_rate * duration_s < reach_2.bus) {
            cross<2, elastic, track_energy>(course, output, duration_s, duration_s);
        } else if (rate * duration_s < reach_3.motor && bus_rate * duration_s < reach_3.bus) {
            cross<3, elastic, track_energy>(course, output, duration_s, duration_s);
        } else {
            const double by_motor_s = reach_4.motor / rate;
            const double by_bus_s = reach_4.bus / bus_rate; /* infinite on a stiff bus */
            const double longest_s = by_motor_s < by_bus_s ? by_motor_s : by_bus_s;
            cross<4, elastic, track_energy>(course, output, duration_s,
                                            equal_part(duration_s, longest_s));
        }
    }
}

} // namespace real_integrator

} // namespace plant

#endif
