/*
 * A part s of the inertia J behind a spring c and a damper d, a belt or a coupling:
 *
 *   (1 - s) J dw/dt = torque - ... + c delta + d (w_L - w)
 *         s J dw_L/dt = - c delta - d (w_L - w) - T_L
 *        d delta/dt = w_L - w
 *
 * The two masses swing against one another at 2 pi f = sqrt(c (1 / J_motor + 1 / J_load)), damped
 * by d = 2 zeta 2 pi f / (1 / J_motor + 1 / J_load); against a rotor that is held the load swings
 * at sqrt(1 - s) of f. Spring and damper are found from the inertia as it is at first, and stay.
 */
#ifndef STEADYSTEP_PLANT_BELT_H
#define STEADYSTEP_PLANT_BELT_H

#include "sil/plant/plant.h"

namespace plant
{

struct Belt {
    double inertia_share = 0.0;
    double spring_Nm_rad = 0.0, damper_Nms_rad = 0.0;

    bool present() const
    {
        return inertia_share > 0.0;
    }
};

/* Throws std::invalid_argument. */
Belt belt_of(const BeltConfig &config, double inertia_kgm2);

} // namespace plant

#endif
