#include "firmware/control/error_feedback.h"

/* Per-unit bound of one of the error terms: twice this and the rest stay below NUM_MAX. */
static const double term_limit = 10.0;

static num_t error_limit(double gain, double largest)
{
    return num_from_double(gain * largest > term_limit ? term_limit / gain : largest);
}

struct error_feedback_params error_feedback_scale(const struct position_law_task *task,
                                                  const struct error_feedback_gains *gains)
{
    const struct per_unit *base = task->base;
    const double position = gains->position_A_rad * base->rad_per_turn / base->current_A;
    const double speed = gains->speed_As_rad * base->speed_rad_s / base->current_A;
    struct error_feedback_params params = {
        .position = coef_from_double(position),
        .speed = coef_large_from_double(speed),
        .reference_acceleration = coef_large_from_double(
            gains->reference_acceleration_As2_rad * base->acceleration_rad_s2 / base->current_A),
        .reference_friction = coef_from_double(gains->reference_friction_As_rad *
                                               base->speed_rad_s / base->current_A),
        .position_error_limit = error_limit(position, POSITION_DIFFERENCE_MAX),
        .speed_error_limit = error_limit(speed, 2.0 * task->speed_limit_rad_s / base->speed_rad_s),
        .current_limit = num_from_double(task->current_limit_A / base->current_A),
    };
    error_feedback_params_fit_coefficients(&params);
    return params;
}
