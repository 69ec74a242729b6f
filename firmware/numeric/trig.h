/* Sine and cosine of an electrical angle; the same table and series in every number format. */
#ifndef STEADYSTEP_TRIG_H
#define STEADYSTEP_TRIG_H

#include "firmware/numeric/angle.h"

struct sincos {
    unit_t cos;
    unit_t sin;
};

/*
 * Error below 1.3e-7 in floating point, 1e-4 in fixed point; exact at multiples of a quarter turn.
 */
struct sincos sincos_of(angle_t angle);

/*
 * The same of a rotation of an eighth turn at most, in turns: the series alone, of the same error
 * in fixed point and below 3e-7 up to a sixteenth turn, 2.3e-6 up to an eighth.
 */
struct sincos sincos_of_small(num_t turns);

/* The sum of two angles: four products instead of another look-up. */
static inline struct sincos sincos_add(struct sincos x, struct sincos y)
{
    const struct sincos sum = {unit_mul(x.cos, y.cos) - unit_mul(x.sin, y.sin),
                               unit_mul(x.sin, y.cos) + unit_mul(x.cos, y.sin)};
    return sum;
}

#endif
