#include "firmware/drive/following_error.h"

enum { LOOKS_MAX = 10 };

static const double look_s = 1e-3;
static const double back_within_s = 0.25;

struct following_error_params following_error_design(const struct following_error_task *task)
{
    const double speed_rad_s = task->limit_rad / back_within_s;

    return (struct following_error_params){
        .limit = num_from_double(task->limit_rad / task->base->rad_per_turn),
        .approach = num_from_double(speed_rad_s / task->base->speed_rad_s),
        .periods = (uint32_t)(look_s / task->period_s + 0.5),
    };
}

void following_error_reset(struct following_error *following)
{
    following->looks = 0u;
}

bool following_error_exceeds(struct following_error *following,
                             const struct following_error_params *params, num_t error,
                             num_t speed_error)
{
    const bool ahead = error > NUM(0.0);
    const num_t size = ahead ? error : -error;
    const num_t growth = ahead ? speed_error : -speed_error;
    const bool comes_back = growth < -params->approach;

    following->looks = size > params->limit && !comes_back ? following->looks + 1u : 0u;
    return following->looks >= (uint32_t)LOOKS_MAX;
}
