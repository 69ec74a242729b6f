/*
 * A division where there is none: the divisor is scaled to 1/2...3/2, the dividend with it, and
 * the reciprocal found by Newton's method, whose error of 1/2 at most is squared by each step.
 * Some 150 cycles.
 */
#ifndef STEADYSTEP_QUOTIENT_H
#define STEADYSTEP_QUOTIENT_H

#include "firmware/numeric/num.h"

/* dividend / divisor, of a divisor from 2^-16 to 1.5 and a quotient of at most 16 in magnitude. */
__attribute__((noinline)) num_t quotient(num_t dividend, num_t divisor);

#endif
