/*
 * Homing on a hard stop. The axis goes that way until a stop bears it, backs off and comes again.
 * Where two approaches find the stop, to within 0.15 of a full step, and none elsewhere between
 * them, is 607ch: half way between them. The rotor comes to rest a full step before it.
 *
 * A stop is where the rotor ceases to follow. From an electrical turn of the reference on, within
 * which a rotor gets under way, all of these have to show:
 * - the estimated load against the motion is beyond the torque 2403h, 1;
 * - it has been above three quarters of that at two looks in a row, 1 ms apart;
 * - since then the reference has gone on by a quarter of a full step, the rotor by less than half
 * as much;
 * - as that began, the synchronism was not in doubt;
 * - without an encoder the rotor has come half an electrical turn: one that stands where it was to
 *   start is at no stop, or was there before.
 * The place is the furthest that the rotor has come before the load grew: pressed against a stop it
 * induces nothing, and its estimate drifts.
 *
 * A stop that is struck throws the rotor back. The estimate may lose it, or say that it goes on by
 * a quarter of a full step under three quarters of the torque. That is no fault here, the approach
 * has failed. Whatever it has come to, the rotor is caught (drive/state_machine.h), led back by a
 * hold to a full step of the motor, where no detent torque draws it aside, and sent once more in
 * the hold that has settled: some electrical turns beside its first course, perhaps, which is of no
 * account, and at another speed: 6099h, 2, half of it or half as much again, but always well above
 * the creep in which a hold leads it. After eight such approaches there is a homing error: what
 * gives way is softer than a quarter of the torque over a quarter of a full step, or the load is
 * heavier than the torque. So there is when the reference has gone the travel 2403h, 2.
 *
 * With an encoder nothing is lost. One approach shows the stop, where the load began to grow, or
 * that there is none.
 */
#ifndef STEADYSTEP_AXIS_HOMING_STOP_H
#define STEADYSTEP_AXIS_HOMING_STOP_H

#include <stdbool.h>

struct application;
struct drive_settings;

/* Whether law and observer show a stop. */
bool axis_homing_stop_shows(const struct drive_settings *settings);

/* Background, once in a millisecond. */
void axis_homing_stop_look(struct application *application);

#endif
