#include "firmware/control/modulator.h"

struct modulator_params modulator_design(uint32_t half_period_counts, double max)
{
    const double half = (double)half_period_counts / 2.0;
    const struct modulator_params params = {
        .half_period_counts = (int32_t)half_period_counts,
        .middle_counts = (int32_t)half,
        .swing_counts = (int32_t)(half * max),
        .max = UNIT(max),
        .counts = coef_from_double(half * NUM_COUNT_SCALE),
        .voltage_per_count = coef_from_double(NUM_CODE_SCALE / half),
    };
    return params;
}

void modulator_reset(struct modulator *modulator)
{
    modulator->bus = NUM(1.0);
    modulator->bus_reciprocal = NUM(1.0);
}

/*
 * r <- r (2 - v r) squares the error at each step as long as 0 < v r < 2; kept from falling below
 * its range, r comes back into that even if the bus jumps by more than twofold. It never exceeds
 * 1/v, the maximum of the parabola, so the least bus bounds it.
 */
void modulator_track_bus(struct modulator *modulator, num_t bus)
{
    num_t product;

    modulator->bus = num_at_least(bus, NUM(0.5));
    product = num_mul(modulator->bus, modulator->bus_reciprocal);
    modulator->bus_reciprocal =
        num_at_least(num_mul(modulator->bus_reciprocal, NUM(2.0) - product), NUM(0.5));
}

num_t modulator_voltage_limit(const struct modulator *modulator,
                              const struct modulator_params *params)
{
    return num_mul_unit(modulator->bus, params->max);
}

/* By how many counts the two legs leave their middle, the one up and the other down. */
static int32_t leg_swing(const struct modulator *modulator, const struct modulator_params *params,
                         num_t voltage)
{
    const int32_t limit = params->swing_counts;
    const int32_t swing =
        counts_from_num(num_mul(voltage, modulator->bus_reciprocal), params->counts);

    /* One comparison: what is below -limit wraps to a large number. No two phases are limited in
     * one period, so the branch is laid out for the other case. */
    if (__builtin_expect((uint32_t)swing + (uint32_t)limit > 2u * (uint32_t)limit, 0)) {
        return swing < 0 ? -limit : limit;
    }
    return swing;
}

static struct leg_pair leg_counts(const struct modulator_params *params, int32_t swing)
{
    const int32_t plus = params->middle_counts + swing;
    const struct leg_pair legs = {(uint16_t)plus, (uint16_t)(params->half_period_counts - plus)};

    return legs;
}

static num_t voltage_of(const struct modulator *modulator, const struct modulator_params *params,
                        int32_t swing)
{
    const num_t m = num_from_code(swing, params->voltage_per_count);

    return num_mul(m, modulator->bus);
}

struct modulation modulator_step(const struct modulator *modulator,
                                 const struct modulator_params *params, struct phases voltage)
{
    const int32_t swing_a = leg_swing(modulator, params, voltage.a);
    const int32_t swing_b = leg_swing(modulator, params, voltage.b);
    const struct modulation out = {
        .a = leg_counts(params, swing_a),
        .b = leg_counts(params, swing_b),
        .voltage = {voltage_of(modulator, params, swing_a), voltage_of(modulator, params, swing_b)},
    };
    return out;
}
