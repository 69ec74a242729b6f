/*
 * A plan: motion as a sequence of segments of constant jerk, which the reference executes by the
 * additions it uses for the phases of a profile (reference.h). Sine, set-points, speed changes and
 * new targets in mid-move are plans.
 *
 *   over n periods:  a += n j,   v += n a + n^2 j/2,   x += n v + n^2 a/2 + n^3 j/6
 *
 * All in integers of 2^-64 electrical turn per period^n: a even, j a multiple of 6, so that the
 * closed form above is the sum of the additions, bit for bit. What is planned here is therefore
 * exactly what the interrupt reaches, and plan after plan begins where the one before is.
 *
 * A plan begins from any speed and acceleration and ends at rest, or goes on at constant speed for
 * ever. Where more is to come, `continues_after` says behind which segment it begins; the segments
 * after it bring the reference to rest if it does not come in time.
 *
 * Runs in the background, in double precision.
 */
#ifndef STEADYSTEP_MOTION_PLAN_H
#define STEADYSTEP_MOTION_PLAN_H

#include <stdbool.h>

#include "firmware/numeric/angle.h"

#define PLAN_SEGMENTS 15u

/* Where the reference is at a sampling instant: 2^-64 electrical turn per period^n. */
struct motion_state {
    int32_t turns;
    uint64_t fraction;
    int64_t speed;
    int64_t acceleration; /* even */
};

struct motion_segment {
    uint32_t periods;     /* at least one */
    int64_t acceleration; /* at its begin */
    int64_t jerk_sixth;
};

struct motion_plan {
    struct motion_state from; /* where it preempts: one period before it begins */
    uint32_t epoch;           /* of the reference it was made for */
    int64_t speed_jump;       /* at its begin; 0 but for a sine without a ramp, and what rounding
                                 leaves of a target, far below 2^-32 turn in a period */
    uint32_t segments;
    uint32_t
        continues_after; /* segments before the continuation; PLAN_SEGMENTS + 1: there is none */
    bool endless;        /* the last segment goes on for ever */
    bool creeps;         /* is part of a motion that is never faster than creep, or ends in one */
    bool lands;          /* ends at `target`, else where it comes to rest */
    struct position target;
    struct motion_segment segment[PLAN_SEGMENTS];
};

/* Bounds in electrical turns per period^n, all above zero. */
struct motion_limits {
    double speed;
    double acceleration;
    double jerk;
};

/* Motion in electrical turns per period^n, as a target to pass through; the position is counted
   from the state it is approached from. */
struct motion_target {
    double distance;
    double speed;
    double acceleration;
};

/* 2^-64 turn; in range for |turns| < 1/2. */
int64_t motion_from_turns(double turns);
double motion_to_turns(int64_t x);

/* From a state to a position, in electrical turns. */
double motion_distance(const struct motion_state *from, struct position to);

/* Nearest position. The interrupt asks, too. */
static inline struct position motion_position(const struct motion_state *state)
{
    const uint64_t rounded = state->fraction + ((uint64_t)1 << 31);

    return (struct position){
        .turns = (int32_t)((uint32_t)state->turns + (rounded < state->fraction ? 1u : 0u)),
        .fraction = (angle_t)(rounded >> 32)};
}

/* `periods` on, with the acceleration of the state and a jerk of 6 jerk_sixth. */
void motion_run(struct motion_state *state, int64_t jerk_sixth, uint32_t periods);

/* An empty plan that preempts at `from` and has no continuation. */
void motion_plan_begin(struct motion_plan *plan, const struct motion_state *from, uint32_t epoch);

/*
 * Each appends segments and moves `end`, the state at the end of the plan, along.
 *
 * Passes through `target` after `periods` >= 3: three segments of constant jerk, position, speed
 * and acceleration continuous.
 */
void motion_plan_transfer(struct motion_plan *plan, struct motion_state *end,
                          const struct motion_target *target, uint32_t periods);

/*
 * Changes to `speed` in the least time that whole periods and the limits of acceleration and jerk
 * allow, at most three segments; the acceleration is zero behind them. Zero: to rest. Rounding the
 * times up to whole periods never takes more jerk, and not more acceleration, than the limits, but
 * where the motion begins beyond them.
 */
void motion_plan_speed(struct motion_plan *plan, struct motion_state *end, double speed,
                       const struct motion_limits *limits);

/* Goes on for ever at the speed of the end, where the acceleration is zero. */
void motion_plan_cruise(struct motion_plan *plan);

/*
 * To rest at `target` from whatever motion, seven segments: to a cruise speed of at most
 * limits->speed either way, cruise, to rest. Whole periods are made up for by the speed; in
 * moves of few periods acceleration and jerk may then pass their limits by one part in as many.
 */
void motion_plan_move(struct motion_plan *plan, struct motion_state *end, struct position target,
                      const struct motion_limits *limits);

#endif
