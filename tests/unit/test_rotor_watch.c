/* A rotor that is thrown to and fro, and a count that stands still at full torque. */
#include "firmware/drive/rotor_watch.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

enum { STANDS = 300, NEVER = 2000, WITHIN = 100, START = 9000 };

static struct rotor_watch watch;
static uint32_t period;

void setUp(void)
{
    period = START;
    watch = (struct rotor_watch){.count = 0};
    rotor_watch_reset(&watch, START);
}

void tearDown(void)
{
}

static bool stands(int32_t count, bool pushed)
{
    return rotor_watch_count_stands(&watch, count, pushed, ++period, STANDS);
}

static void test_a_count_that_stands_still_at_full_torque_is_said_after_30_ms(void)
{
    int n = 1;

    (void)stands(7, true);
    while (n < NEVER && !stands(7, true)) {
        n++;
    }
    TEST_ASSERT_EQUAL_INT(STANDS + 1, n);
}

static void test_a_count_or_less_torque_begins_anew(void)
{
    for (int n = 0; n < NEVER; n++) {
        TEST_ASSERT_FALSE(stands(n / STANDS, true));
    }
    setUp();
    for (int n = 0; n < NEVER; n++) {
        TEST_ASSERT_FALSE(stands(7, n % STANDS != 0));
    }
}

/* Periods until it is said, of an error that changes its side every so many; NEVER. */
static int periods_until_swinging(double turns, int half_cycle, int half_cycles)
{
    setUp();
    for (int n = 1; n < NEVER; n++) {
        const bool ahead = n / half_cycle % 2 == 0 && n / half_cycle < half_cycles;

        if (rotor_watch_swings(&watch.swing, num_from_double(ahead ? turns : -turns), NUM(1.0),
                               ++period, WITHIN)) {
            return n;
        }
    }
    return NEVER;
}

static void test_a_rotor_that_is_thrown_to_and_fro_is_said_at_the_third_turn(void)
{
    TEST_ASSERT_EQUAL_INT(3 * 60, periods_until_swinging(1.01, 60, NEVER));
}

static void test_a_rotor_that_is_off_for_long_or_slowly_or_little_does_not_swing(void)
{
    TEST_ASSERT_EQUAL_INT(NEVER, periods_until_swinging(0.99, 60, NEVER));
    TEST_ASSERT_EQUAL_INT(NEVER, periods_until_swinging(1.01, WITHIN + 1, NEVER));
    TEST_ASSERT_EQUAL_INT(NEVER, periods_until_swinging(1.01, 60, 2)); /* ahead, then behind */
}

/* Each step of the reference lets its rotor swing anew. */
static void test_a_step_of_the_reference_begins_anew(void)
{
    setUp();
    for (int n = 0; n < NEVER; n++) {
        const struct position reference = {n / 150, 0u};

        if (rotor_watch_jumps(&watch, reference, NUM(0.5))) {
            rotor_watch_reset_swing(&watch.swing);
        }
        TEST_ASSERT_FALSE(rotor_watch_swings(&watch.swing, n / 50 % 2 == 0 ? NUM(1.1) : NUM(-1.1),
                                             NUM(1.0), ++period, WITHIN));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_count_that_stands_still_at_full_torque_is_said_after_30_ms);
    RUN_TEST(test_a_count_or_less_torque_begins_anew);
    RUN_TEST(test_a_rotor_that_is_thrown_to_and_fro_is_said_at_the_third_turn);
    RUN_TEST(test_a_rotor_that_is_off_for_long_or_slowly_or_little_does_not_swing);
    RUN_TEST(test_a_step_of_the_reference_begins_anew);
    return UNITY_END();
}
