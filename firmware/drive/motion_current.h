/*
 * The d current in motion, over the reference's speed. It is of use where the rotor is hardly seen,
 * and takes voltage where the motor has none left: there is all of it up to an eighth of the speed
 * without load, V / Km, and none from a quarter on.
 *
 * None either while it is homed on a hard stop: it draws the rotor to an estimate that is wrong by
 * up to a quarter turn, too, where that stands as at a stop, with the torque of one.
 *
 * In the background. The interrupt reads one word of it, to which i_d* ramps.
 */
#ifndef STEADYSTEP_MOTION_CURRENT_H
#define STEADYSTEP_MOTION_CURRENT_H

#include "firmware/numeric/num.h"

struct drive;

/* Of `all`, at a speed in per-unit. */
num_t motion_current_at(num_t all, num_t speed);

/* Background. */
void motion_current_background(struct drive *drive);

#endif
