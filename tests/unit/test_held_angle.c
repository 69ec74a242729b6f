/* The angle at which a hold leads its rotor: from rest to rest, without exciting a swing. */
#include "firmware/motor/held_angle.h"

#include <math.h>

#include "tests/unit/num_assert.h"

#define EIGHTH 0x20000000
#define TWO_PI 6.283185307179586476925

static struct held_angle angle;
static struct held_angle_params params;

void setUp(void)
{
    params = held_angle_design(100.0);
    held_angle_start(&angle);
}

void tearDown(void)
{
}

/* Periods to the target; a rotor on its spring swings behind the angle: its amplitude is left. */
static int lead_to(int32_t target, double *swing_turns)
{
    const double rad = TWO_PI / (double)params.swing;
    double rotor = angle.offset, speed = 0.0;
    int periods = 0;
    bool there = false;

    held_angle_lead_to(&angle, target);
    while (!there && periods < 10000) {
        there = held_angle_step(&angle, &params);
        periods++;
        for (int part = 0; part < 100; part++) {
            speed += rad * rad / 100.0 * ((double)angle.offset - rotor);
            rotor += speed / 100.0;
        }
    }
    TEST_ASSERT_TRUE(there);
    TEST_ASSERT_EQUAL_INT32(target, angle.offset);
    *swing_turns = hypot(rotor - (double)angle.offset, speed / rad) / 4294967296.0;
    return periods;
}

static void test_an_eighth_of_a_turn_takes_two_swings(void)
{
    double swing;

    TEST_ASSERT_INT_WITHIN(8, 2 * 100, lead_to(EIGHTH, &swing));
    TEST_ASSERT_INT_WITHIN(8, 2 * 100, lead_to(0, &swing));
}

static void test_a_rotor_that_is_led_an_eighth_of_a_turn_does_not_swing_behind_it(void)
{
    double swing;

    (void)lead_to(EIGHTH, &swing);
    TEST_ASSERT_DOUBLE_WITHIN(0.125 * 0.03, 0.0, swing);
    (void)lead_to(-EIGHTH, &swing);
    TEST_ASSERT_DOUBLE_WITHIN(0.125 * 0.06, 0.0, swing);
}

static void test_it_goes_to_both_sides_and_stays_where_it_is_led_to(void)
{
    double swing;

    TEST_ASSERT_TRUE(lead_to(-EIGHTH / 3, &swing) < 300); /* not the other way round */
    (void)lead_to(EIGHTH / 7, &swing);
    TEST_ASSERT_EQUAL_INT(1, lead_to(EIGHTH / 7, &swing));
    TEST_ASSERT_EQUAL_INT32(0, angle.moved);
}

static void test_its_speed_is_what_it_has_moved(void)
{
    int32_t before = angle.offset;

    held_angle_lead_to(&angle, EIGHTH);
    for (int period = 0; period < 150; period++) {
        (void)held_angle_step(&angle, &params);
        TEST_ASSERT_NUM_WITHIN(1e-7, (double)(angle.offset - before) / 4294967296.0,
                               held_angle_turned(&angle));
        TEST_ASSERT_TRUE(angle.moved <= params.speed + params.acceleration);
        before = angle.offset;
    }
}

static void test_no_motor_swings_too_fast_or_too_slowly_for_it(void)
{
    double swing;

    params = held_angle_design(0.1);
    TEST_ASSERT_EQUAL_UINT32(8, params.swing);
    TEST_ASSERT_INT_WITHIN(4, 16, lead_to(EIGHTH, &swing));
    TEST_ASSERT_EQUAL_UINT32(1000000, held_angle_design(1e9).swing);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_an_eighth_of_a_turn_takes_two_swings);
    RUN_TEST(test_a_rotor_that_is_led_an_eighth_of_a_turn_does_not_swing_behind_it);
    RUN_TEST(test_it_goes_to_both_sides_and_stays_where_it_is_led_to);
    RUN_TEST(test_its_speed_is_what_it_has_moved);
    RUN_TEST(test_no_motor_swings_too_fast_or_too_slowly_for_it);
    return UNITY_END();
}
