/* The brake resistor's switch: hysteresis, and what keeps the resistor from burning. */
#include <unity.h>

#include "firmware/drive/brake.h"

static const struct hal_facts facts = {.control_period_s = 1e-4, .bus_V_per_code = 0.01};
static struct drive_settings settings;
static struct brake brake;

enum { QUIET = 2400, IN_BETWEEN = 2950, HIGH = 3001 }; /* codes of a supply of 24 V */

void setUp(void)
{
    settings = (struct drive_settings){.motor = {.supply_V = 24.0},
                                       .brake_on_ratio = 1.25,
                                       .brake_hysteresis = 0.03,
                                       .brake_duty = 0.25,
                                       .brake_pulse_s = 0.1};
    brake = (struct brake){.heat = 0};
    brake_design(&brake, &settings, &facts);
}

void tearDown(void)
{
}

/* As a board asks. */
static bool step(uint16_t bus_code)
{
    return !brake_idles(&brake, bus_code) && brake_switch(&brake, bus_code);
}

/* Periods on, of so many with that code. */
static int on(uint16_t bus_code, int periods)
{
    int count = 0;

    for (int i = 0; i < periods; i++) {
        count += step(bus_code) ? 1 : 0;
    }
    return count;
}

static void test_is_on_from_the_upper_voltage_to_the_lower(void)
{
    TEST_ASSERT_FALSE(step(2999));
    TEST_ASSERT_TRUE(step(HIGH));
    TEST_ASSERT_TRUE(step(IN_BETWEEN));
    TEST_ASSERT_FALSE(step(2927));
    TEST_ASSERT_FALSE(step(IN_BETWEEN));
    TEST_ASSERT_TRUE(step(HIGH));
}

static void test_idles_while_the_bus_is_where_it_should_be_and_the_resistor_cold(void)
{
    (void)on(QUIET, 1); /* a design is looked at once */
    TEST_ASSERT_TRUE(brake_idles(&brake, 2999));
    TEST_ASSERT_FALSE(brake_idles(&brake, HIGH));
    (void)on(HIGH, 100);
    TEST_ASSERT_FALSE(brake_idles(&brake, QUIET));
    (void)on(QUIET, 299);
    TEST_ASSERT_FALSE(brake_idles(&brake, QUIET));
    (void)on(QUIET, 1);
    TEST_ASSERT_TRUE(brake_idles(&brake, QUIET));
}

static void test_rests_when_it_has_been_on_for_its_pulse(void)
{
    TEST_ASSERT_EQUAL_INT(1001, on(HIGH, 2000));
    TEST_ASSERT_TRUE(brake.rests);
}

static void test_is_ready_again_when_half_of_the_heat_is_gone(void)
{
    (void)on(HIGH, 1001);
    TEST_ASSERT_EQUAL_INT(0, on(HIGH, 1502));
    TEST_ASSERT_TRUE(brake.rests);
    TEST_ASSERT_EQUAL_INT(0, on(HIGH, 1));
    TEST_ASSERT_EQUAL_INT(501, on(HIGH, 600));
}

static void test_in_the_long_run_it_is_on_for_its_share_of_time(void)
{
    (void)on(HIGH, 10000);
    TEST_ASSERT_INT_WITHIN(600, 25000, on(HIGH, 100000));
}

static void test_what_it_may_for_good_it_never_rests_from(void)
{
    settings.brake_duty = 1.0;
    brake_design(&brake, &settings, &facts);
    TEST_ASSERT_EQUAL_INT(100000, on(HIGH, 100000));
}

static void test_a_design_leaves_what_is_hot(void)
{
    (void)on(HIGH, 1001);
    brake_design(&brake, &settings, &facts);
    TEST_ASSERT_FALSE(step(HIGH));
}

/* An idle one would wait for the old voltage. */
static void test_a_design_acts_at_once_on_a_brake_that_idles(void)
{
    (void)on(QUIET, 3);
    TEST_ASSERT_TRUE(brake_idles(&brake, 2800));
    settings.brake_on_ratio = 1.1;
    brake_design(&brake, &settings, &facts);
    TEST_ASSERT_TRUE(step(2800));
}

static void test_the_longest_pulse_of_the_shortest_period_is_counted(void)
{
    const struct hal_facts fast = {.control_period_s = 5e-5, .bus_V_per_code = 0.01};

    settings.brake_pulse_s = 30.0;
    settings.brake_duty = 1e-3;
    brake_design(&brake, &settings, &fast);
    TEST_ASSERT_EQUAL_INT(600001, on(HIGH, 700000));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_is_on_from_the_upper_voltage_to_the_lower);
    RUN_TEST(test_idles_while_the_bus_is_where_it_should_be_and_the_resistor_cold);
    RUN_TEST(test_rests_when_it_has_been_on_for_its_pulse);
    RUN_TEST(test_is_ready_again_when_half_of_the_heat_is_gone);
    RUN_TEST(test_in_the_long_run_it_is_on_for_its_share_of_time);
    RUN_TEST(test_what_it_may_for_good_it_never_rests_from);
    RUN_TEST(test_a_design_leaves_what_is_hot);
    RUN_TEST(test_a_design_acts_at_once_on_a_brake_that_idles);
    RUN_TEST(test_the_longest_pulse_of_the_shortest_period_is_counted);
    return UNITY_END();
}
