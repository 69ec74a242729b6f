#include "firmware/drive/inductance_measurement.h"

#include "firmware/numeric/quotient.h"

/* Of the hold's current, to either side. */
static const double small_share = 0.15;
static const double large_share = 0.4;

/* Of small swings, then of large ones. The first step leads to one side, one from the small swings
   to the large ones, the last back to the middle. */
#define FIRST_LARGE 10u
#define STEPS       19u
#define SHARE       NUM(1.0 / 16.0) /* of each of the others in the means */

/*
 * What the estimator wants of the inductance that is measured. The hold's current has saturated
 * the d axis, and of iron that turns within more flux than a swing makes the large swings have more
 * than the small ones: of the inductance of a meter 0.90 to 0.95 is left on the plant `as-built`.
 * In motion the d current is 0.
 */
#define UNSATURATED NUM(1.04)

/* 2 ms or more: the current control has reached its reference in that. */
#define STEPS_OF_LOOK 20u

struct inductance_measurement_params inductance_measurement_design(const struct per_unit *base,
                                                                   double hold_current_A,
                                                                   uint32_t look_periods)
{
    const double current = hold_current_A / base->current_A;

    return (struct inductance_measurement_params){
        .half = look_periods / STEPS_OF_LOOK,
        .small = num_from_double(small_share * current),
        .large = num_from_double(large_share * current),
    };
}

void inductance_measurement_start(struct inductance_measurement *measurement)
{
    *measurement = (struct inductance_measurement){.steps = 0u};
}

/* In the means, of the swing that ends. */
static num_t share_of(const struct inductance_measurement *measurement)
{
    const bool adds = (measurement->level > NUM(0.0)) == (measurement->steps > FIRST_LARGE);

    return measurement->steps < 2u || measurement->steps == FIRST_LARGE ? NUM(0.0)
           : adds                                                       ? SHARE
                                                                        : -SHARE;
}

static num_t next_level(const struct inductance_measurement *measurement,
                        const struct inductance_measurement_params *params)
{
    const num_t amplitude = measurement->steps < FIRST_LARGE ? params->small : params->large;

    return measurement->steps == STEPS       ? NUM(0.0)
           : (measurement->steps & 1u) != 0u ? amplitude
                                             : -amplitude;
}

bool inductance_measurement_step(struct inductance_measurement *measurement,
                                 const struct inductance_measurement_params *params,
                                 num_t resistance, num_t voltage, num_t current)
{
    const num_t share = share_of(measurement);
    const num_t drop = num_mul(measurement->before, resistance);

    if (params->half == 0u || measurement->steps == STEPS) {
        return false;
    }
    measurement->flux += num_mul(voltage - drop, share);
    measurement->before = current;
    measurement->periods++;
    if (measurement->steps != 0u && measurement->periods < params->half) {
        return false;
    }
    measurement->change += num_mul(current - measurement->begin, share);
    measurement->begin = current;
    measurement->periods = 0u;
    measurement->steps++;
    measurement->level = next_level(measurement, params);
    return true;
}

num_t inductance_measurement_result(const struct inductance_measurement *measurement,
                                    const struct inductance_measurement_params *params,
                                    num_t admittance)
{
    const num_t change = measurement->change;
    const num_t wanted = num_mul(num_mul(measurement->flux, admittance), UNSATURATED);
    const num_t more = wanted - change;

    if (params->half == 0u) {
        return NUM(0.0);
    }
    if (change < num_half(params->large - params->small) || num_abs(more) > change) {
        return NUM(1.0);
    }
    return quotient(more, change);
}
