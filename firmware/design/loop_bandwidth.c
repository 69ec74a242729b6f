#include "firmware/design/loop_bandwidth.h"

#include "firmware/design/motor_check.h"

/* A bandwidth at the limit is allowed, however its product with the period is rounded. */
#define ROUNDING 1.000001

bool current_bandwidth_check(const struct motor_params *motor, double period_s,
                             double current_bandwidth_rad_s, char error[DESIGN_ERROR_TEXT])
{
    const double current_max = CURRENT_BANDWIDTH_PERIOD_MAX / period_s;

    if (!motor_check(motor, period_s, error) ||
        !design_require_positive(error, "current bandwidth", current_bandwidth_rad_s, "rad/s")) {
        return false;
    }
    if (current_bandwidth_rad_s > current_max * ROUNDING) {
        return design_refuse_limit(error, (struct refusal){.quantity = "current bandwidth",
                                                           .value = current_bandwidth_rad_s,
                                                           .relation = "at most",
                                                           .limit = current_max,
                                                           .unit = "rad/s",
                                                           .reason = "0.3 per control period"});
    }
    return true;
}

bool loop_bandwidth_check(const struct motor_params *motor, double period_s,
                          double position_bandwidth_rad_s, double current_bandwidth_rad_s,
                          char error[DESIGN_ERROR_TEXT])
{
    const double position_max = current_bandwidth_rad_s / CURRENT_OVER_POSITION_BANDWIDTH_MIN;

    if (!current_bandwidth_check(motor, period_s, current_bandwidth_rad_s, error) ||
        !design_require_positive(error, "position bandwidth", position_bandwidth_rad_s, "rad/s")) {
        return false;
    }
    if (position_bandwidth_rad_s > position_max * ROUNDING) {
        return design_refuse_limit(error, (struct refusal){.quantity = "position bandwidth",
                                                           .value = position_bandwidth_rad_s,
                                                           .relation = "at most",
                                                           .limit = position_max,
                                                           .unit = "rad/s",
                                                           .reason = "a quarter of the current's"});
    }
    return true;
}
