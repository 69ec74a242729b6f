/*
 * Hard stops of the machine, at an angle below and one above: of the load behind a belt, if there
 * is one, else of the rotor. What is beyond one by p is pushed back by a spring and a damper that
 * cannot pull:
 *
 *   J dw/dt = ... -+ max(k p + d dp/dt, 0) where p > 0          d = 2 zeta sqrt(k J)
 *
 * J is the inertia that strikes the stop. Where it leaves quicker than the damper lets go, what the
 * spring still held is lost.
 */
#ifndef STEADYSTEP_PLANT_STOPS_H
#define STEADYSTEP_PLANT_STOPS_H

#include "sil/plant/plant.h"

namespace plant
{

struct Stops {
    double low_rad, high_rad; /* infinite: none */
    double stiffness_Nm_rad, damping;

    bool present() const;
    /* 1: that above, -1: that below; 0: there is none. */
    double nearer(double angle_rad) const;
    /* By how much an angle is beyond it; negative: the way to it. */
    double beyond_rad(double angle_rad, double side) const;
};

/* Throws std::invalid_argument. */
Stops stops_of(const StopConfig &config);

} // namespace plant

#endif
