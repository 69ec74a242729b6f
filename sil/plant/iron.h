/*
 * What the iron adds to the current of a phase. With its flux linkage lambda, the magnet's
 * included:
 *
 *   i += I_h h + e
 *   dh/dt = (dlambda/dt - |dlambda/dt| h) / lambda_0       hysteresis: h goes to the sign
 *   tau de/dt = (dlambda/dt) / R_fe - e                    eddy currents, behind their lag
 *
 * h is -1...1. Neither is in the energy of the magnetic circuit: the loss is (I_h h + e) dlambda,
 * and what a turned rotor pays of it is the drag: torque follows from the flux, and a flux that the
 * iron holds back pulls the rotor back, (4 / pi) N I_h (L - lambda_0 tanh(L / lambda_0)) in the
 * mean of a turn without current, L being the magnet's flux linkage.
 *
 * Both are renewed at S(k) by the flux linkage that the period has changed, and stay within it. So
 * the ripple of the switching, whose loops of iron are small and closed, does not wipe out what the
 * iron remembers, as it would of an equation without inner loops.
 */
#ifndef STEADYSTEP_PLANT_IRON_H
#define STEADYSTEP_PLANT_IRON_H

#include "sil/plant/phases.h"
#include "sil/plant/plant.h"

namespace plant
{

struct Magnetics;

/* A configuration as the equations want it. */
struct Iron {
    double coercive_A = 0.0;           /* I_h */
    double per_flux = 0.0;             /* 1 / lambda_0, 1/(V s) */
    Phases eddy_A_per_Vs = {0.0, 0.0}; /* 1 / (R_fe T) */
    double eddy_left = 0.0;            /* of e, a period later */
    bool present = false;
};

struct IronState {
    Phases magnetised = {0.0, 0.0}; /* h */
    Phases eddy_A = {0.0, 0.0};     /* e */
};

/* Throws std::invalid_argument. */
Iron iron_of(const MotorConfig &motor, const ImperfectionConfig &imperfections,
             const Magnetics &magnetics, double period_s);

/* The iron's current in the phases behind a period that has changed the flux linkage so. */
Phases magnetise(IronState &state, const Iron &iron, Phases change_Vs);

} // namespace plant

#endif
