/*
 * Cyclic synchronous torque, of a drive with an encoder: the target torque that comes, by PDO as a
 * rule, on reception or with SYNC, is the drive's from the next pass of the background on, in one
 * step, within 6072h and up to the speed 6080h (drive/torque_mode.h). A torque that pushes towards
 * a software limit from nearer than it takes to stop with 6085h ends so, and the rotor is held
 * there until the target points away.
 */
#ifndef STEADYSTEP_AXIS_TORQUE_H
#define STEADYSTEP_AXIS_TORQUE_H

#include <stdbool.h>

#define AXIS_RAD_S_PER_RPM 0.10471976f /* 6080h is in turns per minute */

struct application;

/* Whether the drive has the mode: its feedback is an encoder. */
bool axis_torque_is_carried(const struct application *application);

/* Background, all the time, in the mode. */
void axis_torque_background(struct application *application);

#endif
