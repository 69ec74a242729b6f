/*
 * One source for three number formats.
 *
 *   num_t   a per-unit quantity inside the interrupt; + and - are plain
 *   unit_t  a sine, a cosine or another ratio in -1...1
 *   coef_t  a gain fixed at start-up, any magnitude
 *
 * STEADYSTEP_NUM selects the format at build time: NUM_FLOAT (float, Cortex-M4F and host),
 * NUM_FIXED (32-bit fixed point, any core) or NUM_DOUBLE (reference, host only). It is tested for
 * in this folder and nowhere else.
 *
 * Fixed point: num_t is Q5.26, range -32...32 with a resolution of 1.5e-8. unit_t is Q15 in
 * 32 bits, so that 1 is exact. coef_t is a 16-bit mantissa and two shifts; the product with a
 * num_t needs two 16 x 16 multiplications on a Cortex-M0+, which has no long multiply. Products
 * round towards minus infinity and are the same, bit for bit, on every core and compiler. Right
 * shifts of negative numbers are arithmetic (implementation-defined in C11; so in gcc and clang).
 * In an image for one motor the compiler knows the shifts of most (coefficients.h).
 *
 * A number must never leave -32...32. Factors are limited before their product (num_headroom), with
 * limits that follow from the gains at start-up; a gain that leaves none is refused there.
 * How that is shown: preset sil-sanitize checks each sum, product, shift and conversion, and the
 * first result that does not fit ends the program. The sanitizer checks plain operators. What
 * converts a long product to 32 bits it cannot see: that states its own condition, NUM_HEADROOM.
 * Under these checks run all unit tests, among them tests/unit/test_headroom.c, every law in
 * motion, with a load and with samples at their ends, and the experiments of the test headroom. So
 * it is a proof by test: of the values that occur there, not of every value. Not checked are angles
 * and num_add_around, which are meant to go round.
 */
#ifndef STEADYSTEP_NUM_H
#define STEADYSTEP_NUM_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/rare.h"

#define NUM_FLOAT  1
#define NUM_FIXED  2
#define NUM_DOUBLE 3

#ifndef STEADYSTEP_NUM
#error "STEADYSTEP_NUM must be NUM_FLOAT, NUM_FIXED or NUM_DOUBLE"
#endif

/* NUM_FORMAT: the format's name, as a token. */
#if STEADYSTEP_NUM == NUM_FIXED

#ifdef STEADYSTEP_COEFFICIENT_SHIFTS
#include STEADYSTEP_COEFFICIENT_SHIFTS
#define NUM_FORMAT one_motor
#else
#define NUM_FORMAT fixed
#endif

typedef int32_t num_t;
typedef int32_t unit_t;
typedef double num_real; /* of the background; the core has doubles in software, for its design */
typedef struct {
    _Alignas(4) int16_t mantissa; /* value = mantissa 2^(left - right - 16) */
    uint8_t left;
    uint8_t right;
} coef_t;

#define NUM_FRACTION_BITS 26
#define NUM_MAX           32.0 /* magnitude a num_t must stay below */

/* A literal, folded by the compiler: no number is converted at run time. */
#define NUM(x)  ((num_t)((x)*67108864.0 + ((x) < 0 ? -0.5 : 0.5)))
#define UNIT(x) ((unit_t)((x)*32768.0 + ((x) < 0 ? -0.5 : 0.5)))

/*
 * What must hold of factors and product. Where it does not, STEADYSTEP_CHECK_HEADROOM is evaluated:
 * preset sil-sanitize defines it as a trap, test_num.c counts. In any other build it is nothing.
 */
#ifdef STEADYSTEP_CHECK_HEADROOM
#define NUM_HEADROOM(holds) ((holds) ? (void)0 : (void)(STEADYSTEP_CHECK_HEADROOM))
#else
#define NUM_HEADROOM(holds) ((void)0)
#endif
#define NUM_IS_32_BITS(x) ((x) >= INT32_MIN && (x) <= INT32_MAX)
#define NUM_IS_17_BITS(x) ((x) >= -65536 && (x) <= 65535)
#define NUM_IS_FACTOR(x)  ((x) >= -131072 && (x) <= 131072)

/* floor(a m / 2^16) */
static inline int32_t num_mul_high16(int32_t a, int16_t m)
{
#if defined(__ARM_ARCH_6M__)
    return (a >> 16) * m + (((a & 0xffff) * m) >> 16);
#elif defined(__ARM_FEATURE_DSP)
    int32_t product;

    __asm__("smulwb %0, %1, %2" : "=r"(product) : "r"(a), "r"(m));
    return product;
#else
    return (int32_t)(((int64_t)a * m) >> 16);
#endif
}

static inline int32_t num_shift_left(int32_t a, unsigned bits)
{
    NUM_HEADROOM(NUM_IS_32_BITS((int64_t)a * ((int64_t)1 << bits)));
    return (int32_t)((uint32_t)a << bits);
}

/* floor(a u / 2^15); a u just above one, as rounding leaves it in a sum of angles, is welcome. */
static inline num_t num_mul_unit(num_t a, unit_t u)
{
    NUM_HEADROOM(NUM_IS_32_BITS(((int64_t)a * u) >> 15) && NUM_IS_17_BITS(u));
#if defined(__ARM_ARCH_6M__)
    return (num_t)((uint32_t)(a >> 15) * (uint32_t)u + (uint32_t)(((a & 0x7fff) * u) >> 15));
#else
    return (num_t)(((int64_t)a * u) >> 15);
#endif
}

/* ..._nearest rounds to nearest: a sum of steps that little calls back would walk away by floor. */
static inline num_t num_mul_unit_nearest(num_t a, unit_t u)
{
    NUM_HEADROOM(NUM_IS_32_BITS(((int64_t)a * u + 0x4000) >> 15) && NUM_IS_17_BITS(u));
#if defined(__ARM_ARCH_6M__)
    return (num_t)((uint32_t)(a >> 15) * (uint32_t)u +
                   (uint32_t)(((a & 0x7fff) * u + 0x4000) >> 15));
#else
    return (num_t)(((int64_t)a * u + 0x4000) >> 15);
#endif
}

/* A gain as one word, loaded at once: the mantissa, `left` from bit 16 on, `right` from bit 24 on.
 */
static inline uint32_t coef_word(coef_t k)
{
    const union {
        coef_t coef;
        uint32_t word;
    } gain = {k};

    return gain.word;
}

/*
 * In an image for one motor the compiler knows most shifts. In other Arm code a shift takes its
 * count from the lowest byte of a register, whatever stands above it.
 */
static inline num_t num_mul_coef(num_t a, coef_t k)
{
#if defined(STEADYSTEP_COEFFICIENT_SHIFTS)
    return num_shift_left(num_mul_high16(a, k.mantissa), k.left) >> k.right;
#elif defined(__ARM_ARCH_6M__)
    const uint32_t gain = coef_word(k);
    int32_t product = a >> 16;
    int32_t mantissa = (int16_t)gain;
    int32_t low = a & 0xffff;
    uint32_t count = gain >> 16;

    product = product * mantissa + ((low * mantissa) >> 16);
#if defined(__arm__)
    __asm__(".syntax unified\n\tlsls %0, %0, %1\n\tlsrs %1, %1, #8\n\tasrs %0, %0, %1"
            : "+l"(product), "+l"(count)
            :
            : "cc");
    return product;
#else /* the product is tested on the host, too */
    return num_shift_left(product, count & 0xffu) >> (count >> 8);
#endif
#elif defined(__ARM_FEATURE_DSP)
    const uint32_t gain = coef_word(k);
    int32_t product;
    uint32_t count = gain >> 16;

    __asm__("smulwb %0, %1, %2" : "=r"(product) : "r"(a), "r"(gain));
    __asm__("lsl %0, %0, %1\n\tlsr %1, %1, #8\n\tasr %0, %0, %1" : "+r"(product), "+r"(count));
    return product;
#else
    return num_shift_left(num_mul_high16(a, k.mantissa), k.left) >> k.right;
#endif
}

/* k (1 + more), for |more| < 1 and a gain below 2^14. */
static inline coef_t coef_more(coef_t k, num_t more)
{
    const int32_t factor = (more >> (NUM_FRACTION_BITS - 15)) + (1 << 15);
    int32_t mantissa = (k.mantissa * factor + (1 << 14)) >> 15;

#ifdef STEADYSTEP_COEFFICIENT_SHIFTS /* what is changed in operation has been left room for it */
    mantissa = mantissa > INT16_MAX ? INT16_MAX : mantissa < -INT16_MAX ? -INT16_MAX : mantissa;
#endif
    if (mantissa > INT16_MAX || mantissa < INT16_MIN) {
        mantissa = (mantissa + 1) >> 1;
        if (k.right > 0u) {
            k.right--;
        } else {
            k.left++;
        }
    }
    k.mantissa = (int16_t)mantissa;
    return k;
}

static inline num_t num_mul_coef_nearest(num_t a, coef_t k)
{
    const num_t half = (num_t)((1u << k.right) >> 1);

    return (num_shift_left(num_mul_high16(a, k.mantissa), k.left) + half) >> k.right;
}

/*
 * Of a gain more may be known. A large one is never shifted to the right: below a quarter it has
 * fewer digits. A small one, below a half, is never shifted to the left. Each saves two
 * instructions of a dozen. In an image for one motor either may have any shift, and the compiler
 * knows it.
 */
#if defined(STEADYSTEP_COEFFICIENT_SHIFTS) || !defined(__arm__)
#define COEF_MANTISSA(k) ((k).mantissa)
#define COEF_LEFT(k)     ((k).left)
#define COEF_RIGHT(k)    ((k).right)
#else
#define COEF_MANTISSA(k) ((int16_t)coef_word(k))
#define COEF_LEFT(k)     (coef_word(k) >> 16)
#define COEF_RIGHT(k)    (coef_word(k) >> 24)
#endif

static inline num_t num_mul_large(num_t a, coef_t k)
{
#if defined(STEADYSTEP_COEFFICIENT_SHIFTS)
    return num_mul_coef(a, k);
#else
    NUM_HEADROOM(k.right == 0u);
    return num_shift_left(num_mul_high16(a, COEF_MANTISSA(k)), COEF_LEFT(k));
#endif
}

static inline num_t num_mul_small(num_t a, coef_t k)
{
#if defined(STEADYSTEP_COEFFICIENT_SHIFTS)
    return num_mul_coef(a, k);
#else
    NUM_HEADROOM(k.left == 0u);
    return num_mul_high16(a, COEF_MANTISSA(k)) >> COEF_RIGHT(k);
#endif
}

static inline num_t num_mul_small_nearest(num_t a, coef_t k)
{
#if defined(STEADYSTEP_COEFFICIENT_SHIFTS)
    return num_mul_coef_nearest(a, k);
#else
    const num_t twice = num_shift_left(num_mul_high16(a, COEF_MANTISSA(k)), 1);

    NUM_HEADROOM(k.left == 0u);
    return ((twice >> COEF_RIGHT(k)) + 1) >> 1;
#endif
}

/*
 * The product of two run-time quantities. The second counts with a resolution of 6e-5, and within
 * -8...8: floor(a floor(2^14 b) / 2^14).
 */
static inline num_t num_mul(num_t a, num_t b)
{
    const int32_t factor = b >> (NUM_FRACTION_BITS - 14);

    NUM_HEADROOM(NUM_IS_32_BITS(((int64_t)a * factor) >> 14) && NUM_IS_FACTOR(factor));
#if defined(__ARM_ARCH_6M__)
    return (num_t)((uint32_t)(a >> 14) * (uint32_t)factor +
                   (uint32_t)(((a & 0x3fff) * factor) >> 14));
#else
    return (num_t)(((int64_t)a * factor) >> 14);
#endif
}

/* The same to nearest. */
static inline num_t num_mul_nearest(num_t a, num_t b)
{
    const int32_t factor = b >> (NUM_FRACTION_BITS - 14);

    NUM_HEADROOM(NUM_IS_32_BITS(((int64_t)a * factor + 0x2000) >> 14) && NUM_IS_FACTOR(factor));
#if defined(__ARM_ARCH_6M__)
    return (num_t)((uint32_t)(a >> 14) * (uint32_t)factor +
                   (uint32_t)(((a & 0x3fff) * factor + 0x2000) >> 14));
#else
    return (num_t)(((int64_t)a * factor + 0x2000) >> 14);
#endif
}

static inline unit_t unit_mul(unit_t a, unit_t b)
{
    return (a * b) >> 15;
}

static inline unit_t unit_from_num(num_t a)
{
    return a >> (NUM_FRACTION_BITS - 15);
}

static inline num_t num_from_unit(unit_t u)
{
    return num_shift_left(u, NUM_FRACTION_BITS - 15);
}

static inline num_t num_half(num_t a)
{
    return a >> 1;
}

/* A sum that may run on and on while nobody asks for it: beyond the range it goes round. */
static inline num_t num_add_around(num_t a, num_t b)
{
    return (num_t)((uint32_t)a + (uint32_t)b);
}

/* A raw converter code, less than 2^16 in magnitude, times a large gain: of one product. */
static inline num_t num_from_code(int32_t code, coef_t k)
{
    NUM_HEADROOM(code > -65536 && code < 65536);
#if defined(STEADYSTEP_COEFFICIENT_SHIFTS)
    return num_shift_left((code * k.mantissa) >> 6, k.left) >> k.right;
#else
    NUM_HEADROOM(k.right == 0u);
    return num_shift_left((code * COEF_MANTISSA(k)) >> 6, COEF_LEFT(k));
#endif
}

/* A sum of codes, less than 2^21 in magnitude. */
static inline num_t num_from_code_sum(int32_t sum, coef_t k)
{
    return num_mul_coef(num_shift_left(sum, 10), k);
}

/* The gain of num_from_code is stated per code; this is the factor hidden in the format. */
#define NUM_CODE_SCALE 65536.0

/* a k as a whole number of timer counts, rounded to nearest; k is small. */
static inline int32_t counts_from_num(num_t a, coef_t k)
{
    return (num_mul_small(a, k) + (1 << 9)) >> 10;
}

/* The gain of counts_from_num is stated in counts; this is the factor hidden in the format. */
#define NUM_COUNT_SCALE (1.0 / 65536.0)

/* x < 0 ? 0 : sqrt(x); 16 significant bits. */
num_t num_sqrt(num_t x);

static inline num_t num_abs(num_t a)
{
    return a < 0 ? -a : a;
}

/* Left minus right is `shift`. */
static inline coef_t coef_with_shift(int16_t mantissa, int shift)
{
    const coef_t known = {.mantissa = mantissa,
                          .left = (uint8_t)(shift > 0 ? shift : 0),
                          .right = (uint8_t)(shift < 0 ? -shift : 0)};
    return known;
}

/* The nearest gain with this shift; saturates. */
coef_t coef_of_shift(double x, int shift);

#else /* floating point */

#if STEADYSTEP_NUM == NUM_FLOAT
#define NUM_FORMAT float
#define NUM_ABS    __builtin_fabsf
typedef float num_t;
typedef float num_real; /* of the background: what the core counts in by itself */
#define NUM(x)     ((float)(x))
#elif STEADYSTEP_NUM == NUM_DOUBLE
#define NUM_FORMAT double
#define NUM_ABS    __builtin_fabs
typedef double num_t;
typedef double num_real;
#define NUM(x)     ((double)(x))
#else
#error "unknown STEADYSTEP_NUM"
#endif

typedef num_t unit_t;
typedef num_t coef_t;
#define UNIT(x) NUM(x)
#define NUM_MAX 1e30

static inline num_t num_mul_unit(num_t a, unit_t u)
{
    return a * u;
}

static inline num_t num_mul_unit_nearest(num_t a, unit_t u)
{
    return a * u;
}

static inline num_t num_mul_coef(num_t a, coef_t k)
{
    return a * k;
}

static inline num_t num_mul_coef_nearest(num_t a, coef_t k)
{
    return a * k;
}

static inline num_t num_mul_large(num_t a, coef_t k)
{
    return a * k;
}

static inline num_t num_mul_small(num_t a, coef_t k)
{
    return a * k;
}

static inline num_t num_mul_small_nearest(num_t a, coef_t k)
{
    return a * k;
}

static inline coef_t coef_more(coef_t k, num_t more)
{
    return k + k * more;
}

static inline num_t num_mul(num_t a, num_t b)
{
    return a * b;
}

static inline num_t num_mul_nearest(num_t a, num_t b)
{
    return a * b;
}

static inline unit_t unit_mul(unit_t a, unit_t b)
{
    return a * b;
}

static inline unit_t unit_from_num(num_t a)
{
    return a;
}

static inline num_t num_from_unit(unit_t u)
{
    return u;
}

static inline num_t num_half(num_t a)
{
    return a * NUM(0.5);
}

static inline num_t num_add_around(num_t a, num_t b)
{
    return a + b;
}

static inline num_t num_from_code(int32_t code, coef_t k)
{
    return (num_t)code * k;
}

static inline num_t num_from_code_sum(int32_t sum, coef_t k)
{
    return (num_t)sum * k;
}

#define NUM_CODE_SCALE 1.0

/* Towards zero, saturated, a NaN to zero: what the FPU of the Cortex-M4 does, on every core. */
static inline int32_t num_to_int32(num_t a)
{
#if defined(__ARM_FP) && STEADYSTEP_NUM == NUM_FLOAT
    int32_t whole;

    __asm__("vcvt.s32.f32 %0, %1" : "=t"(whole) : "t"(a));
    return whole;
#else
    if (a >= NUM(2147483648.0)) {
        return INT32_MAX;
    }
    if (a < NUM(-2147483648.0)) {
        return INT32_MIN;
    }
    return a == a ? (int32_t)a : 0;
#endif
}

/*
 * Fractions in 2^-32 of one, the same rounding and saturation. The Cortex-M4 scales by a power of
 * two as it converts; gcc finds that instruction only where the factor is not shared.
 */
static inline int32_t num_to_2_32(num_t a)
{
#if defined(__ARM_FP) && STEADYSTEP_NUM == NUM_FLOAT
    union {
        num_t number;
        int32_t whole;
    } x = {.number = a};

    __asm__("vcvt.s32.f32 %0, %0, #32" : "+t"(x.number));
    return x.whole;
#else
    return num_to_int32(a * NUM(4294967296.0));
#endif
}

static inline num_t num_from_2_32(int32_t a)
{
#if defined(__ARM_FP) && STEADYSTEP_NUM == NUM_FLOAT
    union {
        int32_t whole;
        num_t number;
    } x = {.whole = a};

    __asm__("vcvt.f32.s32 %0, %0, #32" : "+t"(x.number));
    return x.number;
#else
    return (num_t)a * NUM(1.0 / 4294967296.0);
#endif
}

/* To nearest, a half to the even number; saturated, a NaN to zero. */
static inline int32_t num_to_nearest(num_t a)
{
#if defined(__ARM_FP) && STEADYSTEP_NUM == NUM_FLOAT
    int32_t whole;

    __asm__("vcvtr.s32.f32 %0, %1" : "=t"(whole) : "t"(a));
    return whole;
#else
    const int32_t whole = num_to_int32(a);
    const num_t rest = NUM_ABS(a - (num_t)whole);

    /* A number of 2^23 and more has no fraction in float. */
    if (!(NUM_ABS(a) < NUM(8388608.0)) || rest < NUM(0.5) || (rest == NUM(0.5) && whole % 2 == 0)) {
        return whole;
    }
    return a < NUM(0.0) ? whole - 1 : whole + 1;
#endif
}

static inline int32_t counts_from_num(num_t a, coef_t k)
{
    return num_to_nearest(a * k);
}

#define NUM_COUNT_SCALE 1.0

num_t num_sqrt(num_t x);

/* Clears the sign: one instruction, and a NaN stays one. */
static inline num_t num_abs(num_t a)
{
    return NUM_ABS(a);
}

#endif

/* A NaN becomes the lower bound. */
static inline num_t num_at_least(num_t a, num_t low)
{
    return a > low ? a : low;
}

/* Both comparisons are false for a NaN, which becomes the upper bound: nothing undefined later. */
static inline num_t num_clamp(num_t a, num_t low, num_t high)
{
    return num_at_least(a < high ? a : high, low);
}

/* -limit...limit, for a limit above zero; a NaN becomes the lower bound. */
static inline num_t num_limit(num_t a, num_t limit)
{
    if (RARE(!(num_abs(a) < limit))) {
        return a > NUM(0.0) ? limit : -limit;
    }
    return a;
}

/* A gain that 16 bits are too coarse for: k and what it leaves over. */
static inline num_t num_mul_coef_fine(num_t a, coef_t k, coef_t remainder)
{
#if STEADYSTEP_NUM == NUM_FIXED
    return num_mul_coef(a, k) + num_mul_coef(a, remainder);
#else
    (void)remainder;
    return num_mul_coef(a, k);
#endif
}

/* Keeps a factor small enough for its product to fit; floating point has room enough. */
static inline num_t num_headroom(num_t a, num_t limit)
{
#if STEADYSTEP_NUM == NUM_FIXED
    return num_limit(a, limit);
#else
    (void)limit;
    return a;
#endif
}

/* ---- Start-up and telemetry only: conversions from and to double. ---- */

num_t num_from_double(double x); /* saturates at NUM_MAX */
double num_to_double(num_t x);
/* Nearest representable gain; saturates. In fixed point |x| < 2^15, relative error <= 2^-15. */
coef_t coef_from_double(double x);
coef_t coef_large_from_double(double x); /* |x| < 2^15, error <= 2^-15 of it or 2^-17 */
coef_t coef_small_from_double(double x); /* saturates below a half */
double coef_to_double(coef_t k);
/* The bits of a value, for hashes: 32 of float and fixed point, the upper 32 of double folded in.
 */
uint32_t num_bits(num_t x);
uint32_t coef_bits(coef_t k);

#endif
