/*
 * Homing on a switch, methods 17 to 30 of CiA 402: 607ch is where the home switch changes, or a
 * limit switch (17, 18). The axis looks for the switch with 6099h, 1, in the direction of the
 * method; where a limit switch comes first it turns, once. Then it crosses the edge that the method
 * means, with 6099h, 2, always in the same direction, and rests behind it.
 *
 * The place is where the rotor was at the last look, of 1 ms, that found the switch as it was
 * before: at most what the axis goes in 1 ms before the edge.
 *
 * | method | looks | crosses | where the switch is |
 * | 17, 18 | down, up | up, down | left: of the limit switch |
 * | 19, 23 / 21, 27 | up / down | down / up | left, at its end where it was looked for from |
 * | 20, 24 / 22, 28 | up / down | up / down | entered, at that end |
 * | 25 / 29 | up / down | down / up | entered, at its far end |
 * | 26 / 30 | up / down | up / down | left, at its far end |
 *
 * A limit switch on the way that is not looked for ends the homing with an error, so does the
 * travel 2403h, 2, in one direction without the switch.
 */
#ifndef STEADYSTEP_AXIS_HOMING_SWITCH_H
#define STEADYSTEP_AXIS_HOMING_SWITCH_H

#include <stdbool.h>
#include <stdint.h>

struct application;

enum { AXIS_HOMING_SWITCH_FIRST = 17, AXIS_HOMING_SWITCH_LAST = 30 };

/* Begins a method of these. false: its switch is not wired (inputs_used), nothing moves. */
bool axis_homing_switch_start(struct application *application, int8_t method);

/* Background, once in a millisecond, while it is under way. */
void axis_homing_switch_look(struct application *application);

#endif
