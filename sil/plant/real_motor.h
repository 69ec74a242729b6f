/*
 * A motor with saturation, flux harmonic, detent and Coulomb friction (magnetics.h), the bridge's
 * resistance, and the bus (supply.h), integrated from switching edge to switching edge.
 *
 *   L0 dx/dt = u - (R + R_bridge) i           x: flux linkage / L0 of the phases (a, b); R and L0
 *                                             are of each phase
 *   J dw/dt  = torque(x, N theta) - Kv w - T_L - Tc sign(w)
 *   d theta/dt = w
 *   C dV/dt  = source and brake - share . i   u = share V -+ diode drops
 *
 * At rest the rotor sticks until the other torques exceed Tc, which a jam adds to. The current of a
 * phase with a broken lead is 0 and its voltage, which is measured at the bridge, that of the legs.
 * The measured voltage passes a filter, tf dv/dt = u - v. The iron adds to the current (iron.h),
 * part of J may stand behind a belt, with T_L (belt.h), and what stands there, or the rotor,
 * between stops (stops.h).
 * Taylor series in time as for the
 * plain motor (motor.h); what depends on the rotor angle is a Taylor series in the angle turned,
 * and so the sum of its powers.
 */
#ifndef STEADYSTEP_PLANT_REAL_MOTOR_H
#define STEADYSTEP_PLANT_REAL_MOTOR_H

#include "sil/plant/belt.h"
#include "sil/plant/bridge.h"
#include "sil/plant/elementary.h"
#include "sil/plant/iron.h"
#include "sil/plant/magnetics.h"
#include "sil/plant/motor.h"
#include "sil/plant/phases.h"
#include "sil/plant/plant.h"
#include "sil/plant/stops.h"
#include "sil/plant/supply.h"

namespace plant
{

struct RealMotorState {
    Phases flux = {0.0, 0.0}; /* x, A */
    Phases axis = {1.0, 0.0}; /* (cos, sin) of N theta */
    double omega_rad_s = 0.0;
    double electrical_turns = 0.0; /* N theta: whole turns and the rest, as in MotorState */
    double electrical_rad = 0.0;
    double bus_V = 0.0;
    bool blocked[2] = {true, true}; /* diodes hold the phase's current at 0 */
    bool braking = false;           /* the brake resistor is connected */
    bool released = false;          /* friction has just ceased to hold the rotor, to rounding */
    bool open[2] = {false, false};  /* a lead of the phase is broken */
    Phases filtered_V = {0.0, 0.0}; /* phase voltages behind the filter */
    Phases iron_A = {0.0, 0.0};     /* the iron's part of the currents, within this period */
    IronState iron;
    double load_omega_rad_s = 0.0; /* behind the belt, */
    double twist_rad = 0.0;        /* by which it is ahead of the rotor */
    double beyond_rad = 0.0;       /* the nearer stop; below 0: the way to it */
};

/* Configuration as the equations want it: torques over inertia, rad/s^2. */
struct RealCoefficients {
    Magnetics magnetics;
    Supply supply;
    Phases resistance = {0.0, 0.0};
    double diode_drop = 0.0;
    double inverse_inertia = 0.0; /* of what turns with the rotor */
    double coulomb = 0.0;         /* Tc over J */
    Phases torque = {0.0, 0.0}, friction = {0.0, 0.0}, load = {0.0, 0.0}; /* Kx, Kv and T_L over J,
                                                                              in both lanes */
    double stiffness = 0.0;   /* of the detent, 1/s^2: the greatest slope over J */
    double filter_rate = 0.0; /* 1 / tf, 1/s; 0: no filter */
    Iron iron;

    /* Spring and damper over J, and J over the inertia behind them; both lanes. */
    bool belted = false;
    Phases spring = {0.0, 0.0}, damper = {0.0, 0.0}, far_ratio = {0.0, 0.0};
    Phases far_load = {0.0, 0.0}; /* T_L over the inertia behind the belt; load is 0 then */

    /* Of the nearer stop, over the inertia that strikes it; both lanes. Its side: 1 the high one,
       -1 the low one, 0: there is none. */
    Phases stop_spring = {0.0, 0.0}, stop_damper = {0.0, 0.0}, stop_side = {0.0, 0.0};
    double struck_kgm2 = 0.0;

    /* -R/L0, 1/L0 and N over k + 1: from Taylor coefficient k to k + 1. */
    struct Share {
        Phases resistance, voltage, teeth;
    } share[MotorCoefficients::highest_order];

    /* Taylor coefficient j in N theta: 1, -h 3^j, D4 4^j, Td2 2^j and Td1 over j!, with the signs
       + + - - + of the derivatives of a sine; once and thrice with those of the two phases. */
    struct InAngle {
        Phases once, thrice;
        double detent_4, detent_2, detent_1;
    } in_angle[MotorCoefficients::highest_order];
};

class RealMotor
{
  public:
    /* Throws std::invalid_argument. */
    RealMotor(const Config &config);
    /* Goes on where a motor of the same parameters is; the bus is config's. */
    RealMotor(const Config &config, const Motor &motor, double load_torque_Nm);

    void set_parameters(const MotorConfig &config); /* currents, angle and speed go on */
    void set_load_torque(double load_torque_Nm);
    void set_coulomb_friction(double share);
    void set_magnet_rise(double rise_K);
    void set_bus(const SupplyConfig &config, double source_V);
    void connect_brake(bool on); /* of SupplyConfig::brake_by_drive; else nothing */
    void set_stops(const StopConfig &config);
    void jam(double torque_Nm);
    void open_phase(int phase, bool open);

    void begin_period();
    /* A timetable of a bus of 1 V with diodes of 1 V: voltages scale with the bus as it is. */
    void advance(const Timetable &timetable);

    const MotorIntegrals &integrals() const
    {
        return integrals_;
    }
    Phases current_A() const;
    double omega_rad_s() const
    {
        return state_.omega_rad_s;
    }
    /* Integral of the phase voltages behind the filter, since begin_period. */
    Phases filtered_Vs() const;
    double theta_rad() const;
    double torque_Nm() const; /* of the magnetic circuit, detent included */
    double bus_V() const
    {
        return state_.bus_V;
    }
    double magnetic_J() const;
    double kinetic_J() const; /* the belt's load included */
    double capacitor_J() const;
    double spring_J() const;
    double stop_J() const; /* stored in a stop */
    double stop_loss_J() const;

  private:
    double rotor_J() const;
    void remagnetise();
    void put_stops();
    void face_the_nearer_stop();
    double rate_of_stop() const;
    double struck_rad() const; /* angle of what strikes the stops */

    ImperfectionConfig imperfections_;
    MotorConfig motor_;
    RealCoefficients coefficients_;
    RealMotorState state_;
    MotorIntegrals integrals_;
    Belt belt_;
    Stops stops_;
    double stop_reference_J_ = 0.0; /* what was stored when stops came */
    double period_s_;
    Phases flux_at_begin_ = {0.0, 0.0};
    Decay filter_, source_; /* of the voltage filter, and of the bus towards its source */
    bool track_energy_;
    double rate_ = 0.0; /* 1/s: how fast the solution can change, bounds the step */
    double jam_Nm_ = 0.0;
    Phases filtered_at_begin_V_ = {0.0, 0.0};
};

} // namespace plant

#endif
