/* The hold of a machine that rests has less current after a while, and all of it where something
   happens. */
#include "firmware/drive/idle_current.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

enum { DELAY = 5000 }; /* periods: 0.5 s */

static const num_t full = NUM(0.5), idle_load = NUM(0.05);

static struct idle_current_params params;
static struct idle_current idle;
static struct idle_look look;
static num_t current;

void setUp(void)
{
    const struct per_unit base = per_unit_base(&bench_params, PERIOD_S);
    struct drive_settings settings;

    drive_settings_default(&settings, &bench_params);
    settings.hold_current_A = 0.5 * base.current_A;
    settings.idle_current_A = 0.2 * base.current_A;
    settings.idle_delay_s = DELAY * PERIOD_S;
    settings.hold_ramp_s = 0.01;
    params = idle_current_design(&settings, &base, PERIOD_S);
    idle = (struct idle_current){.load = idle_load};
    look = (struct idle_look){.holds = true, .load = idle_load};
    current = full;
}

void tearDown(void)
{
}

/* So many periods, of which the background comes to every `every`th. */
static void pass(uint32_t periods, uint32_t every)
{
    for (uint32_t k = 0; k < periods; k += every) {
        look.period += every;
        current = idle_current_step(&idle, &params, &look, current, full);
    }
}

static void test_idles_after_its_delay_and_not_before(void)
{
    pass(DELAY - 1, 1);
    TEST_ASSERT_NUM_WITHIN(2e-6, 0.5, current);
    pass(2, 1);
    TEST_ASSERT_TRUE(current < full);
}

static void test_falls_to_the_idle_current_in_ten_ramps_and_no_further(void)
{
    pass(DELAY, 1);
    pass(500, 1); /* 0.3 of it takes 0.6 of 0.1 s */
    TEST_ASSERT_NUM_WITHIN(1e-3, 0.25, current);
    pass(200, 1);
    TEST_ASSERT_NUM_WITHIN(2e-6, 0.2, current);
    pass(10000, 1);
    TEST_ASSERT_NUM_WITHIN(2e-6, 0.2, current);
}

static void test_takes_the_same_time_where_the_background_comes_seldom(void)
{
    pass(DELAY, 10);
    pass(500, 10);
    TEST_ASSERT_NUM_WITHIN(6e-3, 0.25, current);
}

/* The delay is over in the midst of a look, and stays over. */
static void test_goes_on_falling_however_the_background_comes(void)
{
    pass(DELAY - 8, 1);
    pass(30, 30);
    const double begun = num_to_double(current);

    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.5 - 30 * 0.5 / 1000, begun);
    pass(20, 1);
    TEST_ASSERT_NUM_WITHIN(1e-4, begun - 20 * 0.5 / 1000, current);
}

static void test_has_all_of_it_at_once_when_the_reference_moves_and_for_the_delay_from_then_on(void)
{
    pass(2 * DELAY, 1);
    look.holds = false;
    pass(1, 1);
    TEST_ASSERT_NUM_WITHIN(2e-6, 0.5, current);
    look.holds = true;
    pass(DELAY - 1, 1);
    TEST_ASSERT_NUM_WITHIN(2e-6, 0.5, current);
    pass(2 * DELAY, 1);
    TEST_ASSERT_NUM_WITHIN(2e-6, 0.2, current);
}

static void test_has_all_of_it_at_once_when_the_load_changes_by_more_than_a_fifth_of_the_rated(void)
{
    pass(2 * DELAY, 1);
    look.load = idle_load + NUM(0.09);
    pass(1, 1);
    TEST_ASSERT_NUM_WITHIN(2e-6, 0.2, current);
    look.load = idle_load - NUM(0.11);
    pass(1, 1);
    TEST_ASSERT_NUM_WITHIN(2e-6, 0.5, current);
}

static void test_idles_again_under_a_load_that_stays(void)
{
    pass(2 * DELAY, 1);
    look.load = idle_load + NUM(0.2);
    pass(1, 1);
    pass(2 * DELAY, 1);
    TEST_ASSERT_NUM_WITHIN(2e-6, 0.2, current);
}

static void test_a_background_that_was_busy_for_long_makes_a_small_step(void)
{
    pass(DELAY, 1);
    look.period += 100000;
    current = idle_current_step(&idle, &params, &look, current, full);
    TEST_ASSERT_NUM_WITHIN(2e-3, 0.5 - 64 * 0.5 / 1000, current);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_idles_after_its_delay_and_not_before);
    RUN_TEST(test_falls_to_the_idle_current_in_ten_ramps_and_no_further);
    RUN_TEST(test_takes_the_same_time_where_the_background_comes_seldom);
    RUN_TEST(test_goes_on_falling_however_the_background_comes);
    RUN_TEST(test_has_all_of_it_at_once_when_the_reference_moves_and_for_the_delay_from_then_on);
    RUN_TEST(test_has_all_of_it_at_once_when_the_load_changes_by_more_than_a_fifth_of_the_rated);
    RUN_TEST(test_idles_again_under_a_load_that_stays);
    RUN_TEST(test_a_background_that_was_busy_for_long_makes_a_small_step);
    return UNITY_END();
}
