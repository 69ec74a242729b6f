#include "sil/plant/real_motor.h"

#include <cmath>

#include "sil/plant/elementary.h"
#include "sil/plant/real_integrator.h"
#include "sil/plant/require.h"

namespace plant
{

namespace
{

constexpr double fastest_rate = 1e9; /* 1/s: a runaway motor ends, if not accurately */

/* What the magnetic circuit depends on. */
bool same_magnetics(const MotorConfig &x, const MotorConfig &y)
{
    return x.inductance_H == y.inductance_H && x.torque_constant_Nm_A == y.torque_constant_Nm_A &&
           x.rotor_teeth == y.rotor_teeth;
}

void require_coulomb_friction(double share)
{
    require(share >= 0.0 && share <= 10.0, "coulomb_friction", share, "0...10");
}

void require_phase_scale(double scale, const char *field)
{
    require(scale >= 0.5 && scale <= 2.0, field, scale, "0.5...2");
}

} // namespace

RealMotor::RealMotor(const Config &config)
    : imperfections_(config.imperfections),
      belt_(belt_of(config.imperfections.belt, config.motor.inertia_kgm2)),
      period_s_(config.bridge.period_s), filter_(0.0), source_(0.0),
      track_energy_(config.track_energy)
{
    constexpr double slowest_filter_s = 1e-3, fastest_filter_s = 1e-7;
    const double filter_s = imperfections_.phase_voltage_filter_s;
    require_motion(config.initial_theta_rad, config.initial_omega_rad_s);
    require_coulomb_friction(imperfections_.coulomb_friction);
    require(filter_s == 0.0 || (filter_s >= fastest_filter_s && filter_s <= slowest_filter_s),
            "phase_voltage_filter_s", filter_s, "0 (none) or 1e-7...1e-3 s");
    coefficients_.filter_rate = filter_s > 0.0 ? 1.0 / filter_s : 0.0;
    filter_ = Decay(coefficients_.filter_rate);
    require(imperfections_.bridge_resistance_ohm >= 0.0 &&
                imperfections_.bridge_resistance_ohm <= 1e4,
            "bridge_resistance_ohm", imperfections_.bridge_resistance_ohm, "0...1e4 ohm");
    require_phase_scale(imperfections_.resistance_a_scale, "resistance_a_scale");
    require_phase_scale(imperfections_.resistance_b_scale, "resistance_b_scale");
    stops_ = stops_of(config.stops);
    coefficients_.supply = supply_of(config.supply, config.bridge.bus_V);
    source_ = Decay(coefficients_.supply.source_rate);
    coefficients_.diode_drop = config.bridge.diode_drop_V;
    state_.omega_rad_s = state_.load_omega_rad_s = config.initial_omega_rad_s;
    state_.electrical_rad = config.motor.rotor_teeth * config.initial_theta_rad;
    state_.bus_V = config.bridge.bus_V;
    set_parameters(config.motor);
    stop_reference_J_ = stop_J();
}

RealMotor::RealMotor(const Config &config, const Motor &motor, double load_torque_Nm)
    : RealMotor(config)
{
    const MotorState &from = motor.state();
    state_.omega_rad_s = state_.load_omega_rad_s = from.omega_rad_s;
    state_.electrical_turns = from.electrical_turns;
    state_.electrical_rad = from.electrical_rad;
    set_load_torque(load_torque_Nm);
    begin_period();
    for (int phase = 0; phase < 2; phase++) {
        state_.blocked[phase] = from.current_A[phase] == 0.0;
    }
    state_.flux = coefficients_.magnetics.flux(from.current_A, axes_of(state_.axis));
    integrals_ = motor.integrals();
}

void RealMotor::set_parameters(const MotorConfig &config)
{
    require_motor(config);
    const Phases kept_A = motor_.rotor_teeth > 0 ? current_A() : Phases{0.0, 0.0};
    RealCoefficients &motor = coefficients_;
    if (!same_magnetics(config, motor_)) {
        motor.magnetics = magnetics_of(config, imperfections_);
    }
    motor_ = config;
    const Magnetics &magnetics = motor.magnetics;
    const double per_J = 1.0 / (config.inertia_kgm2 * (1.0 - belt_.inertia_share));
    const Phases lighter =
        in_both_lanes(per_J / (motor.inverse_inertia > 0.0 ? motor.inverse_inertia : per_J));
    motor.load *= lighter;
    motor.far_load *= lighter;
    motor.inverse_inertia = per_J;
    motor.resistance = config.resistance_ohm * Phases{imperfections_.resistance_a_scale,
                                                      imperfections_.resistance_b_scale} +
                       imperfections_.bridge_resistance_ohm;
    motor.iron = iron_of(config, imperfections_, magnetics, period_s_);
    motor.belted = belt_.present();
    motor.spring = in_both_lanes(belt_.spring_Nm_rad * per_J);
    motor.damper = in_both_lanes(belt_.damper_Nms_rad * per_J);
    motor.far_ratio =
        in_both_lanes(belt_.present() ? (1.0 - belt_.inertia_share) / belt_.inertia_share : 0.0);
    put_stops();
    motor.torque = in_both_lanes(magnetics.torque * per_J);
    motor.friction = in_both_lanes(config.viscous_friction_Nms_rad * per_J);
    motor.coulomb =
        (imperfections_.coulomb_friction * holding_torque_Nm(config, imperfections_) + jam_Nm_) *
        per_J;
    const double detent_4 = magnetics.unmagnetised_detent_4() * per_J;
    const double detent_2 = magnetics.unmagnetised_detent_2() * per_J;
    const double detent_1 = magnetics.detent_1 * per_J;
    motor.stiffness = magnetics.teeth * (4.0 * magnitude(detent_4) + 2.0 * magnitude(detent_2) +
                                         magnitude(detent_1)) +
                      motor.spring[0] * (1.0 + motor.far_ratio[0]);
    double once = 1.0, thrice = -magnetics.harmonic;
    RealCoefficients::InAngle in_angle = {{}, {}, detent_4, detent_2, detent_1};
    for (int k = 0; k < MotorCoefficients::highest_order; k++) {
        const double next = 1.0 / (k + 1);
        const Phases per_L = Phases{next, next} / magnetics.phase_inductance;
        motor.share[k] = {per_L * -motor.resistance, per_L, in_both_lanes(magnetics.teeth * next)};
        in_angle.once = once * (k % 2 == 0 ? Phases{-1.0, 1.0} : Phases{-1.0, -1.0});
        in_angle.thrice = thrice * (k % 2 == 0 ? Phases{1.0, 1.0} : Phases{1.0, -1.0});
        motor.in_angle[k] = in_angle;
        const double turned = k % 2 == 0 ? next : -next;
        once *= turned;
        thrice *= 3.0 * turned;
        in_angle.detent_4 *= 4.0 * turned;
        in_angle.detent_2 *= 2.0 * turned;
        in_angle.detent_1 *= turned;
    }
    begin_period();
    state_.flux = magnetics.flux(kept_A - state_.iron_A, axes_of(state_.axis));
}

/* As with the motor's parameters: what the magnet's energy changes by came from its heat. */
void RealMotor::set_magnet_rise(double rise_K)
{
    const ImperfectionConfig before = imperfections_;
    const Phases kept_A = current_A();
    imperfections_.magnet_rise_K = rise_K;
    try {
        coefficients_.magnetics = magnetics_of(motor_, imperfections_);
    } catch (...) {
        imperfections_ = before;
        throw;
    }
    state_.flux = coefficients_.magnetics.flux(kept_A - state_.iron_A, axes_of(state_.axis));
    set_parameters(motor_);
}

void RealMotor::set_coulomb_friction(double share)
{
    require_coulomb_friction(share);
    require(share == 0.0 || imperfections_.rated_current_A > 0.0, "coulomb_friction", share,
            "0 without the motor's rated current");
    imperfections_.coulomb_friction = share;
    set_parameters(motor_);
}

/* On a stiff bus the voltage is the source's at once. */
void RealMotor::set_bus(const SupplyConfig &config, double source_V)
{
    coefficients_.supply = supply_of(config, source_V);
    source_ = Decay(coefficients_.supply.source_rate);
    if (coefficients_.supply.stiff()) {
        state_.bus_V = source_V;
    }
}

/* Spring and damper as the inertia is by now. */
void RealMotor::put_stops()
{
    RealCoefficients &motor = coefficients_;
    const double share = motor.belted ? belt_.inertia_share : 1.0;
    motor.struck_kgm2 = motor_.inertia_kgm2 * share;
    const double rate = std::sqrt(stops_.stiffness_Nm_rad / motor.struck_kgm2);
    motor.stop_spring = in_both_lanes(rate * rate);
    motor.stop_damper = in_both_lanes(2.0 * stops_.damping * rate);
}

/* What a new stop that is within what it holds stores came from nowhere: it is not counted. */
void RealMotor::set_stops(const StopConfig &config)
{
    const double before_J = stop_J();
    stops_ = stops_of(config);
    put_stops();
    face_the_nearer_stop();
    stop_reference_J_ += stop_J() - before_J;
    state_.released = false;
}

double RealMotor::struck_rad() const
{
    return theta_rad() + (coefficients_.belted ? state_.twist_rad : 0.0);
}

void RealMotor::face_the_nearer_stop()
{
    const double angle_rad = struck_rad();
    const double side = stops_.nearer(angle_rad);
    coefficients_.stop_side = in_both_lanes(side);
    state_.beyond_rad = stops_.beyond_rad(angle_rad, side);
}

void RealMotor::connect_brake(bool on)
{
    const Supply &supply = coefficients_.supply;
    if (supply.brake_by_drive) {
        state_.braking = on && supply.brake_rate > 0.0;
    }
}

void RealMotor::jam(double torque_Nm)
{
    require(torque_Nm >= 0.0 && torque_Nm <= Plant::held_Nm, "jam_torque_Nm", torque_Nm,
            "0...1e9 N m");
    jam_Nm_ = torque_Nm;
    if (torque_Nm == Plant::held_Nm) {
        integrals_.coulomb_J += rotor_J();
        state_.omega_rad_s = 0.0;
    }
    state_.released = false;
    set_parameters(motor_);
}

/* What the current held in the winding is lost in the arc; that of the magnet stays. */
void RealMotor::open_phase(int phase, bool open)
{
    state_.open[phase] = open;
    if (!open || state_.blocked[phase]) {
        return;
    }
    const double before_J = magnetic_J();
    Phases left_A = current_A();
    left_A[phase] = 0.0;
    state_.flux = coefficients_.magnetics.flux(left_A - state_.iron_A, axes_of(state_.axis));
    state_.blocked[phase] = true;
    integrals_.arc_J += before_J - magnetic_J();
}

void RealMotor::set_load_torque(double load_torque_Nm)
{
    RealCoefficients &motor = coefficients_;
    const Phases load = in_both_lanes(load_torque_Nm * motor.inverse_inertia);
    motor.load = motor.belted ? in_both_lanes(0.0) : load;
    motor.far_load = motor.far_ratio * load;
}

/* Of what strikes a stop, as long as it may be there within the period. */
double RealMotor::rate_of_stop() const
{
    const RealCoefficients &motor = coefficients_;
    const double near_rad = 1e-3; /* and what a period's acceleration adds */
    const double speed = motor.belted ? state_.load_omega_rad_s : state_.omega_rad_s;
    if (motor.stop_side[0] == 0.0 ||
        state_.beyond_rad + near_rad + 2.0 * period_s_ * magnitude(speed) < 0.0) {
        return 0.0;
    }
    /* Twice: all of the speed swings at it, where the winding's share is small. */
    return 2.0 * (std::sqrt(motor.stop_spring[0]) + motor.stop_damper[0]);
}

void RealMotor::begin_period()
{
    const RealCoefficients &motor = coefficients_;
    const Magnetics &magnetics = motor.magnetics;
    wrap(state_.electrical_turns, state_.electrical_rad);
    state_.axis = unit_vector(state_.electrical_rad);
    integrals_.voltage_Vs = Phases{0.0, 0.0};
    filtered_at_begin_V_ = state_.filtered_V;
    flux_at_begin_ = state_.flux;
    if (stops_.present()) {
        face_the_nearer_stop();
    }

    /* Rotation, L/R, the exchange of magnetic with kinetic energy, and with that of the bus. */
    const double most = magnitude(state_.flux[0]) + magnitude(state_.flux[1]);
    const double per_L = (1.0 + 3.0 * magnetics.saturation * most * most) / magnetics.inductance;
    const double stiffness =
        motor.torque[0] * (magnetics.torque * per_L + magnetics.teeth * most) + motor.stiffness;
    const double resistance =
        motor.resistance[0] > motor.resistance[1] ? motor.resistance[0] : motor.resistance[1];
    const double rate = magnetics.teeth * magnitude(state_.omega_rad_s) + resistance * per_L +
                        std::sqrt(stiffness + 2.0 * per_L * motor.supply.per_capacitance) +
                        rate_of_stop();
    rate_ = rate < fastest_rate ? rate : fastest_rate; /* also if not a number */
}

/* What most runs are, and all that is worth compiling twice. */
FOR_EACH_PROCESSOR static void follow_rigid(const real_integrator::Course &course,
                                            const Timetable &timetable, double rate)
{
    real_integrator::follow<false, false>(course, timetable, rate);
}

void RealMotor::advance(const Timetable &timetable)
{
    namespace with = real_integrator;
    const with::Course course = {coefficients_, state_, integrals_, filter_, source_};
    if (coefficients_.belted || stops_.present()) {
        track_energy_ ? with::follow<true, true>(course, timetable, rate_)
                      : with::follow<true, false>(course, timetable, rate_);
    } else if (track_energy_) {
        with::follow<false, true>(course, timetable, rate_);
    } else {
        follow_rigid(course, timetable, rate_);
    }
    if (coefficients_.iron.present) {
        remagnetise();
    }
}

/* At the end of a period, S(k): what its change of flux leaves in the iron. Where no current can
   flow the flux gives way instead; that energy is the iron's, too. */
void RealMotor::remagnetise()
{
    const Magnetics &magnetics = coefficients_.magnetics;
    const Phases change_Vs = magnetics.phase_inductance * (state_.flux - flux_at_begin_);
    integrals_.iron_J += dot(state_.iron_A, change_Vs);
    state_.iron_A = magnetise(state_.iron, coefficients_.iron, change_Vs);
    if (!state_.blocked[0] && !state_.blocked[1]) {
        return;
    }
    const double before_J = magnetic_J();
    const Phases closed = magnetics.flux(-state_.iron_A, axes_of(state_.axis));
    for (int phase = 0; phase < 2; phase++) {
        if (state_.blocked[phase]) {
            state_.flux[phase] = closed[phase];
        }
    }
    integrals_.iron_J += before_J - magnetic_J();
}

Phases RealMotor::current_A() const
{
    const Phases current_A =
        coefficients_.magnetics.current_A(state_.flux, axes_of(state_.axis)) + state_.iron_A;
    return Phases{state_.blocked[0] ? 0.0 : current_A[0], state_.blocked[1] ? 0.0 : current_A[1]};
}

/* The filter's own equation, integrated: u - tf dv/dt. */
Phases RealMotor::filtered_Vs() const
{
    if (coefficients_.filter_rate == 0.0) {
        return integrals_.voltage_Vs;
    }
    return integrals_.voltage_Vs -
           (state_.filtered_V - filtered_at_begin_V_) / coefficients_.filter_rate;
}

double RealMotor::theta_rad() const
{
    return (state_.electrical_turns * (2.0 * pi) + state_.electrical_rad) /
           coefficients_.magnetics.teeth;
}

double RealMotor::torque_Nm() const
{
    return coefficients_.magnetics.torque_Nm(state_.flux, axes_of(state_.axis));
}

double RealMotor::magnetic_J() const
{
    return coefficients_.magnetics.energy_J(state_.flux, axes_of(state_.axis));
}

double RealMotor::rotor_J() const
{
    return 0.5 * state_.omega_rad_s * state_.omega_rad_s / coefficients_.inverse_inertia;
}

double RealMotor::kinetic_J() const
{
    const double far_kgm2 = motor_.inertia_kgm2 * belt_.inertia_share;
    return rotor_J() + 0.5 * far_kgm2 * state_.load_omega_rad_s * state_.load_omega_rad_s;
}

double RealMotor::spring_J() const
{
    return 0.5 * belt_.spring_Nm_rad * state_.twist_rad * state_.twist_rad;
}

double RealMotor::stop_J() const
{
    const double entered_rad = state_.beyond_rad > 0.0 ? state_.beyond_rad : 0.0;
    return 0.5 * stops_.stiffness_Nm_rad * entered_rad * entered_rad;
}

double RealMotor::stop_loss_J() const
{
    return integrals_.stop_J - (stop_J() - stop_reference_J_);
}

double RealMotor::capacitor_J() const
{
    return 0.5 * coefficients_.supply.capacitance_F * state_.bus_V * state_.bus_V;
}

} // namespace plant
