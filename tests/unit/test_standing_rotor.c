/* A rotor that stands off its reference is to be held where it is, and led back. */
#include "firmware/drive/standing_rotor.h"
#include "tests/unit/drive_bench.h"
#include "tests/unit/num_assert.h"

#define DELAY_PERIODS 150u /* the hold's, 15 ms */
#define DELAYS        (4u * DELAY_PERIODS)

static const int32_t degree = (int32_t)(4294967296.0 / 360.0);

static struct standing_rotor standing;
static uint32_t now;
static int32_t place; /* the last look's */

void setUp(void)
{
    standing = (struct standing_rotor){0};
    now = 0u;
    place = 0;
    drive_bench_reset();
}

void tearDown(void)
{
}

static void look(double error_deg)
{
    place = standing_rotor_look(&standing, (int64_t)(-error_deg * degree), ++now, DELAYS);
}

static void look_for(uint32_t periods, double error_deg)
{
    for (uint32_t k = 0; k < periods; k++) {
        look(error_deg);
    }
}

static void test_a_rotor_stands_that_has_not_left_its_place_for_four_delays(void)
{
    static const double errors_deg[] = {60.0, -60.0, 89.0};

    for (unsigned i = 0; i < sizeof errors_deg / sizeof errors_deg[0]; i++) {
        look_for(DELAYS, errors_deg[i]);
        TEST_ASSERT_EQUAL_INT32(0, place);
        look(0.9 * errors_deg[i]);
        TEST_ASSERT_INT32_WITHIN(degree / 100, (int32_t)-errors_deg[i] * degree, place);
    }
}

/* 11.25 degrees are its place. */
static void test_what_leaves_its_place_begins_anew(void)
{
    look_for(DELAYS, 60.0);
    look(48.0);
    look_for(DELAYS - 1u, 60.0);
    TEST_ASSERT_EQUAL_INT32(0, place);
}

/* The hold's d axis would draw it the other way. */
static void test_a_rotor_beyond_a_quarter_turn_does_not_stand(void)
{
    look_for(3u * DELAYS, 91.0);
    TEST_ASSERT_EQUAL_INT32(0, place);
    look_for(DELAYS + 1u, 80.0);
    TEST_ASSERT_NOT_EQUAL(0, place);
    look(90.5);
    TEST_ASSERT_EQUAL_INT32(0, place);
    look_for(3u * DELAYS, -1800.0);
    TEST_ASSERT_EQUAL_INT32(0, place);
}

/* A swing of 45 degrees and 15 Hz is within 11 degrees of where it turns round for 15 ms. A rotor
   that stands creeps by 11 degrees in 60 ms at most. */
static void test_a_rotor_that_swings_does_not_stand_but_one_that_creeps_does(void)
{
    for (uint32_t k = 0; k < 10000u; k++) {
        look(40.0 + 45.0 * sin(0.00942 * k));
        TEST_ASSERT_EQUAL_INT32(0, place);
    }
    for (uint32_t k = 0; k <= DELAYS; k++) {
        look(85.0 - 0.018 * k);
    }
    TEST_ASSERT_NOT_EQUAL(0, place);
}

/* The estimate and the reference of a drive in operation, whose interrupt does not run. */
static void pass(uint32_t periods, double error_deg)
{
    for (uint32_t k = 0; k < periods; k++) {
        drive.estimator.estimate.next.position = position_add(
            drive.reference.next.position, angle_from_turns(num_from_double(-error_deg / 360.0)));
        drive.supervision.period++;
        standing_rotor_background(&drive);
    }
}

static void enabled_drive_whose_hold_waits(void)
{
    enable();
    TEST_ASSERT_EQUAL_INT(DRIVE_OPERATION_ENABLED, drive.supervision.state);
    drive.hold.active = false;
    drive.params.hold.delay_periods = DELAY_PERIODS;
    drive.reference.slow_periods = DELAY_PERIODS;
}

static void test_its_place_is_known_while_the_hold_waits(void)
{
    enabled_drive_whose_hold_waits();
    pass(DELAYS + 1u, 60.0);
    TEST_ASSERT_INT32_WITHIN(degree / 100, -60 * degree, drive.hold.place);
    drive.reference.slow_periods = 0u;
    pass(1u, 60.0);
    TEST_ASSERT_EQUAL_INT32(0, drive.hold.place);
    drive.reference.slow_periods = DELAY_PERIODS;
    pass(DELAYS - 1u, 60.0);
    TEST_ASSERT_EQUAL_INT32(0, drive.hold.place);
}

/* What no hold would lead is not held off its reference. */
static void test_where_no_hold_leads_nothing_stands(void)
{
    enabled_drive_whose_hold_waits();
    drive.params.reference.creep_speed = NUM(0.0);
    pass(2u * DELAYS, 60.0);
    TEST_ASSERT_EQUAL_INT32(0, drive.hold.place);
}

/* It stands there for longer than any step of its way back takes. */
static void test_a_hold_begins_where_the_rotor_stands(void)
{
    enabled_drive_whose_hold_waits();
    pass(2u * DELAYS, 60.0);
    standstill_hold_consider(&drive.hold, &drive.params.hold,
                             drive.reference.next.position.fraction, num_from_double(60.0 / 360.0),
                             NUM(0.0));
    TEST_ASSERT_TRUE(drive.hold.active);
    drive.supervision.period += 9u;
    pass(1u, 60.0);
    TEST_ASSERT_INT32_WITHIN(degree / 100, -60 * degree, drive.hold.offset);
    pass(1u, 60.0);
    TEST_ASSERT_TRUE(drive.hold.offset > -60 * degree);
    TEST_ASSERT_INT32_WITHIN(degree, -60 * degree, drive.hold.offset);
}

/* However seldom the background comes to it, up to every 3.2 ms. */
static void test_a_frame_comes_back_at_the_speed_at_which_it_creeps(void)
{
    enabled_drive_whose_hold_waits();
    const double creep_turns =
        num_to_double(half_period_turns(&drive.params.model, drive.params.reference.creep_speed)) *
        2.0;

    for (int side = -1; side <= 1; side += 2) {
        for (uint32_t every = 1u; every <= 32u; every += 31u) {
            drive.hold.active = true;
            drive.hold.offset = side * 60 * degree;
            pass(1u, 0.0);
            drive.hold.offset = side * 60 * degree;
            for (uint32_t k = 0; k < 64u; k += every) {
                drive.supervision.period += every - 1u;
                pass(1u, 0.0);
            }
            TEST_ASSERT_INT32_WITHIN(
                degree / 100, side * (60 * degree - (int32_t)(64.0 * creep_turns * 4294967296.0)),
                drive.hold.offset);
        }
        for (int k = 0; k < 10000 && drive.hold.offset != 0; k++) {
            pass(1u, 0.0);
            TEST_ASSERT_TRUE(side * drive.hold.offset >= 0);
        }
        TEST_ASSERT_EQUAL_INT32(0, drive.hold.offset);
    }
}

static void test_a_background_that_was_busy_leads_it_by_3_2_ms_whatever_the_period(void)
{
    static const double period_s[] = {50e-6, 100e-6, 200e-6};

    for (int i = 0; i < 3; i++) {
        drive_bench_reset();
        board.facts = &encoder_facts;
        enabled_drive_whose_hold_waits();
        encoder_facts.control_period_s = period_s[i];
        drive.hold.active = true;
        pass(1u, 0.0);
        drive.hold.offset = 60 * degree;
        pass(1u, 0.0);
        const int32_t step = 60 * degree - drive.hold.offset;

        drive.hold.offset = 60 * degree;
        drive.supervision.period += 999u;
        pass(1u, 0.0);
        TEST_ASSERT_TRUE(step > 0);
        TEST_ASSERT_EQUAL_INT32((64 >> i) * step, 60 * degree - drive.hold.offset);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_rotor_stands_that_has_not_left_its_place_for_four_delays);
    RUN_TEST(test_what_leaves_its_place_begins_anew);
    RUN_TEST(test_a_rotor_beyond_a_quarter_turn_does_not_stand);
    RUN_TEST(test_a_rotor_that_swings_does_not_stand_but_one_that_creeps_does);
    RUN_TEST(test_its_place_is_known_while_the_hold_waits);
    RUN_TEST(test_where_no_hold_leads_nothing_stands);
    RUN_TEST(test_a_hold_begins_where_the_rotor_stands);
    RUN_TEST(test_a_frame_comes_back_at_the_speed_at_which_it_creeps);
    RUN_TEST(test_a_background_that_was_busy_leads_it_by_3_2_ms_whatever_the_period);
    return UNITY_END();
}
