/* The d-q current control on a simulated winding at constant speed. */
#include "firmware/control/current_control.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

#define BANDWIDTH 1500.0
#define LIMIT     0.92 /* voltage, per-unit */

static struct per_unit base;
static struct current_control_params params;
static struct current_control control;

/* A winding in a frame that turns, per-unit, at speeds in rad/s; the voltage acts at once. */
static struct {
    double d, q;
    double speed_rad_s;       /* of the rotor */
    double frame_speed_rad_s; /* the same, but in a hold */
    double resistance_ohm;
} winding;

/* The rotor, and the frame with it. */
static void turn(double speed_rad_s)
{
    winding.speed_rad_s = speed_rad_s;
    winding.frame_speed_rad_s = speed_rad_s;
}

void setUp(void)
{
    base = per_unit_base(&bench_params, PERIOD_S);
    params = current_control_design(&bench_params, &base, PERIOD_S, BANDWIDTH);
    current_control_reset(&control);
    winding.d = 0.0;
    winding.q = 0.0;
    turn(0.0);
    winding.resistance_ohm = bench_params.resistance_ohm;
}

void tearDown(void)
{
}

/* L di/dt = u - R i - j N w_f L i - j Km w by the midpoint rule, good to 1e-5 of a step. */
static void run_winding(struct dq voltage)
{
    const int steps = 10;
    const double time_s = PERIOD_S / steps;
    const double rate = time_s * base.resistance_ohm / bench_params.inductance_H;
    const double decay = time_s * winding.resistance_ohm / bench_params.inductance_H;
    const double rotation = 50.0 * winding.frame_speed_rad_s * time_s;
    const double drive_d = rate * num_to_double(voltage.d);
    const double drive_q =
        rate * (num_to_double(voltage.q) - winding.speed_rad_s / base.speed_rad_s);

    for (int k = 0; k < steps; k++) {
        const double d = winding.d + 0.5 * (drive_d - decay * winding.d + rotation * winding.q);
        const double q = winding.q + 0.5 * (drive_q - decay * winding.q - rotation * winding.d);

        winding.d += drive_d - decay * d + rotation * q;
        winding.q += drive_q - decay * q - rotation * d;
    }
}

static struct dq step(double d, double q)
{
    const struct dq reference = {num_from_double(d), num_from_double(q)};
    const struct dq current = {num_from_double(winding.d), num_from_double(winding.q)};
    const struct rotation speed = {num_from_double(winding.frame_speed_rad_s / base.speed_rad_s),
                                   num_from_double(winding.speed_rad_s / base.speed_rad_s)};

    return current_control_step(&control, &params, reference, current, speed, NUM(LIMIT));
}

static void run(double d, double q, int periods)
{
    for (int k = 0; k < periods; k++) {
        run_winding(step(d, q));
    }
}

static double length(struct dq v)
{
    const double d = num_to_double(v.d);
    const double q = num_to_double(v.q);

    return sqrt(d * d + q * q);
}

/* First order with 1500 rad/s: 63 % after 6.7 periods, 95 % after 20, 0.1 % left after 46. */
static void test_a_step_of_current_settles_with_the_bandwidth(void)
{
    run(0.0, 0.25, 7);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 1.0 - exp(-7.0 * BANDWIDTH * PERIOD_S), winding.q / 0.25);
    run(0.0, 0.25, 13);
    TEST_ASSERT_DOUBLE_WITHIN(0.015, 1.0 - exp(-20.0 * BANDWIDTH * PERIOD_S), winding.q / 0.25);
    run(0.0, 0.25, 40);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 1.0, winding.q / 0.25);
}

static void test_a_step_does_not_overshoot(void)
{
    for (int k = 0; k < 100; k++) {
        run(0.0, 0.25, 1);
        TEST_ASSERT_TRUE(winding.q < 0.25 * 1.01);
    }
}

/* Rotation couples the axes with N w L, at 45 rad/s five times the resistance. */
static void test_a_step_on_one_axis_leaves_the_other_alone(void)
{
    static const double speeds[] = {45.0, -45.0};

    for (unsigned i = 0; i < 2u; i++) {
        setUp();
        turn(speeds[i]);
        run(0.1, 0.0, 100);
        for (int k = 0; k < 50; k++) {
            run(0.1, 0.25, 1);
            TEST_ASSERT_DOUBLE_WITHIN(0.04 * 0.25, 0.1, winding.d);
        }
        for (int k = 0; k < 50; k++) {
            run(-0.1, 0.25, 1);
            TEST_ASSERT_DOUBLE_WITHIN(0.04 * 0.25, 0.25, winding.q);
        }
    }
}

/* The back-EMF is fed forward: no current flows while the integrator would learn it. */
static void test_at_speed_no_current_flows_unasked(void)
{
    turn(60.0);
    for (int k = 0; k < 30; k++) {
        run(0.0, 0.0, 1);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.0, winding.q);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.0, winding.d);
    }
}

/* A held rotor swings in a frame at rest: a q current along its speed would drive the swing. */
static void test_in_a_frame_at_rest_a_turning_rotor_makes_no_current(void)
{
    run(0.25, 0.0, 1500);
    winding.speed_rad_s = 10.0;
    for (int k = 0; k < 30; k++) {
        run(0.25, 0.0, 1);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.0, winding.q);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.25, winding.d);
    }
}

static void test_a_wrong_resistance_leaves_no_error_at_rest(void)
{
    winding.resistance_ohm = 1.5 * bench_params.resistance_ohm;
    run(0.25, -0.25, 1500);
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, 0.25, winding.d);
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, -0.25, winding.q);
}

static void test_the_voltage_vector_never_exceeds_its_limit(void)
{
    for (int i = -8; i <= 8; i++) {
        for (int j = -8; j <= 8; j++) {
            setUp();
            for (int k = 0; k < 5; k++) {
                TEST_ASSERT_TRUE(length(step(0.5 * i, 0.5 * j)) <= LIMIT * (1.0 + 1e-4));
            }
        }
    }
}

/* The first step from rest is Kp times the error. */
static const double proportional = 0.9e-3 * BANDWIDTH / 4.0; /* voltage over current base: 4 ohm */

static void test_within_the_limit_each_axis_gets_what_it_wants(void)
{
    const struct dq v = step(0.9, 2.0);

    TEST_ASSERT_NUM_WITHIN(1e-4, 0.9 * proportional, v.d);
    TEST_ASSERT_NUM_WITHIN(1e-4, 2.0 * proportional, v.q);
}

static void test_the_d_axis_is_served_first(void)
{
    const struct dq v = step(4.0, 2.0);

    TEST_ASSERT_NUM_WITHIN(1e-5, LIMIT, v.d);
    TEST_ASSERT_NUM_WITHIN(1e-5, 0.0, v.q);
}

static void test_q_gets_the_rest_of_the_circle(void)
{
    const struct dq v = step(1.5, 8.0);
    const double d = num_to_double(v.d);

    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1.5 * proportional, d);
    TEST_ASSERT_NUM_WITHIN(1e-4, sqrt(LIMIT * LIMIT - d * d), v.q);
}

/* The rotor too fast for the supply: the q current cannot be had. */
static void test_the_integrator_does_not_wind_up_over_a_thousand_saturated_periods(void)
{
    turn(200.0);
    run(0.0, 0.5, 1000);
    TEST_ASSERT_TRUE(winding.q < 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(2.0, 0.0, num_to_double(control.integral.q));
    turn(20.0);
    run(0.0, 0.25, 60);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.25, winding.q);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.0, winding.d);
}

static void test_a_reset_forgets_the_integral(void)
{
    run(0.25, 0.25, 100);
    current_control_reset(&control);
    TEST_ASSERT_NUM_WITHIN(0.0, 0.0, control.integral.d);
    TEST_ASSERT_NUM_WITHIN(0.0, 0.0, control.integral.q);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_step_of_current_settles_with_the_bandwidth);
    RUN_TEST(test_a_step_does_not_overshoot);
    RUN_TEST(test_a_step_on_one_axis_leaves_the_other_alone);
    RUN_TEST(test_at_speed_no_current_flows_unasked);
    RUN_TEST(test_in_a_frame_at_rest_a_turning_rotor_makes_no_current);
    RUN_TEST(test_a_wrong_resistance_leaves_no_error_at_rest);
    RUN_TEST(test_the_voltage_vector_never_exceeds_its_limit);
    RUN_TEST(test_within_the_limit_each_axis_gets_what_it_wants);
    RUN_TEST(test_the_d_axis_is_served_first);
    RUN_TEST(test_q_gets_the_rest_of_the_circle);
    RUN_TEST(test_the_integrator_does_not_wind_up_over_a_thousand_saturated_periods);
    RUN_TEST(test_a_reset_forgets_the_integral);
    return UNITY_END();
}
