#include "firmware/control/modulator.h"

struct modulator_params modulator_design(uint32_t half_period_counts, double max)
{
    const double half = (double)half_period_counts / 2.0;
    struct modulator_params params = {
        .half_period_counts = (int32_t)half_period_counts,
        .middle_counts = (int32_t)half,
        .swing_counts = (int32_t)(half * max),
        .max = UNIT(max),
        .counts = coef_small_from_double(half * NUM_COUNT_SCALE),
        .voltage_per_count = coef_large_from_double(NUM_CODE_SCALE / half),
    };
    modulator_params_fit_coefficients(&params);
    return params;
}

void modulator_reset(struct modulator *modulator)
{
    modulator->bus = NUM(1.0);
    modulator->bus_reciprocal = NUM(1.0);
}
