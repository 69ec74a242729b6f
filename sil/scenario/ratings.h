/*
 * What a motor can do, and how the random scenarios of the reference motor become those of another:
 * loads are the same share of the rated torque, speeds of the rated speed, accelerations at most
 * the same share of the rated acceleration, and no ramp gets shorter, because what a drive can do
 * in a millisecond depends on its control period more than on its motor.
 */
#ifndef STEADYSTEP_SCENARIO_RATINGS_H
#define STEADYSTEP_SCENARIO_RATINGS_H

#include "firmware/motor/motor_params.h"

namespace scenario
{

struct Ratings {
    double torque_Nm;           /* torque constant x rated current */
    double speed_rad_s;         /* at which the supply still drives the rated current; 0: none */
    double acceleration_rad_s2; /* of the unloaded rotor by the rated torque */
    double current_A;
    double supply_V;
    double full_step_rad;
};

Ratings ratings_of(const motor_params &motor);

/* Factors from the reference motor's numbers to another motor's; exactly 1 for itself. */
struct RatingScales {
    double torque = 1, speed = 1, acceleration = 1, current = 1, supply = 1, angle = 1;
};

RatingScales scales_of(const Ratings &motor, const Ratings &reference);

} // namespace scenario

#endif
