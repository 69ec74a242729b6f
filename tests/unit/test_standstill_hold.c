/* Holding at rest: when it begins, how the current ramps, what ends it. */
#include "firmware/control/standstill_hold.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

#define HOLD_A           1.5
#define RAMP_PERIODS     100u /* 10 ms */
#define RAMP_OUT_PERIODS 150u
#define DELAY_PERIODS    150u /* 15 ms */
#define STANDING_PERIODS (4u * DELAY_PERIODS)
#define RESTING          (DELAY_PERIODS + 1u)

static const struct standstill_hold_task task = {
    .current_A = HOLD_A,
    .ramp_s = 0.010,
    .ramp_out_s = 0.015,
    .delay_s = 0.015,
    .enters_at_rest = true,
    .current_limit_A = 3.0,
    .damping_As_rad = 0.78,
    .period_s = PERIOD_S,
};

static struct per_unit base;
static struct standstill_hold_params params;
static struct standstill_hold hold;
static angle_t reference;

void setUp(void)
{
    base = per_unit_base(&bench_params, PERIOD_S);
    params = standstill_hold_design(&base, &task);
    standstill_hold_reset(&hold, &params);
    reference = 0;
}

void tearDown(void)
{
}

/* One period, as the control interrupt has it. */
static void step(uint32_t rest_periods, double error_electrical_deg, double speed_rad_s)
{
    if (hold.active) {
        (void)standstill_hold_current(&hold, &params);
    } else {
        (void)standstill_hold_motion_current(&hold, &params);
    }
    if (!hold.active && standstill_hold_waits(&params, rest_periods)) {
        const num_t error = num_from_double(error_electrical_deg / 360.0);

        standstill_hold_consider(
            &hold, &params, reference, error, num_from_double(speed_rad_s / base.speed_rad_s),
            standstill_hold_sees_rotor_stand(&hold, &params, error, rest_periods));
    }
    standstill_hold_leave(&hold, rest_periods, false);
}

static double i_d_A(void)
{
    return num_to_double(hold.i_d) * base.current_A;
}

static void hold_with_full_current(void)
{
    for (uint32_t k = 0; k < 2u * RAMP_PERIODS; k++) {
        step(RESTING + k, 0.0, 0.0);
    }
}

static void test_the_hold_begins_when_the_reference_has_rested_for_its_delay(void)
{
    for (uint32_t k = 0; k < DELAY_PERIODS; k++) {
        step(k, 0.0, 0.0);
        TEST_ASSERT_FALSE(hold.active);
        TEST_ASSERT_TRUE(hold.i_d == NUM(0.0));
    }
    step(DELAY_PERIODS, 0.0, 0.0);
    TEST_ASSERT_TRUE(hold.active); /* from the next period on */
    TEST_ASSERT_TRUE(hold.i_d == NUM(0.0));
}

/* From the beginning of the wait on. */
static void wait_for_rotor(uint32_t periods, double error_electrical_deg, double speed_rad_s)
{
    for (uint32_t k = 0; k < periods; k++) {
        step(DELAY_PERIODS + k, error_electrical_deg, speed_rad_s);
    }
}

/* 18 degrees electrical, from either side. */
static void test_the_hold_waits_until_the_rotor_is_near(void)
{
    static const double far[] = {19.0, -19.0, 90.0, -180.0};

    for (unsigned i = 0; i < sizeof far / sizeof far[0]; i++) {
        wait_for_rotor(STANDING_PERIODS - 1u, far[i], 0.0);
        TEST_ASSERT_FALSE(hold.active);
    }
    wait_for_rotor(1u, -17.0, 0.0);
    TEST_ASSERT_TRUE(hold.active);
    TEST_ASSERT_FALSE(hold.leads);
}

/* In its own frame: it is behind the reference or ahead. */
static void test_a_rotor_that_stands_away_from_the_reference_is_held_where_it_is(void)
{
    static const double away_deg[] = {60.0, -60.0, 89.0};

    for (unsigned i = 0; i < sizeof away_deg / sizeof away_deg[0]; i++) {
        const double rotor = (90.0 - away_deg[i]) / 180.0 * acos(-1.0);

        standstill_hold_reset(&hold, &params);
        reference = 0x40000000u; /* 90 degrees */
        wait_for_rotor(STANDING_PERIODS, away_deg[i], 0.0);
        TEST_ASSERT_TRUE(hold.active);
        TEST_ASSERT_TRUE(hold.leads);
        TEST_ASSERT_NUM_WITHIN(SINE_ERROR, cos(rotor), num_from_unit(hold.frame.cos));
        TEST_ASSERT_NUM_WITHIN(SINE_ERROR, sin(rotor), num_from_unit(hold.frame.sin));
    }
}

static void test_a_rotor_beyond_a_quarter_turn_is_not_held(void)
{
    wait_for_rotor(3u * STANDING_PERIODS, 91.0, 0.0);
    TEST_ASSERT_FALSE(hold.active);
    wait_for_rotor(3u * STANDING_PERIODS, 60.0, 0.80);
    TEST_ASSERT_FALSE(hold.active);
}

/* A swing of 45 degrees and 15 Hz is within 11 degrees of where it turns round for 15 ms. A rotor
   that stands creeps by 11 degrees in 60 ms at most. */
static void test_a_rotor_that_swings_does_not_stand_but_one_that_creeps_does(void)
{
    for (uint32_t k = 0; k < 10000u; k++) {
        step(DELAY_PERIODS + k, 65.0 + 45.0 * sin(0.00942 * k), 0.0);
        TEST_ASSERT_FALSE(hold.active);
    }
    for (uint32_t k = 0; k < STANDING_PERIODS; k++) {
        step(DELAY_PERIODS + k, 85.0 - 0.018 * k, 0.0);
    }
    TEST_ASSERT_TRUE(hold.active);
}

/* What it has stood in a wait before says nothing of the next. */
static void test_each_wait_begins_anew(void)
{
    wait_for_rotor(STANDING_PERIODS - 1u, 60.0, 0.0);
    wait_for_rotor(STANDING_PERIODS - 1u, 60.0, 0.0);
    TEST_ASSERT_FALSE(hold.active);
}

/* 60 degrees in steps of 7: the frame turns towards the reference, and rests when it is there. */
static void test_its_frame_comes_back_to_the_reference(void)
{
    const int32_t degree = (int32_t)(4294967296.0 / 360.0);
    const num_t pace = num_from_double(0.01);

    for (int side = -1; side <= 1; side += 2) {
        standstill_hold_reset(&hold, &params);
        wait_for_rotor(STANDING_PERIODS, 60.0 * side, 0.0);
        for (int k = 1; k <= 8; k++) {
            TEST_ASSERT_TRUE(standstill_hold_return(&hold, 7 * degree, pace) ==
                             (side < 0 ? -pace : pace));
            TEST_ASSERT_INT32_WITHIN(degree / 10, -side * (60 - 7 * k) * degree, hold.offset);
        }
        TEST_ASSERT_TRUE(standstill_hold_return(&hold, 7 * degree, pace) == NUM(0.0));
        TEST_ASSERT_EQUAL_INT32(0, hold.offset);
    }
}

/* Not faster than 1/16 electrical turn within the 10 ms ramp: 0.785 rad/s. */
static void test_the_hold_waits_until_the_rotor_is_slow(void)
{
    step(UINT32_MAX, 0.0, 0.80);
    TEST_ASSERT_FALSE(hold.active);
    step(UINT32_MAX, 0.0, -0.80);
    TEST_ASSERT_FALSE(hold.active);
    step(UINT32_MAX, 0.0, -0.77);
    TEST_ASSERT_TRUE(hold.active);
}

static void test_a_hold_once_begun_lasts_whatever_the_rotor_does(void)
{
    step(RESTING, 0.0, 0.0);
    step(RESTING + 1u, 60.0, 20.0);
    TEST_ASSERT_TRUE(hold.active);
}

/* Both directions of the current are those of the reference, whatever the rotor does. */
static void test_the_current_frame_is_that_of_the_reference(void)
{
    reference = 0x2aaaaaaau; /* 60 degrees */
    step(RESTING, 10.0, 0.0);
    TEST_ASSERT_NUM_WITHIN(SINE_ERROR, 0.5, num_from_unit(hold.frame.cos));
    TEST_ASSERT_NUM_WITHIN(SINE_ERROR, sqrt(0.75), num_from_unit(hold.frame.sin));
}

static void test_the_current_ramps_in_within_ten_milliseconds(void)
{
    step(RESTING, 0.0, 0.0);
    for (uint32_t k = 1; k <= RAMP_PERIODS; k++) {
        step(RESTING + k, 0.0, 0.0);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, HOLD_A * k / RAMP_PERIODS, i_d_A());
    }
    step(RESTING + RAMP_PERIODS + 1u, 0.0, 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, HOLD_A, i_d_A());
}

static void test_a_reference_that_moves_ends_the_hold_at_once_and_ramps_the_current_out_slower(void)
{
    hold_with_full_current();
    step(0, 0.0, 0.0);
    TEST_ASSERT_FALSE(hold.active);
    for (uint32_t k = 1; k <= RAMP_OUT_PERIODS; k++) {
        step(0, 0.0, 0.0);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, HOLD_A * (1.0 - (double)k / RAMP_OUT_PERIODS), i_d_A());
    }
    step(0, 0.0, 0.0);
    TEST_ASSERT_TRUE(hold.i_d == NUM(0.0));
}

static void test_the_torque_current_carries_the_load_and_damps(void)
{
    const num_t load = num_from_double(0.1 / base.torque_Nm);
    const num_t speed = num_from_double(0.5 / base.speed_rad_s);

    TEST_ASSERT_DOUBLE_WITHIN(
        1e-5, 0.1 / 0.157,
        num_to_double(standstill_hold_torque_current(&params, NUM(0.0), load)) * base.current_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.1 / 0.157 - 2.0 * 0.39 * 0.5,
                              num_to_double(standstill_hold_torque_current(&params, speed, load)) *
                                  base.current_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.1 / 0.157 + 2.0 * 0.39 * 0.5,
                              num_to_double(standstill_hold_torque_current(&params, -speed, load)) *
                                  base.current_A);
}

static void test_the_torque_current_is_limited(void)
{
    const num_t fast = num_from_double(50.0 / base.speed_rad_s);

    TEST_ASSERT_NUM_WITHIN(1e-6, -0.5, standstill_hold_torque_current(&params, fast, NUM(0.0)));
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.5, standstill_hold_torque_current(&params, -fast, NUM(0.0)));
}

static void test_a_reset_ends_the_hold_without_a_ramp(void)
{
    hold_with_full_current();
    standstill_hold_reset(&hold, &params);
    TEST_ASSERT_FALSE(hold.active);
    TEST_ASSERT_TRUE(hold.i_d == NUM(0.0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_hold_begins_when_the_reference_has_rested_for_its_delay);
    RUN_TEST(test_the_hold_waits_until_the_rotor_is_near);
    RUN_TEST(test_a_rotor_that_stands_away_from_the_reference_is_held_where_it_is);
    RUN_TEST(test_a_rotor_beyond_a_quarter_turn_is_not_held);
    RUN_TEST(test_a_rotor_that_swings_does_not_stand_but_one_that_creeps_does);
    RUN_TEST(test_each_wait_begins_anew);
    RUN_TEST(test_its_frame_comes_back_to_the_reference);
    RUN_TEST(test_the_hold_waits_until_the_rotor_is_slow);
    RUN_TEST(test_a_hold_once_begun_lasts_whatever_the_rotor_does);
    RUN_TEST(test_the_current_frame_is_that_of_the_reference);
    RUN_TEST(test_the_current_ramps_in_within_ten_milliseconds);
    RUN_TEST(test_a_reference_that_moves_ends_the_hold_at_once_and_ramps_the_current_out_slower);
    RUN_TEST(test_the_torque_current_carries_the_load_and_damps);
    RUN_TEST(test_the_torque_current_is_limited);
    RUN_TEST(test_a_reset_ends_the_hold_without_a_ramp);
    return UNITY_END();
}
