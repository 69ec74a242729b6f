#include "firmware/drive/inductance_measurement.h"

#include "firmware/numeric/quotient.h"

/* Of the hold's current, to either side. */
static const double amplitude_share = 0.25;

/* The first leads to one side, the last back to the middle. */
#define STEPS 18u
#define SHARE NUM(1.0 / 16.0) /* of a step between them in the means */

/*
 * What the estimator wants of the inductance that is measured. The hold's current has saturated
 * the d axis, and iron that turns back and forth takes a part of the swing for itself: of the
 * inductance of a meter 0.90 to 0.96 is left on the plant `as-built`. In motion the d current is 0.
 * Of factors from 1 to 1.09 this one held the most runs there, and those from 1.03 on all but a
 * few.
 */
#define UNSATURATED NUM(1.06)

/* 2 ms or more: the current control has reached its reference in that. */
#define STEPS_OF_LOOK 20u

struct inductance_measurement_params inductance_measurement_design(const struct per_unit *base,
                                                                   double hold_current_A,
                                                                   uint32_t look_periods)
{
    return (struct inductance_measurement_params){
        .half = look_periods / STEPS_OF_LOOK,
        .amplitude = num_from_double(amplitude_share * hold_current_A / base->current_A),
    };
}

void inductance_measurement_start(struct inductance_measurement *measurement)
{
    *measurement = (struct inductance_measurement){.steps = 0u};
}

bool inductance_measurement_step(struct inductance_measurement *measurement,
                                 const struct inductance_measurement_params *params,
                                 num_t resistance, num_t voltage, num_t current)
{
    const num_t share = measurement->steps < 2u         ? NUM(0.0)
                        : measurement->level < NUM(0.0) ? -SHARE
                                                        : SHARE;
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
    measurement->level = measurement->steps == STEPS       ? NUM(0.0)
                         : (measurement->steps & 1u) != 0u ? params->amplitude
                                                           : -params->amplitude;
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
    if (change < params->amplitude || num_abs(more) > change) {
        return NUM(1.0);
    }
    return quotient(more, change);
}
