#include "firmware/design/feedback_linearisation_design.h"

#include "firmware/design/elementary.h"

/* A value that is meant to be the limit may come out of a division a rounding above it. */
#define ROUNDING (1.0 + 1e-12)

/* 1 - cos x of y = x^2 < 1, without cancellation; the next term is below 1e-13 of it. */
static double one_minus_cosine(double y)
{
    return 0.5 * y * alternating_series(y, 3, 5);
}

/* 1 - e^-x */
static double one_minus_decay(double x)
{
    return x * exponential_phi1(-x);
}

static bool check(const char *quantity, double bandwidth_rad_s, double period_s, double limit,
                  const char *reason, char error[DESIGN_ERROR_TEXT])
{
    if (!design_require_positive(error, quantity, bandwidth_rad_s, "rad/s")) {
        return false;
    }
    if (bandwidth_rad_s * period_s > limit * ROUNDING) {
        return design_refuse_limit(error, (struct refusal){.quantity = quantity,
                                                           .value = bandwidth_rad_s,
                                                           .relation = "at most",
                                                           .limit = limit / period_s,
                                                           .unit = "rad/s",
                                                           .reason = reason});
    }
    return true;
}

bool feedback_linearisation_design(double period_s,
                                   const struct feedback_linearisation_poles *poles,
                                   struct feedback_linearisation_gains *gains,
                                   char error[DESIGN_ERROR_TEXT])
{
    if (!check("law_bandwidth_rad_s", poles->law_bandwidth_rad_s, period_s,
               LINEARISED_LAW_BANDWIDTH_PERIOD_MAX, "0.15 per control period", error) ||
        !check("current_bandwidth_rad_s", poles->current_bandwidth_rad_s, period_s,
               LINEARISED_CURRENT_BANDWIDTH_PERIOD_MAX, "0.3 per control period", error)) {
        return false;
    }
    const double x = poles->law_bandwidth_rad_s * period_s;
    const double damping = poles->damping;
    const double q = one_minus_decay(damping * x);
    const double turn = 2.0 * (1.0 - q) * one_minus_cosine(x * x * (1.0 - damping * damping));
    const double sum = 2.0 * q + turn;   /* d1 + d2 */
    const double product = q * q + turn; /* d1 d2 */
    const double d3 = one_minus_decay(poles->current_bandwidth_rad_s * period_s);
    const double c2 = sum + d3;
    const double c1 = product + sum * d3;
    const double c0 = product * d3;

    gains->k_position_s2 = c0 / (period_s * period_s);
    gains->k_speed_s = (c1 - c0) / period_s;
    gains->k_acceleration = c2 - (c1 - c0) / 2.0 - c0 / 6.0;
    return true;
}
