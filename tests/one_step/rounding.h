/*
 * Included before each source of the control interrupt, which is compiled in double: what rounds in
 * float or in fixed point is off here by a random part of that rounding.
 *
 * Each function below stands for the one of its name in firmware/numeric/. It computes in double,
 * and adds an error between the bounds that the other format's own source gives: of a float
 * +-2^-24 of the result, in fixed point the step of each shift to the right, down or to nearest. So
 * a control interrupt of this image is one that an arithmetic of that accuracy can have, and many
 * of them show what such an arithmetic can make of one state. Sums are exact, as they are in fixed
 * point. Of a sum in float the error is 2^-24 of it again, which is what its terms have.
 */
#ifndef STEADYSTEP_ROUNDING_H
#define STEADYSTEP_ROUNDING_H

#include "firmware/numeric/arctangent.h"
#include "firmware/numeric/trig.h"
#include "tests/one_step/rounded_drive.h"

/* In force; rounded_drive.c. */
extern enum rounding_format rounding_format;

#define ROUNDING_NUM  (1.0 / 67108864.0) /* 2^-26 */
#define ROUNDING_UNIT (1.0 / 32768.0)

/* A result: in float off by half of its last place, in fixed point by low...high steps. Zero is
   exact: relays stand on it. */
static inline double rounded(double x, double step, double low, double high)
{
    if (rounding_format == ROUNDING_FLOAT) {
        return x + x * rounding_between(-1.0 / 16777216.0, 1.0 / 16777216.0);
    }
    return rounding_format >= ROUNDING_FIXED && x != 0.0 ? x + step * rounding_between(low, high)
                                                         : x;
}

/* A factor that fixed point takes with fewer bits than it has, a float as it is. */
static inline double rounded_factor(double x, double step)
{
    return rounding_format >= ROUNDING_FIXED ? x + step * rounding_between(-1.0, 0.0) : x;
}

/*
 * What one step of the product with the mantissa of a gain is worth behind its shift to the left:
 * a mantissa has 15 bits, 2^14 at least unless the shift is zero. An image for one motor has shifts
 * for boards whose periods have 3,200 to 8,500 counts, and up to four bits less.
 */
static inline double rounding_step_of_gain(double k)
{
    const double magnitude = k < 0.0 ? -k : k;
    double step = ROUNDING_NUM;
    const double least = rounding_format == ROUNDING_ONE_MOTOR ? 0.5 / 16.0 : 0.5;

    for (double above = least; magnitude >= above; above *= 2.0) {
        step *= 2.0;
    }
    return step;
}

static inline num_t rounded_mul_unit(num_t a, unit_t u)
{
    return rounded(a * u, ROUNDING_NUM, -1.0, 0.0);
}

static inline num_t rounded_mul_unit_nearest(num_t a, unit_t u)
{
    return rounded(a * u, ROUNDING_NUM, -0.5, 0.5);
}

/* A constant that is not a multiple of 2^-15. */
static inline unit_t rounded_constant(double x)
{
    return rounding_format >= ROUNDING_FIXED ? x + ROUNDING_UNIT * rounding_between(-0.5, 0.5) : x;
}

/* Two shifts: one behind the product, one of the gain. */
static inline num_t rounded_mul_coef(num_t a, coef_t k)
{
    return rounded(a * k, rounding_step_of_gain(k), -1.5, 0.0);
}

static inline num_t rounded_mul_coef_nearest(num_t a, coef_t k)
{
    return rounded(a * k, rounding_step_of_gain(k), -1.0, 0.5);
}

static inline num_t rounded_mul_coef_fine(num_t a, coef_t k, coef_t remainder)
{
    (void)remainder; /* in double it is in k */
    return rounded(a * k, rounding_step_of_gain(k), -3.0, 0.0);
}

static inline coef_t rounded_more(coef_t k, num_t more)
{
    return rounded(coef_more(k, rounded_factor(more, ROUNDING_UNIT)), k * ROUNDING_UNIT, -1.0, 1.0);
}

static inline num_t rounded_mul(num_t a, num_t b)
{
    return rounded(a * rounded_factor(b, 1.0 / 16384.0), ROUNDING_NUM, -1.0, 0.0);
}

static inline num_t rounded_mul_nearest(num_t a, num_t b)
{
    return rounded(a * rounded_factor(b, 1.0 / 16384.0), ROUNDING_NUM, -0.5, 0.5);
}

static inline unit_t rounded_unit_mul(unit_t a, unit_t b)
{
    return rounded(a * b, ROUNDING_UNIT, -1.0, 0.0);
}

static inline unit_t rounded_unit_from_num(num_t a)
{
    return rounded_factor(a, ROUNDING_UNIT);
}

static inline num_t rounded_half(num_t a)
{
    return rounded_factor(0.5 * a, 0.5 * ROUNDING_NUM);
}

static inline num_t rounded_from_code(int32_t code, coef_t k)
{
    return rounded(num_from_code(code, k), rounding_step_of_gain(65536.0 * k), -1.5, 0.0);
}

static inline num_t rounded_from_code_sum(int32_t sum, coef_t k)
{
    return rounded(num_from_code_sum(sum, k), rounding_step_of_gain(65536.0 * k), -1.5, 0.0);
}

static inline int32_t rounded_counts(num_t a, coef_t k)
{
    return num_to_nearest(rounded(a * k, 1.0 / 1024.0, -1.5, 0.0));
}

/* 16 bits, towards zero. */
static inline num_t rounded_sqrt(num_t x)
{
    const double root = num_sqrt(x);

    return rounded(root, root * ROUNDING_UNIT + ROUNDING_NUM, -1.0, 0.0);
}

static inline num_t rounded_headroom(num_t a, num_t limit)
{
    return rounding_format >= ROUNDING_FIXED ? num_limit(a, limit) : a;
}

/* The bounds that trig.h states. */
static inline struct sincos rounded_sincos(struct sincos exact, double of_float)
{
    const double bound = rounding_format >= ROUNDING_FIXED   ? 1e-4
                         : rounding_format == ROUNDING_FLOAT ? of_float
                                                             : 0.0;
    const struct sincos to = {exact.cos + rounding_between(-bound, bound),
                              exact.sin + rounding_between(-bound, bound)};

    return to;
}

static inline struct sincos rounded_sincos_of(angle_t angle)
{
    return rounded_sincos(sincos_of(angle), 1.3e-7);
}

static inline struct sincos rounded_sincos_of_small(num_t turns)
{
    return rounded_sincos(sincos_of_small(turns), 1.3e-7);
}

static inline struct sincos rounded_sincos_add(struct sincos x, struct sincos y)
{
    const struct sincos sum = {rounded_unit_mul(x.cos, y.cos) - rounded_unit_mul(x.sin, y.sin),
                               rounded_unit_mul(x.sin, y.cos) + rounded_unit_mul(x.cos, y.sin)};

    return sum;
}

/* Of components with 24 fractional bits, in every format. */
static inline angle_t rounded_angle_of_vector(num_t x, num_t y)
{
    const double step = 1.0 / 16777216.0;

    return angle_of_vector(rounded(x, step, -1.0, 1.0), rounded(y, step, -1.0, 1.0));
}

/* A float counts 2^-27 turn, fixed point 2^-26. */
static inline num_t rounded_difference(struct position a, struct position b)
{
    const double turns = position_difference(a, b);

    if (rounding_format == ROUNDING_FLOAT) {
        return rounded(turns + rounding_between(-1.0, 0.0) / 134217728.0, 0.0, 0.0, 0.0);
    }
    return rounded_factor(turns, ROUNDING_NUM);
}

static inline num_t rounded_turns(int32_t angle)
{
    return rounded(turns_from_angle(angle), ROUNDING_NUM, -1.0, 0.0);
}

static inline int32_t rounded_any_turns(num_t turns)
{
    return angle_from_turns(rounded_headroom(turns, 0.499));
}

#ifndef ROUNDING_WITH_CONSTANTS /* a source that has exact ones, in tables */
#undef UNIT
#define UNIT(x) rounded_constant(x)
#endif

#ifndef ROUNDING_OF_ITS_OWN /* a source of firmware/numeric/ that defines them */
#define num_mul_unit          rounded_mul_unit
#define num_mul_unit_nearest  rounded_mul_unit_nearest
#define num_mul_coef          rounded_mul_coef
#define num_mul_coef_nearest  rounded_mul_coef_nearest
#define num_mul_coef_fine     rounded_mul_coef_fine
#define num_mul_large         rounded_mul_coef
#define num_mul_small         rounded_mul_coef
#define num_mul_small_nearest rounded_mul_coef_nearest
#define coef_more             rounded_more
#define num_mul               rounded_mul
#define num_mul_nearest       rounded_mul_nearest
#define unit_mul              rounded_unit_mul
#define unit_from_num         rounded_unit_from_num
#define num_half              rounded_half
#define num_from_code         rounded_from_code
#define num_from_code_sum     rounded_from_code_sum
#define counts_from_num       rounded_counts
#define num_sqrt              rounded_sqrt
#define num_headroom          rounded_headroom
#define sincos_of             rounded_sincos_of
#define sincos_of_small       rounded_sincos_of_small
#define sincos_add            rounded_sincos_add
#define angle_of_vector       rounded_angle_of_vector
#define position_difference   rounded_difference
#define turns_from_angle      rounded_turns
#define angle_from_any_turns  rounded_any_turns
#endif

#endif
