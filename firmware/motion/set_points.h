/*
 * Set-points at a fixed interval, joined to a motion with continuous speed and acceleration. At
 * each set-point the speed and acceleration are those of the parabola through it and its two
 * neighbours; in between the jerk is constant in three parts (motion_plan.h).
 *
 * A set-point therefore waits for the next one: it is reached two intervals after it came, and the
 * lead of the drive on top.
 */
#ifndef STEADYSTEP_SET_POINTS_H
#define STEADYSTEP_SET_POINTS_H

#include "firmware/design/refusal.h"
#include "firmware/motion/motion_plan.h"

#define SET_POINTS_LENGTH 16u

struct set_points {
    struct position point[SET_POINTS_LENGTH];
    uint32_t written;
    uint32_t read;
    struct position posted[2]; /* the last two, or where the motion begins; the latest first */
    struct position behind;    /* the one before the next to be reached */
    uint32_t interval_periods; /* at least 3 */
    struct motion_limits limits;
};

/* From rest at a position; takes the interval and the limits. */
void set_points_begin(struct set_points *points, struct position start, uint32_t interval_periods,
                      const struct motion_limits *limits);

/*
 * Appends a set-point. Refused, with the reason in `error`, if SET_POINTS_LENGTH - 1 wait (the
 * first counts until the second has been planned: set_points_rewind may bring it back), or if speed
 * or acceleration, as the differences of the last set-points give them, are beyond the limits.
 */
bool set_points_put(struct set_points *points, struct position position,
                    char error[DESIGN_ERROR_TEXT]);

/* Those that have not been planned yet. */
static inline uint32_t set_points_waiting(const struct set_points *points)
{
    return points->written - points->read;
}

/* Begins anew: the first one has not been planned after all. */
void set_points_rewind(struct set_points *points, struct position start);

/* Appends the motion to the next set-point; false: the one after it has not come yet. */
bool set_points_continue(struct set_points *points, struct motion_plan *plan,
                         struct motion_state *end);

#endif
