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

/* Periods until it is said, of a rotor that is thrown to one side for a tenth of each cycle and is
   back at this share of the limit in between; NEVER. */
static int periods_until_thrown(double turns, double back, int cycle)
{
    setUp();
    for (int n = 1; n < NEVER; n++) {
        const bool thrown = n % cycle >= cycle - cycle / 10;

        if (rotor_watch_swings(&watch.swing, num_from_double(thrown ? turns : back), NUM(1.0),
                               ++period, WITHIN)) {
            return n;
        }
    }
    return NEVER;
}

static void test_a_rotor_that_is_thrown_to_one_side_is_said_the_fourth_time(void)
{
    TEST_ASSERT_EQUAL_INT(3 * 80 + 72, periods_until_thrown(1.01, 0.49, 80));
    TEST_ASSERT_EQUAL_INT(3 * 80 + 72, periods_until_thrown(-1.01, -0.49, 80));
    TEST_ASSERT_EQUAL_INT(3 * 80 + 72, periods_until_thrown(1.01, -0.49, 80));
}

/* It need not come back to its place, as it slips on. */
static void test_a_rotor_that_is_thrown_further_and_further_is_said_too(void)
{
    setUp();
    for (int n = 1; n < NEVER; n++) {
        const double turns = 3.0 + 0.002 * n + (n % 80 >= 72 ? 0.56 : 0.0);

        if (rotor_watch_swings(&watch.swing, num_from_double(turns), NUM(1.0), ++period, WITHIN)) {
            TEST_ASSERT_EQUAL_INT(4 * 80 + 72, n);
            return;
        }
    }
    TEST_FAIL();
}

/* Hovering about the limit is one time; what is seldom has ended meanwhile. */
static void test_a_rotor_that_is_not_back_or_is_thrown_seldom_does_not_swing(void)
{
    TEST_ASSERT_EQUAL_INT(NEVER, periods_until_thrown(1.01, 0.51, 80));
    TEST_ASSERT_EQUAL_INT(NEVER, periods_until_thrown(-1.01, -0.51, 80));
    TEST_ASSERT_EQUAL_INT(NEVER, periods_until_thrown(0.99, 0.0, 80));
    TEST_ASSERT_EQUAL_INT(NEVER, periods_until_thrown(1.01, 0.0, WITHIN));
    TEST_ASSERT_EQUAL_INT(3 * 90 + 81, periods_until_thrown(1.01, 0.0, 90));
}

/* Periods until it is said to stay away, of an error that is this, and back by so much behind half
   of them; NEVER. */
static int periods_until_away(double turns, double back)
{
    setUp();
    for (int n = 1; n < NEVER; n++) {
        const double error = n > WITHIN / 2 ? turns - back : turns;

        (void)rotor_watch_swings(&watch.swing, num_from_double(error), NUM(1.0), ++period, WITHIN);
        if (rotor_watch_stays_away(&watch.swing, period, WITHIN)) {
            return n;
        }
    }
    return NEVER;
}

/* As it trembles, it comes back by its speed, but not by its place. */
static void test_a_rotor_that_does_not_come_back_is_said(void)
{
    TEST_ASSERT_EQUAL_INT(WITHIN + 2, periods_until_away(1.01, 0.0));
    TEST_ASSERT_EQUAL_INT(WITHIN + 2, periods_until_away(-1.4, -0.49));
    TEST_ASSERT_EQUAL_INT(NEVER, periods_until_away(1.01, 0.51));
    TEST_ASSERT_EQUAL_INT(NEVER, periods_until_away(-1.4, -0.51));
    TEST_ASSERT_EQUAL_INT(NEVER, periods_until_away(0.99, 0.0));
}

/* ---- the winding ---- */

static const double resistance = 0.05, reactance_per_speed = 0.3, margin = 0.1, rate = 0.5;

/* A sample of these currents, off by what a voltage leads to, while a speed is counted. */
static bool denies(double counted, double a, double b, double voltage_a, double voltage_b)
{
    const struct rotor_winding winding = {
        .current = {num_from_double(a), num_from_double(b)},
        .expected = {num_from_double(a - rate * voltage_a), num_from_double(b - rate * voltage_b)},
        .speed = num_from_double(counted),
        .resistance = num_from_double(resistance),
        .reactance = num_from_double(reactance_per_speed * counted),
        .rate = coef_from_double(rate),
    };

    return rotor_watch_winding_denies(&winding, num_from_double(margin));
}

/* In either phase and on either side; both phases' add up. */
static void denies_from(double counted, double a, double b, double voltage)
{
    for (double sign = -1.0; sign < 2.0; sign += 2.0) {
        const double less = sign * (voltage - 1e-3), more = sign * (voltage + 1e-3);

        TEST_ASSERT_FALSE(denies(counted, a, b, less, 0.0));
        TEST_ASSERT_TRUE(denies(counted, a, b, more, 0.0));
        TEST_ASSERT_FALSE(denies(counted, a, b, 0.0, less));
        TEST_ASSERT_TRUE(denies(counted, a, b, 0.0, more));
        TEST_ASSERT_FALSE(denies(counted, a, b, 0.25 * less, -0.75 * less));
        TEST_ASSERT_TRUE(denies(counted, a, b, 0.25 * more, -0.75 * more));
    }
}

static void test_a_winding_denies_a_count_that_stands_beyond_the_margin(void)
{
    denies_from(0.0, 0.0, 0.0, margin);
}

/* What the torque constant may err by, and channels that are exchanged never do. */
static void test_half_of_the_counted_back_emf_may_be_wrong(void)
{
    denies_from(0.4, 0.0, 0.0, margin + 0.5 * 0.4);
    denies_from(-0.4, 0.0, 0.0, margin + 0.5 * 0.4);
}

static void test_half_of_the_voltages_of_the_currents_may_be_wrong(void)
{
    denies_from(0.0, 0.5, -0.25, margin + 0.5 * resistance * 0.75);
    denies_from(0.4, -0.5, 0.25,
                margin + 0.5 * (0.4 + (resistance + reactance_per_speed * 0.4) * 0.75));
    denies_from(-0.4, 0.5, 0.25,
                margin + 0.5 * (0.4 + (resistance + reactance_per_speed * 0.4) * 0.75));
}

static bool looks(bool denying, uint32_t periods)
{
    period += periods;
    return rotor_watch_denies(&watch, denying, (struct phases){NUM(0.5), NUM(0.25)}, period);
}

/* The first has nothing to be compared with, nor has one behind a pause. */
static void test_fifty_denials_in_a_row_are_an_encoders_fault(void)
{
    for (int round = 0; round < 3; round++) {
        TEST_ASSERT_FALSE(looks(true, 2));
        for (int n = 1; n < 50; n++) {
            TEST_ASSERT_FALSE(looks(true, 1));
            if (n % 10 == 0) {
                TEST_ASSERT_FALSE(looks(n % 20 == 0, 2));
            }
        }
        TEST_ASSERT_TRUE(looks(true, 1));
        TEST_ASSERT_TRUE(looks(true, 1));
        TEST_ASSERT_FALSE(looks(false, 1));
    }
    TEST_ASSERT_TRUE(watch.expected.a == NUM(0.5) && watch.expected.b == NUM(0.25));
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
    RUN_TEST(test_a_rotor_that_is_thrown_to_one_side_is_said_the_fourth_time);
    RUN_TEST(test_a_rotor_that_is_thrown_further_and_further_is_said_too);
    RUN_TEST(test_a_rotor_that_is_not_back_or_is_thrown_seldom_does_not_swing);
    RUN_TEST(test_fifty_denials_in_a_row_are_an_encoders_fault);
    RUN_TEST(test_a_rotor_that_does_not_come_back_is_said);
    RUN_TEST(test_a_winding_denies_a_count_that_stands_beyond_the_margin);
    RUN_TEST(test_half_of_the_counted_back_emf_may_be_wrong);
    RUN_TEST(test_half_of_the_voltages_of_the_currents_may_be_wrong);
    return UNITY_END();
}
