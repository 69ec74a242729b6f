#include "firmware/motion/set_points.h"

#include "firmware/design/elementary.h"

void set_points_begin(struct set_points *points, struct position start, uint32_t interval_periods,
                      const struct motion_limits *limits)
{
    points->read = 0;
    points->written = 0;
    points->posted[0] = start;
    points->posted[1] = start;
    points->behind = start;
    points->interval_periods = interval_periods;
    points->limits = *limits;
}

/* a - b in electrical turns. */
static double turns_between(struct position a, struct position b)
{
    return motion_distance(
        &(struct motion_state){.turns = b.turns, .fraction = (uint64_t)b.fraction << 32}, a);
}

bool set_points_put(struct set_points *points, struct position position,
                    char error[DESIGN_ERROR_TEXT])
{
    const double n = (double)points->interval_periods;
    const double step = turns_between(position, points->posted[0]);
    const double step_before = turns_between(points->posted[0], points->posted[1]);

    /* while the first plan may still be refused and made again, its set-point is needed */
    const uint32_t oldest = points->read == 1u ? 0u : points->read;

    if (points->written - oldest >= SET_POINTS_LENGTH - 1u) {
        return design_refuse(error, "set-point refused: 15 set-points are waiting already");
    }
    if (magnitude(step) > points->limits.speed * n) {
        return design_refuse(error, "set-point refused: the speed from the one before exceeds the "
                                    "drive's limit");
    }
    if (magnitude(step - step_before) > points->limits.acceleration * n * n) {
        return design_refuse(error, "set-point refused: the acceleration from the two before "
                                    "exceeds the drive's limit");
    }
    points->point[points->written % SET_POINTS_LENGTH] = position;
    points->written++;
    points->posted[1] = points->posted[0];
    points->posted[0] = position;
    return true;
}

void set_points_rewind(struct set_points *points, struct position start)
{
    points->read = 0;
    points->behind = start;
}

bool set_points_continue(struct set_points *points, struct motion_plan *plan,
                         struct motion_state *end)
{
    const double n = (double)points->interval_periods;

    if (set_points_waiting(points) < 2u) {
        return false;
    }
    const struct position here = points->point[points->read % SET_POINTS_LENGTH];
    const struct position ahead = points->point[(points->read + 1u) % SET_POINTS_LENGTH];
    const double from_behind = turns_between(here, points->behind);
    const double to_ahead = turns_between(ahead, here);
    const struct motion_target target = {
        .distance = motion_distance(end, here),
        .speed = (from_behind + to_ahead) / (2.0 * n),
        .acceleration = (to_ahead - from_behind) / (n * n),
    };

    motion_plan_transfer(plan, end, &target, points->interval_periods);
    plan->continues_after = plan->segments;
    points->behind = here;
    points->read++;
    return true;
}
