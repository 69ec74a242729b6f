/* The current laws: from position error and estimates to the torque-producing current. */
#include "firmware/control/position_law_dispatch.h"
#include "firmware/design/pid_design.h"
#include "firmware/design/state_feedback_design.h"
#include "firmware/numeric/angle.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

#define BANDWIDTH         200.0
#define CURRENT_BANDWIDTH 1500.0

/* Of 6 A: five terms; in fixed point the product with a gain of ten loses five bits. */
#define ROUNDING_A (6.0 * 64.0 * NUM_ROUNDING)

static struct per_unit base;
static enum position_law law;
static struct position_law_task task;
static union position_law_params params;
static union position_law_state state;
static char error[DESIGN_ERROR_TEXT];

static const struct position_law_input at_rest_in_place = {NUM(0.0), NUM(0.0), NUM(0.0), NUM(0.0),
                                                           NUM(0.0)};

void setUp(void)
{
    base = per_unit_base(&bench_params, PERIOD_S);
    task = (struct position_law_task){
        .motor = &bench_params,
        .base = &base,
        .period_s = PERIOD_S,
        .bandwidth_rad_s = BANDWIDTH,
        .current_bandwidth_rad_s = CURRENT_BANDWIDTH,
        .speed_limit_rad_s = 200.0,
        .current_limit_A = 3.0,
    };
    state.pid.integral = NUM(0.0);
}

void tearDown(void)
{
}

static void design(enum position_law which)
{
    law = which;
    TEST_ASSERT_TRUE_MESSAGE(position_law_design(law, &params, &task, error), error);
}

/* SI inputs of a law in per-unit. */
static struct position_law_input input(double error_rad, double reference_speed_rad_s,
                                       double acceleration_rad_s2, double speed_rad_s,
                                       double load_torque_Nm)
{
    return (struct position_law_input){
        .position_error = num_from_double(error_rad / base.rad_per_turn),
        .reference_speed = num_from_double(reference_speed_rad_s / base.speed_rad_s),
        .reference_acceleration = num_from_double(acceleration_rad_s2 / base.acceleration_rad_s2),
        .speed = num_from_double(speed_rad_s / base.speed_rad_s),
        .load_torque = num_from_double(load_torque_Nm / base.torque_Nm),
    };
}

static double current_A(struct position_law_input in)
{
    return num_to_double(position_law_current(law, &state, &params, &in)) * base.current_A;
}

/* `terms_A`: the sum of the terms' magnitudes, of which each gain's mantissa is a share wrong. */
static void is_current(double expected_A, double terms_A, double actual_A)
{
    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_A + terms_A * COEF_ROUNDING, expected_A, actual_A);
}

/* (19) as published: no reference speed, no reference acceleration. */
/* Reference and rotor as fast as they may be, against one another; or what a term of 10 leaves. */
static void test_errors_count_up_to_twice_the_speed_limit(void)
{
    task.speed_limit_rad_s = 50.0;
    design(POSITION_LAW_STATE_FEEDBACK);
    const struct error_feedback_params *feedback = &params.state_feedback.feedback;
    const double speed = 2.0 * 50.0 / base.speed_rad_s;

    TEST_ASSERT_NUM_WITHIN(1e-4 * speed, speed, feedback->speed_error_limit);
    TEST_ASSERT_NUM_WITHIN(1e-3,
                           fmin(10.0 / coef_to_double(feedback->position), POSITION_DIFFERENCE_MAX),
                           feedback->position_error_limit);
    task.speed_limit_rad_s = 1e6;
    design(POSITION_LAW_STATE_FEEDBACK);
    TEST_ASSERT_NUM_WITHIN(1e-2, 10.0, num_mul_coef(feedback->speed_error_limit, feedback->speed));
    TEST_ASSERT_NUM_WITHIN(1e-6, 3.0 / base.current_A, feedback->current_limit);
}

static void test_state_feedback_without_feed_forward_is_equation_19(void)
{
    static const double cases[][3] = {
        /* rad, rad/s, N m */
        {0.01, 0.0, 0.0}, {0.0, 4.0, 0.0},    {0.0, 0.0, 0.2},
        {0.2, 20.0, 0.1}, {-0.3, -25.0, -.1}, {0.457, 45.0, 0.05},
    };
    struct state_feedback_gains k;

    design(POSITION_LAW_STATE_FEEDBACK);
    TEST_ASSERT_TRUE(
        state_feedback_design(&bench_params, PERIOD_S, BANDWIDTH, CURRENT_BANDWIDTH, &k, error));
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const double *c = cases[i];
        const double expected =
            k.k_angle_A_rad * c[0] - k.k_speed_As_rad * c[1] + k.k_load_A_Nm * c[2];

        is_current(expected, 40.0, current_A(input(c[0], 0.0, 0.0, c[1], c[2])));
    }
}

static void test_state_feedback_with_feed_forward_adds_the_torque_of_the_reference(void)
{
    design(POSITION_LAW_STATE_FEEDBACK);

    for (double speed = -100.0; speed <= 100.0; speed += 20.0) {
        const double acceleration = 10.0 * speed;
        const double friction_A = 0.307e-3 * speed / 0.157;
        const double inertia_A = 15.62e-5 * acceleration / 0.157;

        is_current(friction_A, 0.2, current_A(input(0.0, speed, 0.0, speed, 0.0)));
        is_current(friction_A + inertia_A, 1.2,
                   current_A(input(0.0, speed, acceleration, speed, 0.0)));
    }
}

/* K_L = 1/Km: the current carries the load, no more. */
static void test_state_feedback_in_place_carries_the_load_and_nothing_else(void)
{
    design(POSITION_LAW_STATE_FEEDBACK);

    is_current(0.2 / 0.157, 1.3, current_A(input(0.0, 0.0, 0.0, 0.0, 0.2)));
    is_current(0.0, 0.0, current_A(at_rest_in_place));
}

static void test_the_current_is_limited_in_both_directions(void)
{
    for (int which = 0; which < POSITION_LAW_VOLTAGE_FIRST; which++) {
        design((enum position_law)which);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 3.0, current_A(input(0.5, 0.0, 0.0, 0.0, 0.0)));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, -3.0, current_A(input(-0.5, 0.0, 0.0, 0.0, 0.0)));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, -3.0, current_A(input(0.0, 0.0, 0.0, 100.0, 0.0)));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 3.0, current_A(input(0.0, 0.0, 0.0, -100.0, 0.0)));
    }
}

/* However far the reference: the sum of all terms stays inside the numbers and keeps its sign. */
static void test_the_largest_errors_keep_the_sign_of_the_current(void)
{
    const double far = POSITION_DIFFERENCE_MAX * base.rad_per_turn;
    const double acceleration = 3.0 * 0.157 / 15.62e-5;

    for (int which = 0; which < POSITION_LAW_VOLTAGE_FIRST; which++) {
        for (int steep = 0; steep < 2; steep++) {
            task.bandwidth_rad_s = steep ? 370.0 : 5.0;
            design((enum position_law)which);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, 3.0,
                                      current_A(input(far, 200.0, acceleration, -200.0, 0.4)));
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, -3.0,
                                      current_A(input(-far, -200.0, -acceleration, 200.0, -0.4)));
        }
    }
}

static void test_pid_sums_error_speed_and_integral(void)
{
    struct pid_gains k;

    design(POSITION_LAW_PID);
    TEST_ASSERT_TRUE(pid_design(&bench_params, PERIOD_S, BANDWIDTH, CURRENT_BANDWIDTH, &k, error));
    for (int period = 1; period <= 10; period++) {
        const double e = 0.005;
        const double expected = k.k_proportional_A_rad * e - k.k_speed_As_rad * 1.0 +
                                period * k.k_integral_step_A_rad * e;

        is_current(expected, 2.0, current_A(input(e, 0.0, 0.0, 1.0, 0.0)));
    }
}

/* The PID learns the load by itself; the estimate of it is not fed in twice. */
static void test_pid_takes_no_load_estimate(void)
{
    design(POSITION_LAW_PID);

    is_current(0.0, 0.0, current_A(input(0.0, 0.0, 0.0, 0.0, 0.3)));
}

static void test_pid_does_not_wind_up_while_the_current_is_limited(void)
{
    design(POSITION_LAW_PID);

    for (int k = 0; k < 5000; k++) {
        (void)current_A(input(0.05, 0.0, 0.0, 0.0, 0.0));
    }
    is_current(0.0, 0.0, current_A(at_rest_in_place));
    for (int k = 0; k < 5000; k++) {
        (void)current_A(input(-0.05, 0.0, 0.0, 0.0, 0.0));
    }
    is_current(0.0, 0.0, current_A(at_rest_in_place));
}

/* Limited by speed while the error would take current back: that the integrator may learn. */
static void test_pid_unwinds_while_the_current_is_limited_the_other_way(void)
{
    design(POSITION_LAW_PID);

    for (int k = 0; k < 100; k++) {
        (void)current_A(input(-0.005, 0.0, 0.0, -50.0, 0.0));
    }
    TEST_ASSERT_TRUE(state.pid.integral < NUM(0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 3.0, current_A(input(-0.005, 0.0, 0.0, -50.0, 0.0)));
}

static void test_the_integral_of_the_pid_stays_within_the_current_limit(void)
{
    design(POSITION_LAW_PID);

    for (int k = 0; k < 20000; k++) {
        (void)current_A(input(0.01, 0.0, 0.0, 5.0, 0.0));
    }
    TEST_ASSERT_TRUE(num_to_double(state.pid.integral) * base.current_A <= 3.0 + 1e-6);
}

static void test_a_law_too_quick_for_the_current_control_is_refused_with_its_limit(void)
{
    for (int which = 0; which < POSITION_LAW_VOLTAGE_FIRST; which++) {
        task.bandwidth_rad_s = 400.0;
        task.current_bandwidth_rad_s = 1500.0;
        TEST_ASSERT_FALSE(position_law_design((enum position_law)which, &params, &task, error));
        TEST_ASSERT_EQUAL_STRING("position bandwidth 400 rad/s: must be at most 375 rad/s, "
                                 "a quarter of the current's",
                                 error);
        task.current_bandwidth_rad_s = 4000.0;
        TEST_ASSERT_FALSE(position_law_design((enum position_law)which, &params, &task, error));
        TEST_ASSERT_EQUAL_STRING("current bandwidth 4000 rad/s: must be at most 3000 rad/s, "
                                 "0.3 per control period",
                                 error);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_errors_count_up_to_twice_the_speed_limit);
    RUN_TEST(test_state_feedback_without_feed_forward_is_equation_19);
    RUN_TEST(test_state_feedback_with_feed_forward_adds_the_torque_of_the_reference);
    RUN_TEST(test_state_feedback_in_place_carries_the_load_and_nothing_else);
    RUN_TEST(test_the_current_is_limited_in_both_directions);
    RUN_TEST(test_the_largest_errors_keep_the_sign_of_the_current);
    RUN_TEST(test_pid_sums_error_speed_and_integral);
    RUN_TEST(test_pid_takes_no_load_estimate);
    RUN_TEST(test_pid_does_not_wind_up_while_the_current_is_limited);
    RUN_TEST(test_pid_unwinds_while_the_current_is_limited_the_other_way);
    RUN_TEST(test_the_integral_of_the_pid_stays_within_the_current_limit);
    RUN_TEST(test_a_law_too_quick_for_the_current_control_is_refused_with_its_limit);
    return UNITY_END();
}
