#include "firmware/control/modulator.h"

struct modulator_params modulator_design(uint32_t half_period_counts)
{
    struct modulator_params params;

    params.half_period_counts = (int32_t)half_period_counts;
    params.counts = coef_from_double((double)half_period_counts / 2.0 * NUM_COUNT_SCALE);
    return params;
}

void modulator_reset(struct modulator *modulator)
{
    modulator->bus = NUM(1.0);
    modulator->bus_reciprocal = NUM(1.0);
}

/*
 * r <- r (2 - v r) squares the error at each step as long as 0 < v r < 2; kept within its own
 * range, r comes back into that even if the bus jumps by more than twofold.
 */
void modulator_track_bus(struct modulator *modulator, num_t bus)
{
    num_t product;

    modulator->bus = num_clamp(bus, NUM(0.4), NUM(1.9));
    product = num_mul(modulator->bus, modulator->bus_reciprocal);
    modulator->bus_reciprocal = num_clamp(num_mul(modulator->bus_reciprocal, NUM(2.0) - product),
                                          NUM(1.0 / 1.9), NUM(1.0 / 0.4));
}

num_t modulator_voltage_limit(const struct modulator *modulator)
{
    return num_mul(modulator->bus, NUM(MODULATION_MAX));
}

static struct leg_pair leg_counts(const struct modulator_params *params, num_t modulation)
{
    const int32_t counts = counts_from_num(modulation, params->counts);
    const int32_t middle = params->half_period_counts / 2;
    const struct leg_pair legs = {(uint16_t)(middle + counts), (uint16_t)(middle - counts)};

    return legs;
}

static num_t modulation_of(const struct modulator *modulator, num_t voltage)
{
    return num_clamp(num_mul(voltage, modulator->bus_reciprocal), NUM(-MODULATION_MAX),
                     NUM(MODULATION_MAX));
}

struct modulation modulator_step(const struct modulator *modulator,
                                 const struct modulator_params *params, struct phases voltage)
{
    const num_t m_a = modulation_of(modulator, voltage.a);
    const num_t m_b = modulation_of(modulator, voltage.b);
    const struct modulation out = {
        .a = leg_counts(params, m_a),
        .b = leg_counts(params, m_b),
        .voltage = {num_mul(m_a, modulator->bus), num_mul(m_b, modulator->bus)},
    };
    return out;
}
