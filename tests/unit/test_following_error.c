/* A rotor with an encoder that is too far from its reference, and not on its way back. */
#include "firmware/drive/following_error.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

enum { LOOKS = 10 };

static const double limit_rad = 0.1;

static struct per_unit base;
static struct following_error_params params;
static struct following_error following;

static struct following_error_params design(double rad)
{
    const struct following_error_task task = {
        .base = &base, .period_s = PERIOD_S, .limit_rad = rad};

    return following_error_design(&task);
}

void setUp(void)
{
    base = per_unit_base(&bench_params, PERIOD_S);
    params = design(limit_rad);
    following_error_reset(&following);
}

void tearDown(void)
{
}

static bool look(double error_rad, double speed_error_rad_s)
{
    return following_error_exceeds(&following, &params,
                                   num_from_double(error_rad / base.rad_per_turn),
                                   num_from_double(speed_error_rad_s / base.speed_rad_s));
}

/* Looks until it exceeds, 100: never. */
static int looks_until_exceeded(double error_rad, double speed_error_rad_s)
{
    for (int n = 1; n < 100; n++) {
        if (look(error_rad, speed_error_rad_s)) {
            return n;
        }
    }
    return 100;
}

static void test_it_looks_once_in_a_millisecond(void)
{
    TEST_ASSERT_EQUAL_UINT32(10, params.periods);
}

static void test_ten_looks_beyond_the_limit_exceed_it_on_either_side(void)
{
    TEST_ASSERT_EQUAL_INT(LOOKS, looks_until_exceeded(1.01 * limit_rad, 0.0));
    following_error_reset(&following);
    TEST_ASSERT_EQUAL_INT(LOOKS, looks_until_exceeded(-1.01 * limit_rad, 0.0));
}

static void test_an_error_within_the_limit_never_does(void)
{
    TEST_ASSERT_EQUAL_INT(100, looks_until_exceeded(0.99 * limit_rad, 10.0));
}

/* A step of the reference: far away, and coming. */
static void test_a_rotor_that_comes_back_in_a_quarter_of_a_second_does_not(void)
{
    const double back_rad_s = limit_rad / 0.25;

    TEST_ASSERT_EQUAL_INT(100, looks_until_exceeded(5.0 * limit_rad, -1.05 * back_rad_s));
    TEST_ASSERT_EQUAL_INT(100, looks_until_exceeded(-5.0 * limit_rad, 1.05 * back_rad_s));
}

static void test_one_that_comes_back_more_slowly_or_runs_away_does(void)
{
    const double back_rad_s = limit_rad / 0.25;

    TEST_ASSERT_EQUAL_INT(LOOKS, looks_until_exceeded(5.0 * limit_rad, -0.95 * back_rad_s));
    following_error_reset(&following);
    TEST_ASSERT_EQUAL_INT(LOOKS, looks_until_exceeded(-5.0 * limit_rad, -20.0));
}

static void test_the_looks_count_in_a_row(void)
{
    for (int n = 1; n < LOOKS; n++) {
        TEST_ASSERT_FALSE(look(2.0 * limit_rad, 0.0));
    }
    TEST_ASSERT_FALSE(look(0.5 * limit_rad, 0.0));
    TEST_ASSERT_EQUAL_INT(LOOKS, looks_until_exceeded(2.0 * limit_rad, 0.0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_it_looks_once_in_a_millisecond);
    RUN_TEST(test_ten_looks_beyond_the_limit_exceed_it_on_either_side);
    RUN_TEST(test_an_error_within_the_limit_never_does);
    RUN_TEST(test_a_rotor_that_comes_back_in_a_quarter_of_a_second_does_not);
    RUN_TEST(test_one_that_comes_back_more_slowly_or_runs_away_does);
    RUN_TEST(test_the_looks_count_in_a_row);
    return UNITY_END();
}
