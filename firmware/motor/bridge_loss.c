#include "firmware/motor/bridge_loss.h"

/* Of the current base: a converter code, within which no sign is known. */
static const double least_zone = 1.0 / 4096.0;

struct bridge_loss_params bridge_loss_design(const struct motor_params *motor,
                                             const struct per_unit *base, double period_s,
                                             double dead_time_s)
{
    const double share = dead_time_s / period_s;
    const double rate = period_s / motor->inductance_H * base->resistance_ohm;
    const double zone = rate * share > least_zone ? rate * share : least_zone;
    const double short_pulse = 2.0 * share; /* of both halves of the period, times the supply */
    const struct bridge_loss_params params = {
        .loss_per_bus = coef_from_double(0.5 * share),
        .diode_loss = num_from_double(share * BRIDGE_DIODE_DROP_V / base->voltage_V),
        .ripple = coef_from_double(0.25 * rate),
        .half_zone = num_from_double(0.5 * zone),
        .sign_per_current = coef_from_double(2.0 / zone),
        .short_pulse = num_from_double(short_pulse),
        .shift_per_voltage = coef_from_double(share > 0.0 ? 0.5 * zone / short_pulse : 0.0),
    };
    return params;
}

static num_t sign(const struct bridge_loss_params *params, num_t current)
{
    return num_mul_coef(num_limit(current, params->half_zone), params->sign_per_current);
}

static num_t phase_voltage(const struct bridge_loss_params *params, num_t commanded, num_t before,
                           num_t now, num_t per_edge, num_t bus_reciprocal)
{
    const num_t magnitude = num_abs(commanded);
    const num_t modulation = num_mul(magnitude, bus_reciprocal);
    const num_t ripple = num_mul_coef(num_mul(magnitude, NUM(1.0) - modulation), params->ripple);
    const num_t shift =
        num_mul_coef(num_limit(commanded, params->short_pulse), params->shift_per_voltage);
    const num_t quarter = num_half(num_half(now - before));
    const num_t first = before + quarter + shift;
    const num_t second = now - quarter + shift;
    const num_t signs = sign(params, first - ripple) + sign(params, first + ripple) +
                        sign(params, second - ripple) + sign(params, second + ripple);

    return commanded - num_mul(signs, per_edge);
}

struct phases bridge_loss_voltage(const struct bridge_loss_params *params, struct phases commanded,
                                  struct phases before, struct phases now, num_t bus,
                                  num_t bus_reciprocal)
{
    const num_t per_edge = num_mul_coef(bus, params->loss_per_bus) + params->diode_loss;
    const struct phases voltage = {
        phase_voltage(params, commanded.a, before.a, now.a, per_edge, bus_reciprocal),
        phase_voltage(params, commanded.b, before.b, now.b, per_edge, bus_reciprocal),
    };
    return voltage;
}
