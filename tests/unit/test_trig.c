/* Sine and cosine of a binary angle, compared with the C library's. */
#include <math.h>
#include <unity.h>

#include "firmware/numeric/trig.h"
#include "tests/unit/emulated.h"

static const double two_pi = 6.283185307179586476925;

#define QUARTER_TURN 0x40000000u
#define STRIDE       (EMULATED ? 100003u : 10007u) /* prime: every phase of every eighth of a turn */
#define ANGLES       (EMULATED ? 30000u : 300000u)

void setUp(void)
{
}

void tearDown(void)
{
}

/* The bound trig.h states; in fixed point half of it, which is what it reaches. */
static double error_bound(void)
{
#if STEADYSTEP_NUM == NUM_FIXED
    return 5e-5;
#else
    return 1.3e-7;
#endif
}

static double ratio(unit_t u)
{
    return (double)u / (double)UNIT(1.0);
}

static void is_within_the_bound(angle_t angle)
{
    struct sincos r = sincos_of(angle);
    double rad = (double)angle / 4294967296.0 * two_pi;

    TEST_ASSERT_DOUBLE_WITHIN(error_bound(), sin(rad), ratio(r.sin));
    TEST_ASSERT_DOUBLE_WITHIN(error_bound(), cos(rad), ratio(r.cos));
}

static void test_the_error_stays_below_its_bound_all_around(void)
{
    angle_t angle = 0;

    do {
        is_within_the_bound(angle);
        angle += STRIDE;
    } while (angle >= STRIDE);
}

/* The bound trig.h states for a rotation of at most an eighth turn. */
static void test_a_small_rotation_is_within_its_bound(void)
{
    for (int k = -1000; k <= 1000; k++) {
        const double turns = 0.125 * (double)k / 1000.0;
        const struct sincos r = sincos_of_small(num_from_double(turns));
#if STEADYSTEP_NUM == NUM_FIXED
        const double bound = 1e-4;
#else
        const double bound = fabs(turns) <= 0.0625 ? 4.5e-7 : 2.4e-6;
#endif

        TEST_ASSERT_DOUBLE_WITHIN(bound, sin(turns * two_pi), ratio(r.sin));
        TEST_ASSERT_DOUBLE_WITHIN(bound, cos(turns * two_pi), ratio(r.cos));
    }
}

static void test_the_seams_of_the_eighths_are_as_good_as_the_rest(void)
{
    for (uint32_t eighth = 0; eighth < 8u; eighth++) {
        for (uint32_t i = 0; i < 2000u; i++) {
            is_within_the_bound(eighth * (QUARTER_TURN / 2u) + (i - 1000u) * 17u);
        }
    }
}

static void test_the_quarter_turns_are_exact(void)
{
    static const double cosine[] = {1.0, 0.0, -1.0, 0.0};

    for (uint32_t quarter = 0; quarter < 4u; quarter++) {
        struct sincos r = sincos_of(quarter * QUARTER_TURN);

        TEST_ASSERT_TRUE(ratio(r.cos) == cosine[quarter]);
        TEST_ASSERT_TRUE(ratio(r.sin) == cosine[(quarter + 3u) % 4u]);
    }
}

static void test_a_vector_keeps_its_length(void)
{
    angle_t angle = 0;

    do {
        struct sincos r = sincos_of(angle);
        double square = ratio(r.cos) * ratio(r.cos) + ratio(r.sin) * ratio(r.sin);

        TEST_ASSERT_DOUBLE_WITHIN(2.5 * error_bound(), 1.0, square);
        angle += STRIDE;
    } while (angle >= STRIDE);
}

static void test_a_sine_never_exceeds_one(void)
{
    for (uint32_t i = 0; i < 400000u; i++) {
        for (uint32_t quarter = 0; quarter < 4u; quarter++) {
            struct sincos r = sincos_of(quarter * QUARTER_TURN + (i - 200000u) * 211u);

            TEST_ASSERT_TRUE(r.cos <= UNIT(1.0) && r.cos >= UNIT(-1.0));
            TEST_ASSERT_TRUE(r.sin <= UNIT(1.0) && r.sin >= UNIT(-1.0));
        }
    }
}

static void test_a_quarter_turn_on_the_sine_is_the_cosine(void)
{
#if STEADYSTEP_NUM == NUM_FIXED
    const double bound = 1.0 / 32768.0; /* half a bit is rounded up on either side of zero */
#else
    const double bound = 0.0;
#endif
    angle_t angle = 0;

    do {
        struct sincos here = sincos_of(angle);
        struct sincos on = sincos_of(angle + QUARTER_TURN);

        TEST_ASSERT_TRUE(on.sin == here.cos);
        TEST_ASSERT_DOUBLE_WITHIN(bound, -ratio(here.sin), ratio(on.cos));
        angle += 10u * STRIDE;
    } while (angle >= 10u * STRIDE);
}

static void test_backwards_the_sine_is_odd_and_the_cosine_even(void)
{
#if STEADYSTEP_NUM == NUM_FIXED
    const double bound = 2.0 / 32768.0; /* the last bit is rounded down on either side */
#else
    const double bound = 1.2e-7;
#endif
    angle_t angle = 0;

    do {
        struct sincos forth = sincos_of(angle);
        struct sincos back = sincos_of(0u - angle);

        TEST_ASSERT_DOUBLE_WITHIN(bound, ratio(forth.cos), ratio(back.cos));
        TEST_ASSERT_DOUBLE_WITHIN(bound, -ratio(forth.sin), ratio(back.sin));
        angle += 10u * STRIDE;
    } while (angle >= 10u * STRIDE);
}

static void test_sines_of_many_angles_are_without_bias(void)
{
    double sine = 0.0;
    double cosine = 0.0;

    for (uint32_t i = 0; i < 65536u; i++) {
        struct sincos r = sincos_of(i << 16);

        sine += ratio(r.sin);
        cosine += ratio(r.cos);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.0, sine / 65536.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.0, cosine / 65536.0);
}

/*
 * Either angle brings its error, on a vector of length one at most sqrt(2) times the bound; the
 * products are rounded twice.
 */
static double error_bound_of_a_sum(void)
{
#if STEADYSTEP_NUM == NUM_FIXED
    return 2.0 * sqrt(2.0) * error_bound() + 2.0 / 32768.0;
#elif STEADYSTEP_NUM == NUM_FLOAT
    return 2.0 * sqrt(2.0) * error_bound() + 2.0 / 16777216.0;
#else
    return 2.0 * sqrt(2.0) * error_bound();
#endif
}

static void test_the_sum_of_two_angles_has_their_sine_and_cosine(void)
{
    angle_t x = 0;

    for (uint32_t i = 0; i < ANGLES; i++) {
        angle_t y = i * 2654435769u; /* a golden section of the turn: everywhere */
        struct sincos sum = sincos_add(sincos_of(x), sincos_of(y));
        double rad = (double)(angle_t)(x + y) / 4294967296.0 * two_pi;

        TEST_ASSERT_DOUBLE_WITHIN(error_bound_of_a_sum(), cos(rad), ratio(sum.cos));
        TEST_ASSERT_DOUBLE_WITHIN(error_bound_of_a_sum(), sin(rad), ratio(sum.sin));
        x += 1000003u * 7u;
    }
}

static void test_a_quarter_turn_is_added_exactly(void)
{
    const struct sincos quarter = sincos_of(QUARTER_TURN);
    const struct sincos nothing = sincos_of(0);
    angle_t angle = 0;

    do {
        struct sincos here = sincos_of(angle);
        struct sincos same = sincos_add(here, nothing);
        struct sincos on = sincos_add(here, quarter);

        TEST_ASSERT_TRUE(same.cos == here.cos && same.sin == here.sin);
        TEST_ASSERT_TRUE(on.sin == here.cos && on.cos == -here.sin);
        angle += 10u * STRIDE;
    } while (angle >= 10u * STRIDE);
}

static void test_a_small_turn_added_keeps_the_length_of_a_vector(void)
{
    for (uint32_t i = 0; i < ANGLES; i++) {
        struct sincos frame = sincos_of(i * 2654435769u);
        int32_t turn = (int32_t)(i * (QUARTER_TURN / ANGLES)) - (int32_t)(QUARTER_TURN / 2u);
        struct sincos turned = sincos_add(frame, sincos_of((angle_t)turn));
        double square =
            ratio(turned.cos) * ratio(turned.cos) + ratio(turned.sin) * ratio(turned.sin);

        TEST_ASSERT_DOUBLE_WITHIN(2.0 * error_bound_of_a_sum(), 1.0, square);
    }
}

static void test_a_sum_exceeds_one_by_its_error_at_most(void)
{
    /* An angle and nearly its opposite: where the cosine of the sum is largest. */
    for (uint32_t i = 0; i < ANGLES; i++) {
        angle_t x = i * 2654435769u;
        struct sincos sum = sincos_add(sincos_of(x), sincos_of(0u - x + (i % 2048u) * 64u));

        TEST_ASSERT_TRUE(ratio(sum.cos) <= 1.0 + error_bound_of_a_sum());
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_error_stays_below_its_bound_all_around);
    RUN_TEST(test_a_small_rotation_is_within_its_bound);
    RUN_TEST(test_the_seams_of_the_eighths_are_as_good_as_the_rest);
    RUN_TEST(test_the_quarter_turns_are_exact);
    RUN_TEST(test_a_vector_keeps_its_length);
    RUN_TEST(test_a_sine_never_exceeds_one);
    RUN_TEST(test_a_quarter_turn_on_the_sine_is_the_cosine);
    RUN_TEST(test_backwards_the_sine_is_odd_and_the_cosine_even);
    RUN_TEST(test_sines_of_many_angles_are_without_bias);
    RUN_TEST(test_the_sum_of_two_angles_has_their_sine_and_cosine);
    RUN_TEST(test_a_quarter_turn_is_added_exactly);
    RUN_TEST(test_a_small_turn_added_keeps_the_length_of_a_vector);
    RUN_TEST(test_a_sum_exceeds_one_by_its_error_at_most);
    return UNITY_END();
}
