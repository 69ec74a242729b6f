/* A speed that swings on and on: a belt. */
#include <math.h>

#include "firmware/drive/belt_watch.h"
#include "tests/unit/drive_bench.h"

static struct belt_watch watch;

void setUp(void)
{
    watch = (struct belt_watch){.swing = NUM(0.02), .latest = 40};
}

void tearDown(void)
{
}

/* Whether `periods` of a swing of this length and amplitude, about an error that stays, show. */
static bool shows(uint32_t periods, double length, double amplitude)
{
    bool seen = false;

    for (uint32_t k = 0; k < periods && !seen; k++) {
        const double angle = 6.283185307179586 * k / length;

        seen = belt_watch_swings(&watch, num_from_double(0.3 + amplitude * sin(angle)), k);
    }
    return seen;
}

static void test_a_swing_of_125_to_500_hertz_is_seen_within_eight_cycles(void)
{
    static const double lengths[] = {20.0, 40.0, 60.0, 78.0};

    for (size_t i = 0; i < 4; i++) {
        setUp();
        TEST_ASSERT_TRUE(shows((uint32_t)(8.0 * lengths[i]), lengths[i], 0.012));
    }
}

static void test_a_few_cycles_are_none(void)
{
    TEST_ASSERT_FALSE(shows(200, 40.0, 0.05));
}

static void test_slower_quicker_and_smaller_ones_are_none(void)
{
    TEST_ASSERT_FALSE(shows(20000, 90.0, 0.05));
    setUp();
    TEST_ASSERT_FALSE(shows(20000, 16.0, 0.05));
    setUp();
    TEST_ASSERT_FALSE(shows(20000, 40.0, 0.009));
}

/* What the current control weighs an error with, behind a swing of the speed in this state. */
static double gain_behind_a_swing(enum drive_state state, bool watches)
{
    drive_bench_reset();
    power_up();
    drive.supervision.state = state;
    drive.belt_watch = (struct belt_watch){.swing = NUM(0.02), .latest = 40, .watches = watches};
    for (uint32_t k = 0; k < 400u; k++) {
        drive.supervision.period = k;
        drive.estimator.estimate.rotor.speed = num_from_double(0.05 * sin(0.157 * k));
        belt_watch_background(&drive);
    }
    return coef_to_double(drive.params.current_control.proportional);
}

static void test_the_current_loop_of_a_drive_in_operation_becomes_the_widest(void)
{
    const double as_designed = gain_behind_a_swing(DRIVE_SWITCH_ON_DISABLED, true);

    TEST_ASSERT_DOUBLE_WITHIN(0.05 * as_designed, 2.0 * as_designed, /* 3000 of 1500 rad/s */
                              gain_behind_a_swing(DRIVE_OPERATION_ENABLED, true));
    TEST_ASSERT_EQUAL_DOUBLE(as_designed, gain_behind_a_swing(DRIVE_OPERATION_ENABLED, false));
}

/* By what share the law has its bandwidth still, behind a q current that swings by this share of
   the limit to each side. */
static double law_behind_a_swing(double share, uint32_t periods, double given_rad_s, bool held)
{
    drive_bench_reset();
    settings.current_bandwidth_rad_s = 3000.0;
    settings.law_bandwidth_rad_s = given_rad_s;
    power_up();
    drive.supervision.state = DRIVE_OPERATION_ENABLED;
    drive.hold.active = held;

    const double as_designed = drive.settings.law_bandwidth_rad_s;
    const union position_law_params law = drive.params.law;
    const double amplitude = share * drive.settings.current_limit_A / drive.base.current_A;

    for (uint32_t k = 0; k < periods; k++) {
        drive.supervision.period = k;
        drive.current_reference.q = num_from_double(amplitude * sin(0.157 * k));
        belt_watch_background(&drive);
    }
    const double left = drive.settings.law_bandwidth_rad_s / as_designed;

    TEST_ASSERT_EQUAL(left == 1.0, memcmp(&law, &drive.params.law, sizeof law) == 0);
    return left;
}

static void test_a_law_whose_current_swings_has_half_its_bandwidth_then_a_quarter(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(0.5, law_behind_a_swing(0.3, 400u, __builtin_nan(""), false));
    TEST_ASSERT_EQUAL_DOUBLE(0.25, law_behind_a_swing(0.3, 4000u, __builtin_nan(""), false));
}

static void test_a_law_keeps_the_bandwidth_that_is_given(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(1.0, law_behind_a_swing(0.9, 4000u, 250.0, false));
}

static void test_neither_a_hold_nor_the_ripple_of_a_detent_torque_weakens_the_law(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(1.0, law_behind_a_swing(0.9, 4000u, __builtin_nan(""), true));
    TEST_ASSERT_EQUAL_DOUBLE(1.0, law_behind_a_swing(0.2, 4000u, __builtin_nan(""), false));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_swing_of_125_to_500_hertz_is_seen_within_eight_cycles);
    RUN_TEST(test_a_few_cycles_are_none);
    RUN_TEST(test_slower_quicker_and_smaller_ones_are_none);
    RUN_TEST(test_the_current_loop_of_a_drive_in_operation_becomes_the_widest);
    RUN_TEST(test_a_law_whose_current_swings_has_half_its_bandwidth_then_a_quarter);
    RUN_TEST(test_a_law_keeps_the_bandwidth_that_is_given);
    RUN_TEST(test_neither_a_hold_nor_the_ripple_of_a_detent_torque_weakens_the_law);
    return UNITY_END();
}
