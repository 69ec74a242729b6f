/*
 * Cyclic synchronous position: the target that comes in each interval of 60c2h, by PDO as a rule,
 * is a set-point of the drive (motion/set_points.h), which passes them by its own clock.
 *
 * On reception: a target is passed three intervals and 1.3 ms after it came. Of up to three that do
 * not come, the motion's going on takes the place; then it comes to rest, and goes to the last one.
 *
 * With SYNC, the clock is the SYNC count: each SYNC is one interval, whether it brought a target or
 * not. Of its arrival an error of more than a quarter of an interval alone, which is a drift or
 * lost frames, moves the phase of the set-points among the targets, by at most 1/64 of an interval
 * in each: between targets the parabola through the last three is passed. A target is passed four
 * intervals and 1.3 ms behind its SYNC. One that is missing, or its SYNC, for up to one and a half
 * intervals beyond, is predicted from the last two, up to three in a row; then as above.
 *
 * What asks for more than the drive's speed or acceleration is followed as closely as those allow:
 * what is behind its target comes up to it with half of the acceleration, as one that can stop
 * there, and stops at a software limit, but for a thirtieth of acceleration x interval^2, by which
 * the curve through set-points swings.
 */
#ifndef STEADYSTEP_AXIS_STREAM_H
#define STEADYSTEP_AXIS_STREAM_H

#include <stdbool.h>
#include <stdint.h>

struct axis_stream {
    double last_rad, before_rad; /* the last two set-points */
    double asked_rad;            /* what the last one was to be */

    uint32_t due; /* period in which the next one should come */
    uint8_t owed; /* targets whose places were taken, or SYNCs without one, in a row */
    bool stays;   /* the last three set-points are the same */
    bool at_sync; /* SYNC is here: what comes now comes with it */
    bool by_sync; /* the last target did */
    bool refused; /* set-points are, by their interval */

    /* with SYNC */
    double target_rad, target_before_rad; /* the latest one, or as foreseen, and the one before */
    float step_rad, step_before_rad;      /* between them, and before */
    float ahead; /* of the latest target, intervals: where the next set-point stands */
};

struct application;

/* A target has come. */
void axis_stream_take(struct application *application);

/* SYNC has come: before what has waited for it, behind which `at_sync` ends. */
void axis_stream_sync(struct application *application);

/* Whether each target has come. */
bool axis_stream_follows(const struct axis_stream *stream);

/* Background: takes the place of one that is late. */
void axis_stream_background(struct application *application);

#endif
