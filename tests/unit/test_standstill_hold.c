/* Holding at rest: when it begins, how the current ramps, what ends it. */
#include "firmware/control/standstill_hold.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

#define HOLD_A           1.5
#define RAMP_PERIODS     100u /* 10 ms */
#define RAMP_OUT_PERIODS 150u
#define DELAY_PERIODS    150u /* 15 ms */
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

static const int32_t degree = (int32_t)(4294967296.0 / 360.0);

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
        standstill_hold_consider(&hold, &params, reference,
                                 num_from_double(error_electrical_deg / 360.0),
                                 num_from_double(speed_rad_s / base.speed_rad_s));
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

/* 18 degrees electrical, from either side. */
static void test_the_hold_waits_until_the_rotor_is_near(void)
{
    static const double far[] = {19.0, -19.0, 90.0, -180.0};

    for (unsigned i = 0; i < sizeof far / sizeof far[0]; i++) {
        step(UINT32_MAX, far[i], 0.0);
        TEST_ASSERT_FALSE(hold.active);
    }
    step(UINT32_MAX, -17.0, 0.0);
    TEST_ASSERT_TRUE(hold.active);
}

/* In the frame of that place: from there it is led to its reference. */
static void test_a_rotor_that_stands_off_its_reference_is_held_where_it_is(void)
{
    reference = 0x40000000u; /* 90 degrees */
    for (int side = -1; side <= 1; side += 2) {
        const double rotor = (90.0 + side * 60.0) / 180.0 * acos(-1.0);

        standstill_hold_reset(&hold, &params);
        standstill_hold_put_place(&hold, side * 60 * degree);
        step(UINT32_MAX, -side * 79.0, 0.0);
        TEST_ASSERT_FALSE(hold.active);
        step(UINT32_MAX, -side * 60.0, 0.80);
        TEST_ASSERT_FALSE(hold.active);
        step(UINT32_MAX, -side * 65.0, 0.0);
        TEST_ASSERT_TRUE(hold.active);
        TEST_ASSERT_TRUE(hold.leads);
        TEST_ASSERT_EQUAL_INT32(side * 60 * degree, hold.offset);
        TEST_ASSERT_NUM_WITHIN(SINE_ERROR, cos(rotor), num_from_unit(hold.frame.cos));
        TEST_ASSERT_NUM_WITHIN(SINE_ERROR, sin(rotor), num_from_unit(hold.frame.sin));
    }
}

/* A later hold begins at the reference again. */
static void test_each_hold_has_a_place_of_its_own(void)
{
    standstill_hold_put_place(&hold, 60 * degree);
    step(UINT32_MAX, -60.0, 0.0);
    standstill_hold_put_place(&hold, 0);
    step(0u, 0.0, 0.0);
    TEST_ASSERT_FALSE(hold.active);
    step(UINT32_MAX, 0.0, 0.0);
    TEST_ASSERT_TRUE(hold.active);
    TEST_ASSERT_FALSE(hold.leads);
    TEST_ASSERT_EQUAL_INT32(0, hold.offset);
    standstill_hold_put_place(&hold, 60 * degree);
    standstill_hold_align(&hold, 0u, NUM(0.0), params.current);
    TEST_ASSERT_EQUAL_INT32(0, hold.offset);
}

static void test_its_frame_comes_back_to_the_reference(void)
{
    for (int side = -1; side <= 1; side += 2) {
        hold.offset = side * 60 * degree;
        for (int k = 1; k <= 8; k++) {
            standstill_hold_lead_back(&hold, 7 * degree);
            TEST_ASSERT_EQUAL_INT32(side * (60 - 7 * k) * degree, hold.offset);
        }
        standstill_hold_lead_back(&hold, 7 * degree);
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
    RUN_TEST(test_a_rotor_that_stands_off_its_reference_is_held_where_it_is);
    RUN_TEST(test_each_hold_has_a_place_of_its_own);
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
