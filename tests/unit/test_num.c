/*
 * Arithmetic of the three number formats. Float and double answer for being what the interface
 * says; fixed point is compared bit for bit with 64-bit integers.
 */
#include <unity.h>

/* Here an overflow that the casts of fixed point do not show is counted. */
static int overflows;
#undef STEADYSTEP_CHECK_HEADROOM
#define STEADYSTEP_CHECK_HEADROOM overflows++

#include "firmware/design/elementary.h"
#include "firmware/numeric/num.h"

void setUp(void)
{
    overflows = 0;
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, overflows,
                                  "a product that fits is taken for one that does not");
}

/* Pseudo-random bits (xorshift, Marsaglia 2003), the same on every machine. */
static uint64_t random_state;

static uint32_t random_bits(void)
{
    random_state ^= random_state << 13;
    random_state ^= random_state >> 7;
    random_state ^= random_state << 17;
    return (uint32_t)(random_state >> 32);
}

static double random_within(double limit)
{
    return ((double)random_bits() / 2147483648.0 - 1.0) * limit;
}

/* Weight of the last bit of a result of the given magnitude. */
static double resolution(double x)
{
#if STEADYSTEP_NUM == NUM_FIXED
    (void)x;
    return 1.0 / 67108864.0;
#elif STEADYSTEP_NUM == NUM_FLOAT
    return (magnitude(x) + 1e-9) / 8388608.0;
#else
    return (magnitude(x) + 1e-9) / 4503599627370496.0;
#endif
}

#if STEADYSTEP_NUM == NUM_FIXED
#define UNIT_ROUNDING (1.0 / 32768.0)
#else
#define UNIT_ROUNDING 0.0
#endif

#if STEADYSTEP_NUM == NUM_FIXED

static const int32_t extremes[] = {INT32_MIN,  INT32_MIN + 1, -65537,   -65536, -65535, -32769,
                                   -32768,     -32767,        -2,       -1,     0,      1,
                                   2,          32767,         32768,    65535,  65536,  65537,
                                   0x40000000, INT32_MAX - 1, INT32_MAX};
enum { EXTREMES = sizeof extremes / sizeof extremes[0] };

/* floor(a / 2^bits), without a shift of a negative number. */
static int64_t floor_of(int64_t a, unsigned bits)
{
    int64_t divisor = (int64_t)1 << bits;

    return a / divisor - (a % divisor < 0 ? 1 : 0);
}

/* Of the second factor 14 bits of the fraction count, and it is at most 8 in magnitude. */
static void product_is_the_floor_with_a_coarse_second(int32_t a, int32_t b)
{
    int64_t product = floor_of((int64_t)a * floor_of(b, NUM_FRACTION_BITS - 14), 14);

    if (product >= INT32_MIN && product <= INT32_MAX) {
        TEST_ASSERT_EQUAL_INT32((int32_t)product, num_mul(a, b));
    }
    if (product >= INT32_MIN && product < INT32_MAX) { /* to nearest may be one more */
        TEST_ASSERT_EQUAL_INT32(
            floor_of((int64_t)a * floor_of(b, NUM_FRACTION_BITS - 14) + 0x2000, 14),
            num_mul_nearest(a, b));
    }
}

static void test_a_product_is_the_floor_with_a_coarse_second_factor(void)
{
    random_state = 1;
    for (int i = 0; i < EXTREMES; i++) {
        for (int j = 0; j < EXTREMES; j++) {
            product_is_the_floor_with_a_coarse_second(extremes[i], extremes[j] >> 2);
        }
    }
    for (int i = 0; i < 1000000; i++) {
        /* Either factor gets every magnitude. */
        int32_t a = (int32_t)random_bits() >> (random_bits() % 32u);
        int32_t b = (int32_t)random_bits() >> (4u + random_bits() % 28u);

        product_is_the_floor_with_a_coarse_second(a, b);
    }
    TEST_ASSERT_EQUAL_INT32(NUM(31.5), num_mul(NUM(31.5), NUM(1.0)));
    TEST_ASSERT_EQUAL_INT32(NUM(-31.5), num_mul(NUM(31.5), NUM(-1.0)));
}

static void test_the_upper_half_of_a_16_bit_product_is_its_floor(void)
{
    random_state = 2;
    for (int i = 0; i < EXTREMES; i++) {
        for (int32_t m = INT16_MIN; m <= INT16_MAX; m++) {
            TEST_ASSERT_EQUAL_INT32((int32_t)floor_of((int64_t)extremes[i] * m, 16),
                                    num_mul_high16(extremes[i], (int16_t)m));
        }
    }
    for (int i = 0; i < 1000000; i++) {
        int32_t a = (int32_t)random_bits();
        int16_t m = (int16_t)(random_bits() & 0xffffu);

        TEST_ASSERT_EQUAL_INT32((int32_t)floor_of((int64_t)a * m, 16), num_mul_high16(a, m));
    }
}

static void test_a_gain_is_rounded_down_once_and_shifted(void)
{
    random_state = 3;
    for (int i = 0; i < 1000000; i++) {
        int32_t a = (int32_t)random_bits();
        coef_t k = {.mantissa = (int16_t)(random_bits() & 0xffffu)};
        int64_t high = floor_of((int64_t)a * k.mantissa, 16);
        unsigned shift = random_bits() % 16u;

        if ((random_bits() & 1u) != 0u) {
            k.right = (uint8_t)shift;
            TEST_ASSERT_EQUAL_INT32((int32_t)floor_of(high, shift), num_mul_coef(a, k));
        } else if (high * (1 << shift) >= INT32_MIN && high * (1 << shift) <= INT32_MAX) {
            k.left = (uint8_t)shift;
            TEST_ASSERT_EQUAL_INT32((int32_t)(high * (1 << shift)), num_mul_coef(a, k));
        }
    }
}

/* The kinds of gain, and products of codes: the same as of a gain of any kind, to the last bit. */
static void test_products_of_a_large_and_a_small_gain_are_those_of_any_gain(void)
{
    random_state = 8;
    for (int i = 0; i < 1000000; i++) {
        const int32_t a = (int32_t)random_bits() >> (random_bits() % 32u);
        const int16_t mantissa = (int16_t)(random_bits() % 65535u - 32767u);
        const unsigned shift = random_bits() % 16u;
        const coef_t large = {.mantissa = mantissa, .left = (uint8_t)shift};
        const coef_t small = {.mantissa = mantissa, .right = (uint8_t)shift};
        const int64_t product = floor_of((int64_t)a * mantissa, 16) * ((int64_t)1 << shift);

        if (product >= INT32_MIN && product <= INT32_MAX) {
            TEST_ASSERT_EQUAL_INT32((int32_t)product, num_mul_large(a, large));
        }
        TEST_ASSERT_EQUAL_INT32(num_mul_coef(a, small), num_mul_small(a, small));
        TEST_ASSERT_EQUAL_INT32(num_mul_coef_nearest(a, small), num_mul_small_nearest(a, small));
    }
}

static void test_a_code_times_a_gain_is_its_floor_shifted(void)
{
    for (int32_t code = -65535; code <= 65535; code++) {
        const coef_t k = {.mantissa = (int16_t)(code % 2 == 0 ? 32767 : -16384 - code % 997)};

        TEST_ASSERT_EQUAL_INT32((int32_t)floor_of((int64_t)code * k.mantissa, 6),
                                num_from_code(code, k));
        if (code >= -4096 && code < 4096) {
            const coef_t shifted = {.mantissa = k.mantissa, .left = 4u};

            TEST_ASSERT_EQUAL_INT32((int32_t)floor_of((int64_t)code * k.mantissa, 6) * 16,
                                    num_from_code(code, shifted));
        }
    }
}

static void test_a_gain_of_a_kind_is_never_shifted_to_the_other_side(void)
{
    for (double gain = 30000.0; gain > 1e-8; gain *= 0.73) {
        const coef_t large = coef_large_from_double(-gain);
        const coef_t small = coef_small_from_double(gain);

        TEST_ASSERT_EQUAL_UINT8(0, large.right);
        TEST_ASSERT_EQUAL_UINT8(0, small.left);
        TEST_ASSERT_DOUBLE_WITHIN(gain / 32768.0 + 0.5 / 65536.0, -gain, coef_to_double(large));
        if (gain < 32767.0 / 65536.0) {
            TEST_ASSERT_DOUBLE_WITHIN(gain / 32768.0, gain, coef_to_double(small));
        } else {
            TEST_ASSERT_EQUAL_DOUBLE(32767.0 / 65536.0, coef_to_double(small));
        }
    }
}

static void ratio_is_the_floor_of_the_exact_one(int32_t a, int32_t u)
{
    int64_t product = floor_of((int64_t)a * u, 15);

    if (product >= INT32_MIN && product <= INT32_MAX) {
        TEST_ASSERT_EQUAL_INT32((int32_t)product, num_mul_unit(a, u));
    }
}

static void test_a_ratio_is_the_floor_of_the_exact_one(void)
{
    random_state = 4;
    for (int i = 0; i < EXTREMES; i++) {
        /* sincos_add may leave one by some bits. */
        for (int32_t u = -32780; u <= 32780; u++) {
            ratio_is_the_floor_of_the_exact_one(extremes[i], u);
        }
    }
    for (int i = 0; i < 1000000; i++) {
        int32_t a = (int32_t)random_bits();

        ratio_is_the_floor_of_the_exact_one(a, (int32_t)(random_bits() % 65537u) - 32768);
    }
    TEST_ASSERT_EQUAL_INT32(NUM(-31.5), num_mul_unit(NUM(31.5), UNIT(-1.0)));
    TEST_ASSERT_EQUAL_INT32(NUM(31.5), num_mul_unit(NUM(31.5), UNIT(1.0)));
}

/* The number of overflows since the last time. */
static int new_overflows(void)
{
    const int counted = overflows;

    overflows = 0;
    return counted;
}

#ifndef __arm__
static void test_a_product_that_does_not_fit_is_seen(void)
{
    const coef_t two = {.mantissa = INT16_MAX, .left = 2u};

    (void)num_mul(NUM(20.0), NUM(-1.8));
    TEST_ASSERT_TRUE(new_overflows() > 0);
    (void)num_mul_nearest(NUM(20.0), NUM(1.8));
    TEST_ASSERT_TRUE(new_overflows() > 0);
    (void)num_mul_unit(INT32_MIN, UNIT(-1.0));
    TEST_ASSERT_TRUE(new_overflows() > 0);
    (void)num_mul_unit_nearest(NUM(31.99), UNIT(1.001));
    TEST_ASSERT_TRUE(new_overflows() > 0);
    (void)num_mul_coef(NUM(16.1), two);
    TEST_ASSERT_TRUE(new_overflows() > 0);
    (void)num_mul_coef_nearest(NUM(-16.1), two);
    TEST_ASSERT_TRUE(new_overflows() > 0);
    (void)num_from_unit(UNIT(32.0));
    TEST_ASSERT_TRUE(new_overflows() > 0);
    (void)num_from_code_sum(1 << 21, two);
    TEST_ASSERT_TRUE(new_overflows() > 0);
    (void)num_mul_large(NUM(16.1), two);
    TEST_ASSERT_TRUE(new_overflows() > 0);
    (void)num_from_code(-65536, (coef_t){.mantissa = 1});
    TEST_ASSERT_TRUE(new_overflows() > 0);
    (void)num_from_code(65535, (coef_t){.mantissa = INT16_MAX, .left = 7u});
    TEST_ASSERT_TRUE(new_overflows() > 0);
}
#endif

/* The product fits, but the short multiplications of a Cortex-M0+ do not. */
static void test_a_second_factor_too_large_for_a_short_multiplication_is_seen(void)
{
    (void)num_mul(NUM(1.0), NUM(8.001));
    TEST_ASSERT_TRUE(new_overflows() > 0);
    (void)num_mul_nearest(NUM(1.0), NUM(-8.001));
    TEST_ASSERT_TRUE(new_overflows() > 0);
    (void)num_mul_unit(NUM(1.0), UNIT(2.0));
    TEST_ASSERT_TRUE(new_overflows() > 0);
    (void)num_mul_unit_nearest(NUM(1.0), UNIT(-2.1));
    TEST_ASSERT_TRUE(new_overflows() > 0);
}

#ifndef STEADYSTEP_COEFFICIENT_SHIFTS /* where a gain of either kind may have any shift */
static void test_a_gain_of_the_other_kind_is_seen(void)
{
    const coef_t small = {.mantissa = INT16_MAX, .right = 1u};
    const coef_t large = {.mantissa = INT16_MAX, .left = 1u};

    (void)num_mul_large(NUM(1.0), small);
    TEST_ASSERT_TRUE(new_overflows() > 0);
    (void)num_from_code(1, small);
    TEST_ASSERT_TRUE(new_overflows() > 0);
    (void)num_mul_small(NUM(1.0), large);
    TEST_ASSERT_TRUE(new_overflows() > 0);
    (void)num_mul_small_nearest(NUM(1.0), large);
    TEST_ASSERT_TRUE(new_overflows() > 0);
}
#endif

static void test_what_is_meant_to_go_round_is_none(void)
{
    TEST_ASSERT_EQUAL_INT32(INT32_MIN + 4, num_add_around(INT32_MAX, 5));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX - 4, num_add_around(INT32_MIN, -5));
}

static void test_a_product_of_ratios_is_the_floor_of_the_exact_one(void)
{
    random_state = 11;
    for (int i = 0; i < 1000000; i++) {
        int32_t u = (int32_t)(random_bits() % 65537u) - 32768;
        int32_t w = (int32_t)(random_bits() % 65537u) - 32768;

        TEST_ASSERT_EQUAL_INT32((int32_t)floor_of((int64_t)u * w, 15), unit_mul(u, w));
    }
    TEST_ASSERT_EQUAL_INT32(UNIT(1.0), unit_mul(UNIT(-1.0), UNIT(-1.0)));
    TEST_ASSERT_EQUAL_INT32(UNIT(-1.0), unit_mul(UNIT(1.0), UNIT(-1.0)));
}

static void test_halves_and_ratios_are_floors(void)
{
    TEST_ASSERT_EQUAL_INT32(-1, num_half(-1));
    TEST_ASSERT_EQUAL_INT32(0, num_half(1));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN / 2, num_half(INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(-1, unit_from_num(-1));
    TEST_ASSERT_EQUAL_INT32(UNIT(1.0), unit_from_num(NUM(1.0)));
}

static void test_literals_are_rounded_to_the_nearest(void)
{
    TEST_ASSERT_EQUAL_INT32(1 << 26, NUM(1.0));
    TEST_ASSERT_EQUAL_INT32(-(1 << 26), NUM(-1.0));
    TEST_ASSERT_EQUAL_INT32(6710886, NUM(0.1));
    TEST_ASSERT_EQUAL_INT32(-6710886, NUM(-0.1));
    TEST_ASSERT_EQUAL_INT32(1, NUM(0.6 / 67108864.0));
    TEST_ASSERT_EQUAL_INT32(-1, NUM(-0.6 / 67108864.0));
    TEST_ASSERT_EQUAL_INT32(32768, UNIT(1.0));
    TEST_ASSERT_EQUAL_INT32(-23170, UNIT(-0.70710678));
}

static void test_conversions_saturate_and_a_nan_is_a_number(void)
{
    static const double beyond[] = {32.0, 33.0, 1e9, 1e300};

    for (unsigned i = 0; i < sizeof beyond / sizeof beyond[0]; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 32.0, num_to_double(num_from_double(beyond[i])));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, -32.0, num_to_double(num_from_double(-beyond[i])));
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 32.0, num_to_double(num_from_double(__builtin_inf())));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -32.0, num_to_double(num_from_double(-__builtin_inf())));
    TEST_ASSERT_TRUE(magnitude(num_to_double(num_from_double(__builtin_nan("")))) <= 32.0);
    TEST_ASSERT_EQUAL_INT32(NUM(31.999), num_from_double(31.999));

    TEST_ASSERT_EQUAL_DOUBLE(32767.0, coef_to_double(coef_from_double(1e9)));
    TEST_ASSERT_EQUAL_DOUBLE(-32767.0, coef_to_double(coef_from_double(-1e9)));
    TEST_ASSERT_TRUE(magnitude(coef_to_double(coef_from_double(__builtin_nan("")))) <= 32767.0);
}

static void test_only_a_gain_of_16_bits_is_kept(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(0.75, coef_to_double(coef_from_double(0.75)));
    TEST_ASSERT_EQUAL_DOUBLE(-3.0, coef_to_double(coef_from_double(-3.0)));
    TEST_ASSERT_EQUAL_DOUBLE(1.0, coef_to_double(coef_from_double(0.999999)));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, coef_to_double(coef_from_double(1e-12)));
}

#else

static void test_a_nan_becomes_the_upper_bound(void)
{
    TEST_ASSERT_TRUE(num_clamp((num_t)__builtin_nan(""), NUM(-2.0), NUM(3.0)) == NUM(3.0));
    TEST_ASSERT_TRUE(num_clamp((num_t)__builtin_inf(), NUM(-2.0), NUM(3.0)) == NUM(3.0));
    TEST_ASSERT_TRUE(num_clamp(-(num_t)__builtin_inf(), NUM(-2.0), NUM(3.0)) == NUM(-2.0));
}

static void test_a_limit_holds_an_infinity_and_turns_a_nan_into_the_lower_bound(void)
{
    TEST_ASSERT_TRUE(num_limit((num_t)__builtin_inf(), NUM(3.0)) == NUM(3.0));
    TEST_ASSERT_TRUE(num_limit(-(num_t)__builtin_inf(), NUM(3.0)) == NUM(-3.0));
    TEST_ASSERT_TRUE(num_limit((num_t)__builtin_nan(""), NUM(3.0)) == NUM(-3.0));
    TEST_ASSERT_TRUE(num_limit(-(num_t)__builtin_nan(""), NUM(3.0)) == NUM(-3.0));
}

static void test_a_magnitude_has_no_sign_and_keeps_a_nan(void)
{
    num_t nothing = num_abs(-NUM(0.0));
    num_t nan = num_abs((num_t)__builtin_nan(""));

    TEST_ASSERT_TRUE(NUM(1.0) / nothing > NUM(0.0));
    TEST_ASSERT_TRUE(num_abs(-(num_t)__builtin_inf()) == (num_t)__builtin_inf());
    TEST_ASSERT_TRUE(nan != nan);
}

#endif

/* What counts of the second factor of a product. */
static double second_factor(double b)
{
#if STEADYSTEP_NUM == NUM_FIXED
    return (double)floor_of(num_from_double(b), NUM_FRACTION_BITS - 14) / 16384.0;
#else
    return b;
#endif
}

static void test_products_are_right_to_their_resolution(void)
{
    random_state = 5;
    for (int i = 0; i < 20000; i++) {
        double a = num_to_double(num_from_double(random_within(5.0)));
        double b = num_to_double(num_from_double(random_within(1.9999)));
        double u = b / 2.0;
        double w = a / 5.0;
        num_t x = num_from_double(a);

        TEST_ASSERT_DOUBLE_WITHIN(resolution(a * b), a * second_factor(b),
                                  num_to_double(num_mul(x, num_from_double(b))));
        u = num_to_double(num_from_unit(unit_from_num(num_from_double(u))));
        TEST_ASSERT_DOUBLE_WITHIN(
            resolution(a * u), a * u,
            num_to_double(num_mul_unit(x, unit_from_num(num_from_double(u)))));
        w = num_to_double(num_from_unit(unit_from_num(num_from_double(w))));
        TEST_ASSERT_DOUBLE_WITHIN(
            UNIT_ROUNDING + resolution(u * w), u * w,
            num_to_double(num_from_unit(
                unit_mul(unit_from_num(num_from_double(u)), unit_from_num(num_from_double(w))))));
        TEST_ASSERT_DOUBLE_WITHIN(resolution(a), a / 2.0, num_to_double(num_half(x)));
    }
}

static void test_a_gain_of_any_size_keeps_15_bits(void)
{
    random_state = 6;
    for (double size = 32767.0; size > 1e-9; size /= 1.7) {
        for (int i = 0; i < 200; i++) {
            double gain = size * (1.0 - 0.4 * (double)random_bits() / 4294967296.0);

            gain = (i % 2) == 0 ? gain : -gain;
            TEST_ASSERT_DOUBLE_WITHIN(magnitude(gain) / 32768.0, gain,
                                      coef_to_double(coef_from_double(gain)));
        }
    }
    TEST_ASSERT_EQUAL_DOUBLE(0.0, coef_to_double(coef_from_double(0.0)));
}

static void test_a_gain_applied_is_the_gain_asked_for(void)
{
    random_state = 7;
    for (double gain = 2000.0; gain > 1e-5; gain /= 2.3) {
        for (int i = 0; i < 100; i++) {
            double x =
                num_to_double(num_from_double(random_within(gain > 1.0 ? 30.0 / gain : 30.0)));
            /* A gain above one magnifies the last bits dropped: 16 bits below the product's top. */
            double last_bit = resolution(x * gain) * (gain > 1.0 ? 4.0 * gain : 2.0);

            TEST_ASSERT_DOUBLE_WITHIN(
                magnitude(x * gain) / 32768.0 + last_bit, x * gain,
                num_to_double(num_mul_coef(num_from_double(x), coef_from_double(gain))));
        }
    }
}

static void test_a_converter_code_becomes_a_number(void)
{
    /* 12-bit currents, the largest code the interface allows and the largest sum of codes. */
    const double current = 1.0 / 2048.0;
    const double middle = 1.0 / 65536.0;
    const double fine = 1.0 / 2097152.0;
    const coef_t per_code = coef_large_from_double(current * NUM_CODE_SCALE);
    const coef_t per_middle_code = coef_large_from_double(middle * NUM_CODE_SCALE);
    const coef_t per_fine_code = coef_from_double(fine * NUM_CODE_SCALE);

    for (int32_t code = -2048; code < 2048; code++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, code * current,
                                  num_to_double(num_from_code(code, per_code)));
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 65535 * middle,
                              num_to_double(num_from_code(65535, per_middle_code)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -65535 * middle,
                              num_to_double(num_from_code(-65535, per_middle_code)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2097151 * fine,
                              num_to_double(num_from_code_sum(2097151, per_fine_code)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -2097151 * fine,
                              num_to_double(num_from_code_sum(-2097151, per_fine_code)));
}

/* What the product is cut to before its last shift is less than a tenth of the resolution here. */
static void test_products_to_nearest_do_not_lean_to_either_side(void)
{
    static const double gains[] = {-0.03, 0.0101, -0.0013, 1.7e-4};
    double lean = 0.0;

    for (int g = 0; g < 4; g++) {
        const coef_t gain = coef_from_double(gains[g]);
        const double k = coef_to_double(gain);

        for (int i = -50; i < 50; i++) {
            const num_t a = num_from_double(0.01234567 * i + 0.0005);
            const double error =
                num_to_double(num_mul_coef_nearest(a, gain)) - k * num_to_double(a);
            const double limit = STEADYSTEP_NUM == NUM_FIXED ? 0.6 / 67108864.0 : 1e-7;

            TEST_ASSERT_DOUBLE_WITHIN(limit, 0.0, error);
            lean += error / 400.0;
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(STEADYSTEP_NUM == NUM_FIXED ? 0.1 / 67108864.0 : 1e-8, 0.0, lean);
}

/* Of two quantities, and of a quantity and a sine: the factors are exact here. */
static void test_products_of_quantities_to_nearest_do_not_lean_to_either_side(void)
{
    const double resolution = STEADYSTEP_NUM == NUM_FIXED ? 1.0 / 67108864.0 : 1e-7;
    double lean[2] = {0.0, 0.0};

    for (int i = -100; i < 100; i++) {
        const num_t a = num_from_double(0.01234567 * i + 0.0005);
        const double x = num_to_double(a);
        const double by_num = num_to_double(num_mul_nearest(a, NUM(0.34375))) - 0.34375 * x;
        const double by_unit = num_to_double(num_mul_unit_nearest(a, UNIT(0.40625))) - 0.40625 * x;

        TEST_ASSERT_DOUBLE_WITHIN(0.51 * resolution, 0.0, by_num);
        TEST_ASSERT_DOUBLE_WITHIN(0.51 * resolution, 0.0, by_unit);
        lean[0] += by_num / 200.0;
        lean[1] += by_unit / 200.0;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.1 * resolution, 0.0, lean[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.1 * resolution, 0.0, lean[1]);
}

/* k (1 + more), also where its mantissa grows by a bit. */
static void test_a_gain_is_changed_by_a_share(void)
{
    static const double gains[] = {1.0,  0.99,   0.75,    -0.99, 1e-3,
                                   31.9, 1000.0, 12000.0, -3e-4, 1.8e-3};
    static const double shares[] = {-0.45, -0.1, -1e-3, 0.0, 1e-3, 0.02, 0.1, 0.65};

    for (int g = 0; g < 10; g++) {
        for (int s = 0; s < 8; s++) {
            const coef_t gain = coef_from_double(gains[g]);
            const double expected = coef_to_double(gain) * (1.0 + shares[s]);
            const coef_t more = coef_more(gain, num_from_double(shares[s]));

            TEST_ASSERT_DOUBLE_WITHIN(fabs(expected) / 12000.0, expected, coef_to_double(more));
        }
    }
}

static void test_a_number_becomes_the_nearest_count(void)
{
    static const double counts[] = {4250.0, 2125.0, 32767.0};

    for (int i = 0; i < 3; i++) {
        const coef_t k = coef_small_from_double(counts[i] * NUM_COUNT_SCALE);

        for (double modulation = -0.92; modulation <= 0.92; modulation += 0.00037) {
            double exact = counts[i] * modulation;

            TEST_ASSERT_DOUBLE_WITHIN(0.501 + magnitude(exact) / 32768.0, exact,
                                      (double)counts_from_num(num_from_double(modulation), k));
        }
        TEST_ASSERT_EQUAL_INT32(0, counts_from_num(NUM(0.0), k));
    }
    const coef_t half_period = coef_small_from_double(4250.0 * NUM_COUNT_SCALE);

    TEST_ASSERT_EQUAL_INT32(2125, counts_from_num(NUM(0.5), half_period));
    TEST_ASSERT_EQUAL_INT32(-2125, counts_from_num(NUM(-0.5), half_period));
}

#if STEADYSTEP_NUM != NUM_FIXED
static void test_a_half_becomes_the_even_count(void)
{
    TEST_ASSERT_EQUAL_INT32(2, num_to_nearest(NUM(1.5)));
    TEST_ASSERT_EQUAL_INT32(2, num_to_nearest(NUM(2.5)));
    TEST_ASSERT_EQUAL_INT32(-2, num_to_nearest(NUM(-1.5)));
    TEST_ASSERT_EQUAL_INT32(-2, num_to_nearest(NUM(-2.5)));
    TEST_ASSERT_EQUAL_INT32(8388607, num_to_nearest(NUM(8388607.0)));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, num_to_nearest(NUM(1e10)));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, num_to_nearest(NUM(-1e10)));
    TEST_ASSERT_EQUAL_INT32(0, num_to_nearest((num_t)__builtin_nan("")));
}
#endif

static void test_a_square_root_keeps_16_bits(void)
{
    random_state = 8;
    for (double size = 30.0; size > 1e-7; size /= 1.9) {
        for (int i = 0; i < 500; i++) {
            double x = num_to_double(
                num_from_double(size * (1.0 - 0.5 * (double)random_bits() / 4294967296.0)));
            double root = num_to_double(num_sqrt(num_from_double(x)));

            TEST_ASSERT_DOUBLE_WITHIN(x / 16384.0 + 2.0 * root * resolution(root), x, root * root);
        }
    }
    TEST_ASSERT_TRUE(num_sqrt(NUM(4.0)) == NUM(2.0));
#if STEADYSTEP_NUM == NUM_FIXED
    TEST_ASSERT_TRUE(num_sqrt(1) == 8192); /* the least: 2^-26 */
#endif
    TEST_ASSERT_TRUE(num_sqrt(NUM(0.25)) == NUM(0.5));
    TEST_ASSERT_TRUE(num_sqrt(NUM(0.0)) == NUM(0.0));
    TEST_ASSERT_TRUE(num_sqrt(NUM(-1.0)) == NUM(0.0));
}

#if STEADYSTEP_NUM == NUM_FIXED
static void test_a_square_root_is_exact_to_the_last_of_its_16_bits(void)
{
    random_state = 9;
    for (int i = 0; i < 100000; i++) {
        const num_t x = (num_t)((random_bits() >> 1) | (1u << 30)); /* 16...32: 2^-13 to a bit */
        const uint64_t root = (uint64_t)(num_sqrt(x) >> 13);

        TEST_ASSERT_EQUAL_INT32(0, num_sqrt(x) & 0x1fff);
        TEST_ASSERT_TRUE(root * root <= (uint64_t)x && (uint64_t)x < (root + 1u) * (root + 1u));
    }
}
#endif

static void test_clamps_and_magnitudes(void)
{
    TEST_ASSERT_TRUE(num_clamp(NUM(1.0), NUM(-2.0), NUM(3.0)) == NUM(1.0));
    TEST_ASSERT_TRUE(num_clamp(NUM(9.0), NUM(-2.0), NUM(3.0)) == NUM(3.0));
    TEST_ASSERT_TRUE(num_clamp(NUM(-9.0), NUM(-2.0), NUM(3.0)) == NUM(-2.0));
    TEST_ASSERT_TRUE(num_abs(NUM(-1.5)) == NUM(1.5));
    TEST_ASSERT_TRUE(num_abs(NUM(1.5)) == NUM(1.5));
}

static void test_a_limit_is_the_same_on_either_side(void)
{
    TEST_ASSERT_TRUE(num_limit(NUM(1.0), NUM(2.0)) == NUM(1.0));
    TEST_ASSERT_TRUE(num_limit(NUM(-1.0), NUM(2.0)) == NUM(-1.0));
    TEST_ASSERT_TRUE(num_limit(NUM(0.0), NUM(2.0)) == NUM(0.0));
    TEST_ASSERT_TRUE(num_limit(NUM(2.0), NUM(2.0)) == NUM(2.0));
    TEST_ASSERT_TRUE(num_limit(NUM(-2.0), NUM(2.0)) == NUM(-2.0));
    TEST_ASSERT_TRUE(num_limit(NUM(31.0), NUM(2.0)) == NUM(2.0));
    TEST_ASSERT_TRUE(num_limit(NUM(-31.0), NUM(2.0)) == NUM(-2.0));
    random_state = 12;
    for (int i = 0; i < 20000; i++) {
        num_t a = num_from_double(random_within(31.9));
        num_t limit = num_abs(num_from_double(random_within(31.9))) + NUM(0.001);

        TEST_ASSERT_TRUE(num_limit(a, limit) == num_clamp(a, -limit, limit));
    }
}

static void test_numbers_survive_the_way_to_double_and_back(void)
{
    random_state = 9;
    for (int i = 0; i < 20000; i++) {
        num_t x = num_from_double(random_within(31.9));

        TEST_ASSERT_TRUE(num_from_double(num_to_double(x)) == x);
    }
}

static void test_a_double_becomes_the_nearest_number(void)
{
    random_state = 10;
    for (int i = 0; i < 20000; i++) {
        double x = random_within(31.9);

        TEST_ASSERT_DOUBLE_WITHIN(0.5001 * resolution(x), x, num_to_double(num_from_double(x)));
    }
}

static void test_every_bit_of_a_number_reaches_its_hash(void)
{
    num_t x = NUM(1.0);
    double step = 1.0;

    while (num_from_double(1.0 + step / 2.0) != x) {
        step /= 2.0;
        TEST_ASSERT_TRUE(num_bits(num_from_double(1.0 + step)) != num_bits(x));
        TEST_ASSERT_TRUE(num_bits(num_from_double(-1.0 - step)) != num_bits(-x));
    }
    TEST_ASSERT_TRUE(num_bits(-x) != num_bits(x));
    TEST_ASSERT_TRUE(coef_bits(coef_from_double(0.5)) != coef_bits(coef_from_double(0.25)));
    TEST_ASSERT_TRUE(coef_bits(coef_from_double(0.5)) != coef_bits(coef_from_double(-0.5)));
    TEST_ASSERT_TRUE(coef_bits(coef_from_double(4.0)) != coef_bits(coef_from_double(8.0)));
    TEST_ASSERT_TRUE(coef_bits(coef_from_double(0.1)) != coef_bits(coef_from_double(0.05)));
}

int main(void)
{
    UNITY_BEGIN();
#if STEADYSTEP_NUM == NUM_FIXED
    RUN_TEST(test_a_product_is_the_floor_with_a_coarse_second_factor);
    RUN_TEST(test_the_upper_half_of_a_16_bit_product_is_its_floor);
    RUN_TEST(test_a_gain_is_rounded_down_once_and_shifted);
    RUN_TEST(test_products_of_a_large_and_a_small_gain_are_those_of_any_gain);
    RUN_TEST(test_a_code_times_a_gain_is_its_floor_shifted);
    RUN_TEST(test_a_gain_of_a_kind_is_never_shifted_to_the_other_side);
#ifndef STEADYSTEP_COEFFICIENT_SHIFTS
    RUN_TEST(test_a_gain_of_the_other_kind_is_seen);
#endif
    RUN_TEST(test_a_ratio_is_the_floor_of_the_exact_one);
#ifndef __arm__ /* whose cores' own products state no condition */
    RUN_TEST(test_a_product_that_does_not_fit_is_seen);
#endif
    RUN_TEST(test_a_second_factor_too_large_for_a_short_multiplication_is_seen);
    RUN_TEST(test_what_is_meant_to_go_round_is_none);
    RUN_TEST(test_a_product_of_ratios_is_the_floor_of_the_exact_one);
    RUN_TEST(test_halves_and_ratios_are_floors);
    RUN_TEST(test_literals_are_rounded_to_the_nearest);
    RUN_TEST(test_conversions_saturate_and_a_nan_is_a_number);
    RUN_TEST(test_only_a_gain_of_16_bits_is_kept);
#else
    RUN_TEST(test_a_nan_becomes_the_upper_bound);
    RUN_TEST(test_a_limit_holds_an_infinity_and_turns_a_nan_into_the_lower_bound);
    RUN_TEST(test_a_magnitude_has_no_sign_and_keeps_a_nan);
    RUN_TEST(test_a_half_becomes_the_even_count);
#endif
    RUN_TEST(test_products_are_right_to_their_resolution);
    RUN_TEST(test_a_gain_of_any_size_keeps_15_bits);
    RUN_TEST(test_a_gain_applied_is_the_gain_asked_for);
    RUN_TEST(test_a_converter_code_becomes_a_number);
    RUN_TEST(test_products_to_nearest_do_not_lean_to_either_side);
    RUN_TEST(test_products_of_quantities_to_nearest_do_not_lean_to_either_side);
    RUN_TEST(test_a_gain_is_changed_by_a_share);
    RUN_TEST(test_a_number_becomes_the_nearest_count);
    RUN_TEST(test_a_square_root_keeps_16_bits);
#if STEADYSTEP_NUM == NUM_FIXED
    RUN_TEST(test_a_square_root_is_exact_to_the_last_of_its_16_bits);
#endif
    RUN_TEST(test_clamps_and_magnitudes);
    RUN_TEST(test_a_limit_is_the_same_on_either_side);
    RUN_TEST(test_numbers_survive_the_way_to_double_and_back);
    RUN_TEST(test_a_double_becomes_the_nearest_number);
    RUN_TEST(test_every_bit_of_a_number_reaches_its_hash);
    return UNITY_END();
}
