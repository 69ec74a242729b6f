/*
 * Cyclic synchronous position: the target that comes in each interval, by PDO as a rule, is a
 * set-point of the drive (motion/set_points.h), passed three intervals and 1.3 ms after it came. Of
 * up to three that do not come, the motion's going on takes the place; then it comes to rest. What
 * asks for more than the drive's speed or acceleration is followed as closely as those allow.
 */
#ifndef STEADYSTEP_AXIS_STREAM_H
#define STEADYSTEP_AXIS_STREAM_H

#include <stdbool.h>
#include <stdint.h>

struct axis_stream {
    double last_rad, before_rad; /* the last two set-points */
    uint32_t fed_us;             /* when the last target came, or should have */
    uint8_t owed;                /* targets whose places were taken, one behind the other */
    bool stays;                  /* the last three set-points are the same */
};

struct application;

/* A target has come. */
void axis_stream_take(struct application *application);

/* Background: takes the place of one that is late. */
void axis_stream_background(struct application *application);

#endif
