/* A count that stands still at rest while the torque rises. */
#include "firmware/drive/rotor_watch.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

enum { PERIODS = 50, NEVER = 1000 };

static const struct rotor_watch_params params = {.rise = NUM(0.15), .high = NUM(0.2), .periods = PERIODS};

static struct rotor_watch watch;
static struct rotor_look look;

static bool next(void)
{
    look.period++;
    return rotor_watch_step(&watch, &params, &look);
}

void setUp(void)
{
    watch = (struct rotor_watch){.low = 0};
    look = (struct rotor_look){.count = 7, .current = NUM(-0.1), .in_place = true};
    (void)next(); /* the count is new */
}

void tearDown(void)
{
}

/* Periods until it is said; NEVER. */
static int periods_until_said(void)
{
    for (int n = 1; n < NEVER; n++) {
        if (next()) {
            return n;
        }
    }
    return NEVER;
}

static void test_a_torque_that_rises_without_a_count_is_said_after_5_ms(void)
{
    look.current = NUM(-0.2501);
    TEST_ASSERT_EQUAL_INT(PERIODS, periods_until_said());
    setUp();
    look.current = NUM(0.2501); /* on either side */
    TEST_ASSERT_EQUAL_INT(PERIODS, periods_until_said());
}

static void test_a_torque_that_stays_may_be_any(void)
{
    look.count = 8;
    look.current = NUM(0.5);
    TEST_ASSERT_EQUAL_INT(NEVER, periods_until_said());
}

static void test_the_rise_is_from_the_least_since_the_last_count(void)
{
    look.current = NUM(0.06);
    TEST_ASSERT_FALSE(next());
    look.current = NUM(0.22);
    TEST_ASSERT_EQUAL_INT(PERIODS, periods_until_said());
}

static void test_what_friction_asks_for_is_not_said(void)
{
    look.current = NUM(0.0);
    TEST_ASSERT_FALSE(next());
    look.current = NUM(0.1999);
    TEST_ASSERT_EQUAL_INT(NEVER, periods_until_said());
    look.current = NUM(0.2001);
    TEST_ASSERT_EQUAL_INT(PERIODS, periods_until_said());
}

static void test_a_count_begins_anew(void)
{
    for (int n = 0; n < NEVER; n++) {
        look.count += n % PERIODS == 0 ? 1 : 0;
        look.current = n % PERIODS == 0 ? NUM(-0.1) : NUM(-0.2501);
        TEST_ASSERT_FALSE(next());
    }
}

static void test_a_rotor_in_motion_or_beside_its_place_is_not_judged(void)
{
    look.in_place = false;
    look.current = NUM(-0.2501);
    TEST_ASSERT_EQUAL_INT(NEVER, periods_until_said());
}

static struct rotor_swing swing;

/* Periods until it is said, of an error that changes its side every so many; NEVER. */
static int periods_until_swinging(double turns, int half_cycle, int ahead_half_cycles)
{
    swing = (struct rotor_swing){.turns = 0};
    for (int n = 1; n < NEVER; n++) {
        const bool ahead = n / half_cycle % 2 == 0 && n / half_cycle < ahead_half_cycles;

        if (rotor_watch_swings(&swing, num_from_double(ahead ? turns : -turns), (uint32_t)(n + 9000),
                               100)) {
            return n;
        }
    }
    return NEVER;
}

static void test_a_rotor_that_is_thrown_to_and_fro_is_said_at_the_third_turn(void)
{
    TEST_ASSERT_EQUAL_INT(3 * 60, periods_until_swinging(1.01, 60, NEVER));
}

static void test_a_rotor_that_is_late_or_early_for_long_or_slow_or_little_does_not_swing(void)
{
    TEST_ASSERT_EQUAL_INT(NEVER, periods_until_swinging(0.99, 60, NEVER));
    TEST_ASSERT_EQUAL_INT(NEVER, periods_until_swinging(1.01, 101, NEVER));
    TEST_ASSERT_EQUAL_INT(NEVER, periods_until_swinging(1.01, 60, 2)); /* ahead, then behind */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_torque_that_rises_without_a_count_is_said_after_5_ms);
    RUN_TEST(test_a_torque_that_stays_may_be_any);
    RUN_TEST(test_the_rise_is_from_the_least_since_the_last_count);
    RUN_TEST(test_what_friction_asks_for_is_not_said);
    RUN_TEST(test_a_count_begins_anew);
    RUN_TEST(test_a_rotor_in_motion_or_beside_its_place_is_not_judged);
    RUN_TEST(test_a_rotor_that_is_thrown_to_and_fro_is_said_at_the_third_turn);
    RUN_TEST(test_a_rotor_that_is_late_or_early_for_long_or_slow_or_little_does_not_swing);
    return UNITY_END();
}
