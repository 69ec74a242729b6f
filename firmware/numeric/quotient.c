#include "firmware/numeric/quotient.h"

#include <stdint.h>

/* Four of them leave of 2^-16 a half. */
static void scale(num_t *dividend, num_t *divisor, num_t below, int32_t by)
{
    if (*divisor < below) {
        *divisor *= (num_t)by;
        *dividend *= (num_t)by;
    }
}

/* Errors of 1/2, 1/4, 1/16, 4e-3, 2e-5, 2e-10. */
#define NEWTON_STEPS 6u

num_t quotient(num_t dividend, num_t divisor)
{
    num_t reciprocal = NUM(1.0);

    scale(&dividend, &divisor, NUM(1.0 / 256.0), 256);
    scale(&dividend, &divisor, NUM(1.0 / 16.0), 16);
    scale(&dividend, &divisor, NUM(1.0 / 4.0), 4);
    scale(&dividend, &divisor, NUM(1.0 / 2.0), 2);
    for (uint32_t i = 0u; i < NEWTON_STEPS; i++) {
        reciprocal = num_mul(reciprocal, NUM(2.0) - num_mul(divisor, reciprocal));
    }
    return num_mul(dividend, reciprocal);
}
