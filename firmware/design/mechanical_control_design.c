#include "firmware/design/mechanical_control_design.h"

#include "firmware/design/motor_check.h"

/* k1p over w0: the speed loop's pole is far enough from the position's to leave it alone. */
static const double speed_over_position = 4.0;

/* w0 over the pole of the integrator: what it gathers in a step overshoots by a thirtieth. */
static const double position_over_integral = 30.0;

/* A bandwidth at the limit is allowed, however its product with the period is rounded. */
static const double rounding = 1.000001;

double mechanical_control_bandwidth_max(double period_s)
{
    return MECHANICAL_CONTROL_PERIOD_MAX / (speed_over_position * period_s);
}

double winding_lag_bandwidth_max(const struct motor_params *motor)
{
    return MECHANICAL_CONTROL_LAG_MAX * motor->resistance_ohm /
           ((speed_over_position + 1.0) * motor->inductance_H);
}

bool mechanical_control_design(const struct motor_params *motor, double period_s,
                               double bandwidth_rad_s, struct mechanical_control_gains *gains,
                               char error[DESIGN_ERROR_TEXT])
{
    const double k2 = bandwidth_rad_s;
    const double k1p = speed_over_position * bandwidth_rad_s;

    if (!motor_check(motor, period_s, error) ||
        !design_require_positive(error, "law_bandwidth_rad_s", bandwidth_rad_s, "rad/s")) {
        return false;
    }
    if (k1p * period_s > MECHANICAL_CONTROL_PERIOD_MAX * rounding) {
        return design_refuse_limit(
            error, (struct refusal){.quantity = "law_bandwidth_rad_s",
                                    .value = bandwidth_rad_s,
                                    .relation = "at most",
                                    .limit = mechanical_control_bandwidth_max(period_s),
                                    .unit = "rad/s",
                                    .reason = "k1p T <= 0.15, k1p = 4 bandwidths"});
    }
    *gains = (struct mechanical_control_gains){
        .k1p_per_s = k1p,
        .k0_per_s3 = k1p * k2 * bandwidth_rad_s / position_over_integral,
        .k1_per_s2 = 0.0,
        .k2_per_s = k2,
    };
    return true;
}

double winding_lag_speed_max(const struct motor_params *motor)
{
    const double winding_s = motor->inductance_H / motor->resistance_ohm;

    return REACTANCE_OVER_RESISTANCE_MAX / ((double)motor->rotor_teeth * winding_s);
}

bool winding_lag_check(const struct motor_params *motor, double bandwidth_rad_s,
                       double speed_limit_rad_s, char error[DESIGN_ERROR_TEXT])
{
    const double bandwidth_max = winding_lag_bandwidth_max(motor);
    const double speed_max = winding_lag_speed_max(motor);

    if (bandwidth_rad_s > bandwidth_max * rounding) {
        return design_refuse_limit(error, (struct refusal){.quantity = "law_bandwidth_rad_s",
                                                           .value = bandwidth_rad_s,
                                                           .relation = "at most",
                                                           .limit = bandwidth_max,
                                                           .unit = "rad/s",
                                                           .reason = "(k1p + k2) L/R <= 2.8"});
    }
    if (speed_limit_rad_s > speed_max * rounding) {
        return design_refuse_limit(error, (struct refusal){.quantity = "speed_limit_rad_s",
                                                           .value = speed_limit_rad_s,
                                                           .relation = "at most",
                                                           .limit = speed_max,
                                                           .unit = "rad/s",
                                                           .reason = "N w L/R <= 4 without "
                                                                     "current control"});
    }
    return true;
}
