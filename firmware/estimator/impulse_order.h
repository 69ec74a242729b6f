/*
 * The order of impulses that leaves the rotor where it was: + - - + in phase a, then b; then all of
 * it negated, b first.
 */
#ifndef STEADYSTEP_IMPULSE_ORDER_H
#define STEADYSTEP_IMPULSE_ORDER_H

#include "firmware/motor/park.h"

enum { IMPULSES_OF_ROUND = 8, IMPULSE_ROUNDS = 2, IMPULSES = IMPULSES_OF_ROUND * IMPULSE_ROUNDS };

struct impulse {
    bool in_b;
    bool negative;
    uint32_t round;
};

/* Number 0...IMPULSES - 1. */
static inline struct impulse impulse_of(uint32_t number)
{
    const uint32_t round = number / IMPULSES_OF_ROUND;
    const uint32_t of_four = number % 4u;
    const bool second = round % 2u == 1u;

    return (struct impulse){.in_b = (number % IMPULSES_OF_ROUND >= 4u) != second,
                            .negative = (of_four == 1u || of_four == 2u) != second,
                            .round = round};
}

/* The impulse as phase voltages. */
static inline struct phases impulse_phases(struct impulse impulse, num_t magnitude)
{
    const num_t voltage = impulse.negative ? -magnitude : magnitude;

    return impulse.in_b ? (struct phases){NUM(0.0), voltage} : (struct phases){voltage, NUM(0.0)};
}

#endif
