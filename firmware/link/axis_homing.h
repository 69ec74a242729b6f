/*
 * Homing, mode 6. Methods 35 and 37: the axis is at 607ch where it stands. Methods 33 and 34: it
 * goes down, or up, until the encoder's index passes. There is 607ch, and the rotor comes to rest
 * there. The place is one edge of the index, whichever the direction: the one that rises upwards
 * and falls downwards, at the count that hardware has kept. It is looked for from a full step on,
 * and for 9/8 of a turn in all; then there is none, a homing error. Methods -1 and -2: it goes
 * down, or up, until a hard stop bears it. There is 607ch, and the rotor comes to rest a full step
 * before it, where the hold draws it even if the stop has thrown it off.
 *
 * A stop is where the rotor ceases to follow. All of these have to show:
 * - the estimated load against the motion is beyond the torque 2403h, 1;
 * - it has been above three quarters of that at two looks in a row, 1 ms apart;
 * - since then the reference has gone on by a quarter of a full step, the rotor by less than half
 * as much.
 *
 * A rotor that goes on by a quarter of a full step under three quarters of the torque is not at a
 * stop: what gives way is softer than a quarter of the torque over a quarter of a full step, or the
 * load is heavier than the torque. That, a rotor out of step before anything bears
 * it or at the end, and a reference that has gone the travel 2403h, 2, end in a homing error.
 */
#ifndef STEADYSTEP_AXIS_HOMING_H
#define STEADYSTEP_AXIS_HOMING_H

#include <stdbool.h>
#include <stdint.h>

struct application;

enum homing_phase {
    HOMING_ENDED,        /* or not begun */
    HOMING_SEARCHES,     /* a stop */
    HOMING_SETS_OUT,     /* for the index */
    HOMING_AWAITS_INDEX, /* to pass */
    HOMING_LEAVES        /* for a stop's or the index's place, or gives up */
};

struct axis_homing {
    double began_rad;               /* of the reference, in the search */
    double bears_rad, at_bears_rad; /* rotor and reference as the load grew: the stop; the index */
    float way;                      /* 1 up, -1 down, of the motor */
    uint8_t phase;                  /* enum homing_phase */
    uint8_t ms;                     /* for which it stands */
    bool found;
};

/* Whether 6098h may have this value. */
bool axis_homing_is_method(int8_t method);

/* Begins by 6098h. */
void axis_homing_start(struct application *application);

/* Background, once in a millisecond, in the mode. */
void axis_homing_look(struct application *application);

#endif
