/*
 * A rotor that swings on and on with what it drives, in the background of a sensorless drive.
 *
 * On a belt part of the inertia is behind a spring. What the law takes for J is but the rotor's
 * share at the frequency with which both swing, so its gain is too high there, and the lag of the
 * current makes of it a torque along the speed: from some 160 Hz on with half of J on the belt and
 * 1500 rad/s of current bandwidth. The sign: the speed's error turns, by more than h, twelve times
 * on end, each 1.4 to 4 ms behind the one before,
 *
 *   h = 2 x 0.05 x 1250 / N rad/s: 3 degrees electrical to each side
 *
 * Then the current loop gets the bandwidth that the period bears, until the drive is designed anew:
 * noise moves the voltage twice as much, and the rotor rests. A bandwidth that is given stays.
 */
#ifndef STEADYSTEP_BELT_WATCH_H
#define STEADYSTEP_BELT_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/interface/drive_interface.h"
#include "firmware/numeric/num.h"

/* An image that has no room for it keeps its current loop as it is. */
#ifdef STEADYSTEP_WITHOUT_BELT_WATCH
enum { WATCHES_BELT = 0 };
#else
enum { WATCHES_BELT = 1 };
#endif

struct belt_watch {
    uint32_t turned;  /* period in which the error did last */
    num_t extreme;    /* speed since */
    num_t swing;      /* h */
    uint16_t soonest; /* periods from turn to turn */
    uint16_t latest;
    uint8_t swings; /* on end */
    bool falls;
    bool watches;
    bool seen; /* a belt that swings */
};

struct drive;

/* Of a drive whose settings follow from these, `given`. */
__attribute__((cold)) void belt_watch_design(struct drive *drive,
                                             const struct drive_settings *given);

/* Whether the error has turned often enough. */
bool belt_watch_swings(struct belt_watch *watch, num_t error, uint32_t period);

/* Background: looks at a drive in operation, at each call. */
void belt_watch_background(struct drive *drive);

#endif
