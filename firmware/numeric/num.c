#include "firmware/numeric/num.h"

#if STEADYSTEP_NUM == NUM_FIXED

/*
 * floor(sqrt(n)) for 2^30 <= n < 2^32, without division. With y = n/2^30: a parabola within 2.4 %
 * of r = 1/sqrt(y), r <- r (3 - y r^2)/2, which leaves 0.09 %, y r and its correction by (n -
 * root^2) r/2, which is off by one at most.
 */
static uint32_t root_of(uint32_t n)
{
    const uint32_t y = n >> 16;                                         /* Q14 */
    uint32_t r = 43759u - ((y * (53828u - ((y * 6712u) >> 14))) >> 16); /* Q15 */
    uint32_t root;
    int32_t rest;

    r = (r * ((3u << 14) - ((y * ((r * r) >> 15)) >> 15))) >> 15;
    root = (y * r) >> 14;
    rest = (int32_t)(n - root * root);
    root += (uint32_t)(((rest >> 8) * (int32_t)r) >> 23);
    rest = (int32_t)(n - root * root);
    if (rest < 0) {
        return root - 1u;
    }
    return rest > (int32_t)(2u * root) ? root + 1u : root;
}

num_t num_sqrt(num_t x)
{
    uint32_t bits;
    unsigned shift = 0;

    if (x <= 0) {
        return 0;
    }
    bits = (uint32_t)x;
    for (unsigned half = 8; half > 0u; half >>= 1) {
        if (bits < (1u << (32u - 2u * half))) {
            bits <<= 2u * half;
            shift += half;
        }
    }
    /* sqrt(m 2^-26) = sqrt(m) 2^-13; the root has 16 of the bits of sqrt(m 4^shift). */
    return (num_t)((root_of(bits) << 13) >> shift);
}

num_t num_from_double(double x)
{
    const double limit = NUM_MAX - 1.0 / 16777216.0;

    x = x < limit ? x : limit;
    x = x > -limit ? x : -limit;
    x *= 67108864.0;
    return (num_t)(x < 0.0 ? x - 0.5 : x + 0.5);
}

double num_to_double(num_t x)
{
    return (double)x / 67108864.0;
}

coef_t coef_from_double(double x)
{
    const double limit = 32767.0;
    coef_t k = {0, 0, 0};
    int exponent = 0; /* x = m 2^exponent with 0.5 <= m < 1 */
    double m = x < 0.0 ? -x : x;

    m = m < limit ? m : limit;
    if (m < 1.0 / 2147483648.0) {
        return k;
    }
    while (m >= 1.0) {
        m *= 0.5;
        exponent++;
    }
    while (m < 0.5) {
        m *= 2.0;
        exponent--;
    }
    int32_t mantissa = (int32_t)(m * 32768.0 + 0.5);
    if (mantissa == 32768) {
        mantissa = 16384;
        exponent++;
    }
    k.mantissa = (int16_t)(x < 0.0 ? -mantissa : mantissa);
    if (exponent + 1 >= 0) {
        k.left = (uint8_t)(exponent + 1);
    } else {
        k.right = (uint8_t)(-(exponent + 1));
    }
    return k;
}

coef_t coef_of_shift(double x, int shift)
{
    const coef_t unit = coef_with_shift(1, shift);
    const double m = x / coef_to_double(unit);
    const double limit = INT16_MAX;
    const double within = m > limit ? limit : m < -limit ? -limit : m;
    coef_t k = unit;

    k.mantissa = (int16_t)(within < 0.0 ? within - 0.5 : within + 0.5);
    return k;
}

coef_t coef_large_from_double(double x)
{
    const coef_t k = coef_from_double(x);

    return k.right > 0u ? coef_of_shift(x, 0) : k;
}

coef_t coef_small_from_double(double x)
{
    const coef_t k = coef_from_double(x);

    return k.left > 0u ? coef_of_shift(x, 0) : k;
}

double coef_to_double(coef_t k)
{
    double x = (double)k.mantissa / 65536.0;

    for (unsigned i = 0; i < k.left; i++) {
        x *= 2.0;
    }
    for (unsigned i = 0; i < k.right; i++) {
        x *= 0.5;
    }
    return x;
}

uint32_t num_bits(num_t x)
{
    return (uint32_t)x;
}

uint32_t coef_bits(coef_t k)
{
    return ((uint32_t)(uint16_t)k.mantissa << 16) | ((uint32_t)k.left << 8) | k.right;
}

#else

#if STEADYSTEP_NUM == NUM_FLOAT
#define SQUARE_ROOT(x) __builtin_sqrtf(x)
#else
#define SQUARE_ROOT(x) __builtin_sqrt(x)
#endif

/* The hardware's square root: correctly rounded on every core that has one. */
num_t num_sqrt(num_t x)
{
    return x > NUM(0.0) ? SQUARE_ROOT(x) : NUM(0.0);
}

num_t num_from_double(double x)
{
    return (num_t)x;
}

double num_to_double(num_t x)
{
    return (double)x;
}

coef_t coef_from_double(double x)
{
    return (coef_t)x;
}

coef_t coef_large_from_double(double x)
{
    return coef_from_double(x);
}

coef_t coef_small_from_double(double x)
{
    return coef_from_double(x);
}

double coef_to_double(coef_t k)
{
    return (double)k;
}

uint32_t num_bits(num_t x)
{
    union {
        num_t number;
        uint32_t word[sizeof(num_t) / sizeof(uint32_t)];
    } bits;
    uint32_t folded = 0;

    bits.number = x;
    for (unsigned i = 0; i < sizeof bits.word / sizeof bits.word[0]; i++) {
        folded ^= bits.word[i] >> (7u * i);
        folded ^= (i > 0u) ? bits.word[i] << (32u - 7u * i) : 0u;
    }
    return folded;
}

uint32_t coef_bits(coef_t k)
{
    return num_bits(k);
}

#endif
