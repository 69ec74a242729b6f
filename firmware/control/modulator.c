#include "firmware/control/modulator.h"

struct modulator_params modulator_design(uint32_t half_period_counts)
{
    const double half = (double)half_period_counts / 2.0;
    const struct modulator_params params = {
        .half_period_counts = (int32_t)half_period_counts,
        .counts_max = (int32_t)(half * (1.0 + MODULATION_MAX)),
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
 * r <- r (2 - v r) squares the error at each step as long as 0 < v r < 2; kept within its own
 * range, r comes back into that even if the bus jumps by more than twofold.
 */
void modulator_track_bus(struct modulator *modulator, num_t bus)
{
    num_t product;

    modulator->bus = num_clamp(bus, NUM(0.5), NUM(1.9));
    product = num_mul(modulator->bus, modulator->bus_reciprocal);
    modulator->bus_reciprocal = num_clamp(num_mul(modulator->bus_reciprocal, NUM(2.0) - product),
                                          NUM(1.0 / 1.9), NUM(1.0 / 0.4));
}

num_t modulator_voltage_limit(const struct modulator *modulator)
{
    return num_mul_unit(modulator->bus, UNIT(MODULATION_MAX));
}

static struct leg_pair leg_counts(const struct modulator *modulator,
                                  const struct modulator_params *params, num_t voltage)
{
    const num_t m = num_mul(voltage, modulator->bus_reciprocal);
    const int32_t counts_min = params->half_period_counts - params->counts_max;
    int32_t plus = counts_from_num(m, params->counts, params->half_period_counts / 2);

    plus = plus < params->counts_max ? plus : params->counts_max;
    plus = plus > counts_min ? plus : counts_min;
    const struct leg_pair legs = {(uint16_t)plus, (uint16_t)(params->half_period_counts - plus)};
    return legs;
}

static num_t voltage_of(const struct modulator *modulator, const struct modulator_params *params,
                        struct leg_pair legs)
{
    const num_t m = num_from_code((int32_t)legs.plus - params->half_period_counts / 2,
                                  params->voltage_per_count);

    return num_mul(m, modulator->bus);
}

struct modulation modulator_step(const struct modulator *modulator,
                                 const struct modulator_params *params, struct phases voltage)
{
    const struct leg_pair a = leg_counts(modulator, params, voltage.a);
    const struct leg_pair b = leg_counts(modulator, params, voltage.b);
    const struct modulation out = {
        .a = a,
        .b = b,
        .voltage = {voltage_of(modulator, params, a), voltage_of(modulator, params, b)},
    };
    return out;
}
