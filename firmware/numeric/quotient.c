#include "firmware/numeric/quotient.h"

#include <stdint.h>

#define DOUBLINGS 16u

/* Errors of 1/2, 1/4, 1/16, 4e-3, 2e-5, 2e-10. */
#define NEWTON_STEPS 6u

num_t quotient(num_t dividend, num_t divisor)
{
    num_t reciprocal = NUM(1.0);

    for (uint32_t i = 0u; i < DOUBLINGS && divisor < NUM(0.75); i++) {
        divisor += divisor;
        dividend += dividend;
    }
    for (uint32_t i = 0u; i < NEWTON_STEPS; i++) {
        reciprocal = num_mul(reciprocal, NUM(2.0) - num_mul(divisor, reciprocal));
    }
    return num_mul(dividend, reciprocal);
}
