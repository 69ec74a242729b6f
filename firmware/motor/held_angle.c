#include "firmware/motor/held_angle.h"

static const double eighth_turn = 536870912.0;

/* What any motor that can be controlled has. */
static const double swing_min = 8.0;
static const double swing_max = 1e6;

struct held_angle_params held_angle_design(double swing_periods)
{
    const double swing = swing_periods < swing_min   ? swing_min
                         : swing_periods < swing_max ? swing_periods
                                                     : swing_max;

    return (struct held_angle_params){
        .swing = (uint32_t)swing,
        .speed = (int32_t)(eighth_turn / swing),
        .acceleration = (int32_t)(eighth_turn / (swing * swing)) + 1,
    };
}

void held_angle_start(struct held_angle *angle)
{
    angle->offset = 0;
    angle->moved = 0;
    held_angle_lead_to(angle, 0);
}

void held_angle_lead_to(struct held_angle *angle, int32_t target)
{
    angle->target = target;
    angle->speed = 0;
    angle->stopping = 0;
}

bool held_angle_step(struct held_angle *angle, const struct held_angle_params *params)
{
    const int64_t way = (int64_t)angle->target - angle->offset;
    const int64_t distance = way < 0 ? -way : way;

    if (distance < angle->stopping && angle->speed > params->acceleration) {
        angle->stopping -= angle->speed;
        angle->speed -= params->acceleration;
    } else if (distance > angle->stopping + angle->speed && angle->speed < params->speed) {
        angle->speed += params->acceleration;
        angle->stopping += angle->speed;
    }
    angle->moved = way < 0 ? -angle->speed : angle->speed;
    if (distance <= angle->speed) {
        angle->moved = (int32_t)way;
    }
    angle->offset += angle->moved;
    return angle->offset == angle->target;
}
