/*
 * A rotor that swings on and on with what it drives, in the background of a sensorless drive.
 *
 * On a belt part of the inertia is behind a spring. What the law takes for J is but the rotor's
 * share at the frequency with which both swing, so its gain is too high there, and the lag of the
 * current makes of it a torque along the speed: from some 160 Hz on with half of J on the belt and
 * 1500 rad/s of current bandwidth. The sign: what is watched turns, by more than h, twelve times
 * on end, each 1 to 4 ms behind the one before. Watched is
 *
 *   1. the speed's error, h = 2 x 0.05 x 1250 / N rad/s, which is 3 degrees electrical to each
 *      side at 1250 rad/s. Then the current loop gets the bandwidth that the period bears: noise
 *      moves the voltage twice as much, and as a rule the rotor rests.
 *   2. the q current demanded, h = half of current_limit_A: the law drives what it is to damp, and
 *      the torque left is too little to follow anything. Then the law gets half of its bandwidth,
 *      as if half of J were behind the spring, and once more half of it. Not in a hold, which has
 *      a damping of its own. A detent torque turns the speed as often, but not the current so far.
 *
 * Both bandwidths in force are shown as such, until the drive is designed anew. One that is given
 * stays.
 */
#ifndef STEADYSTEP_BELT_WATCH_H
#define STEADYSTEP_BELT_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/interface/drive_interface.h"
#include "firmware/interface/parts_carried.h"
#include "firmware/numeric/num.h"

struct belt_watch {
    uint32_t turned;        /* period in which what is watched did last */
    num_t extreme;          /* of it since */
    num_t swing;            /* h */
    uint16_t latest;        /* periods from turn to turn, a quarter of them at least */
    uint8_t swings;         /* on end */
    uint8_t narrowings : 2; /* of the law that are left */
    bool falls : 1;
    bool widened : 1; /* the current loop is as wide as it may be: the current is watched */
    bool watches : 1;
};

struct drive;

/* Of a drive whose settings follow from these. */
__attribute__((cold)) void belt_watch_design(struct drive *drive,
                                             const struct drive_settings *settings);

/* Whether `value` has turned often enough. */
bool belt_watch_swings(struct belt_watch *watch, num_t value, uint32_t period);

/* Background: looks at a drive in operation, at each call. */
void belt_watch_background(struct drive *drive);

#endif
