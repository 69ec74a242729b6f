/*
 * A sine as reference: x = centre + A e(t) sin(w t), faded in and out by e = 10 s^3 - 15 s^4 + 6
 * s^5 over a ramp, so that position, speed, acceleration and jerk begin and end at zero. Without a
 * ramp it begins and ends at full speed A w, where the acceleration is zero.
 *
 * Between knots, at which position, speed and acceleration are those of the sine, the jerk is
 * constant in three parts (motion_plan.h).
 *
 * Runs in the background, in double precision.
 */
#ifndef STEADYSTEP_SINE_H
#define STEADYSTEP_SINE_H

#include "firmware/motion/motion_plan.h"

/* A sine as it is commanded; times are rounded to whole control periods. */
struct sine_task {
    double amplitude_turns; /* electrical */
    double frequency_Hz;
    double cycles; /* whole or half ones; 0: until it is stopped */
    double ramp_s; /* at each end; at most half of the cycles */
    double period_s;
};

struct sine {
    double amplitude;      /* electrical turns */
    double omega;          /* rad per period */
    uint64_t phase_step;   /* 2^-64 cycle per period */
    uint64_t periods;      /* of all cycles; 0: for ever */
    uint64_t elapsed;      /* periods planned so far */
    uint32_t ramp_periods; /* 0: none */
    uint32_t knot_periods; /* from knot to knot */
    struct position centre;
};

struct sine sine_design(const struct sine_task *task);

/* Largest speed, acceleration and jerk, electrical turns per period^n; the ramps included. */
struct motion_limits sine_peaks(const struct sine *sine);

/* From the centre, `time` periods after the begin. */
struct motion_target sine_at(const struct sine *sine, uint64_t time);

/* Appends the next knots; false: the sine has ended with them, at its centre. */
bool sine_continue(struct sine *sine, struct motion_plan *plan, struct motion_state *end);

#endif
