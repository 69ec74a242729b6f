/*
 * Two-phase hybrid stepper with its load, integrated from switching edge to switching edge.
 *
 *   L di/dt = u - R i - Km w q         i, u: (phase a, phase b)
 *   J dw/dt = Km (i . q) - Kv w - T_L  q = (-sin N theta, cos N theta): the rotor's q axis
 *   dq/dt   = N w (q turned by a quarter)
 *   d theta/dt = w
 *
 * Every right-hand side is a polynomial in the unknowns, so the Taylor coefficients of a solution
 * follow from one another by Cauchy products (Moore 1966, "Interval Analysis", ch. 11): no stages
 * and no trigonometric function inside a period, and the currents of a segment are polynomials,
 * whose zeros are the instants at which diodes stop conducting.
 */
#ifndef STEADYSTEP_PLANT_MOTOR_H
#define STEADYSTEP_PLANT_MOTOR_H

#include "sil/plant/bridge.h"
#include "sil/plant/phases.h"
#include "sil/plant/plant.h"

namespace plant
{

/* Throw std::invalid_argument. */
void require_motor(const MotorConfig &config);
void require_motion(double theta_rad, double omega_rad_s);

/* Whole turns out of an electrical angle, which stays in -pi...pi. */
void wrap(double &electrical_turns, double &electrical_rad);

struct MotorState {
    Phases current_A = {0.0, 0.0};
    Phases q_axis = {0.0, 1.0};
    double omega_rad_s = 0.0;
    double electrical_turns = 0.0; /* N theta: whole turns, so that a long way costs no accuracy, */
    double electrical_rad = 0.0;   /* and the rest, -pi...pi at begin_period */
};

/* MotorConfig as the equations want it. */
struct MotorCoefficients {
    double resistance, torque_constant, friction; /* R, Km, Kv */
    double inverse_inductance, inverse_inertia;   /* 1/L, 1/J */
    double teeth, load_torque;                    /* N, T_L */
    Phases deceleration;                          /* T_L/J, in both lanes as all that follows */

    /* -R/L, -Km/L, N (-1, 1), Km/J and -Kv/J over k + 1: from Taylor coefficient k to k + 1. */
    static constexpr int highest_order = 5;
    struct Share {
        Phases resistance, emf, quarter_turn, torque, friction;
    } share[highest_order];
};

/* Integrals over time; the energies only if asked for. */
struct MotorIntegrals {
    Phases voltage_Vs = {0.0, 0.0}; /* since begin_period */
    double supplied_J = 0.0, diode_J = 0.0, copper_J = 0.0, friction_J = 0.0, load_J = 0.0;
    /* Of a real motor, its supply and its belt. */
    double arc_J = 0.0, coulomb_J = 0.0, source_J = 0.0, brake_J = 0.0;
    double iron_J = 0.0, damping_J = 0.0;
    double stop_J = 0.0; /* work done on stops */
};

class Motor
{
  public:
    /* Throws std::invalid_argument. */
    Motor(const MotorConfig &config, double theta_rad, double omega_rad_s, bool track_energy);

    void set_parameters(const MotorConfig &config); /* currents, angle and speed go on */
    void set_load_torque(double load_torque_Nm);

    /* Wraps the angle, renews the rotor's axes from it and chooses the greatest step. */
    void begin_period();
    void advance(const Timetable &timetable);

    const MotorState &state() const
    {
        return state_;
    }
    const MotorIntegrals &integrals() const
    {
        return integrals_;
    }
    Phases filtered_Vs() const /* as of a RealMotor: here there is no filter */
    {
        return integrals_.voltage_Vs;
    }
    Phases current_A() const
    {
        return state_.current_A;
    }
    double omega_rad_s() const
    {
        return state_.omega_rad_s;
    }
    double theta_rad() const;
    double torque_Nm() const;
    double magnetic_J() const;
    double kinetic_J() const;

  private:
    MotorCoefficients coefficients_ = {};
    MotorState state_;
    MotorIntegrals integrals_;
    bool track_energy_;
    double rate_ = 0.0; /* 1/s: how fast the solution can change, bounds the step */
};

} // namespace plant

#endif
