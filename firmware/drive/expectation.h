/*
 * What would come of the demanded voltage alone, for the voltage laws that observe what disturbs
 * it: kept from one S(k) to the next.
 */
#ifndef STEADYSTEP_EXPECTATION_H
#define STEADYSTEP_EXPECTATION_H

#include "firmware/motor/park.h"

struct expectation {
    struct phases demanded_voltage; /* of the last S(k) */
    struct phases current;          /* for this S(k), had what was demanded acted */
    struct sincos frame;            /* of the middle of the period before this S(k) */
};

/* At rest, without voltage. */
static inline void expectation_reset(struct expectation *expectation)
{
    const struct phases none = {NUM(0.0), NUM(0.0)};

    expectation->demanded_voltage = none;
    expectation->current = none;
    expectation->frame = (struct sincos){UNIT(1.0), UNIT(0.0)};
}

/* By how much the current that is measured at this S(k) differs from it, in the rotor's frame. */
static inline struct dq expectation_innovation(const struct expectation *expectation,
                                               struct phases measured)
{
    const struct phases difference = {measured.a - expectation->current.a,
                                      measured.b - expectation->current.b};

    return park(difference, expectation->frame);
}

/* With this period's voltage: what it leads to at the next S(k). */
static inline void expectation_set(struct expectation *expectation, struct phases demanded_voltage,
                                   struct phases current, struct sincos frame)
{
    expectation->demanded_voltage = demanded_voltage;
    expectation->current = current;
    expectation->frame = frame;
}

#endif
