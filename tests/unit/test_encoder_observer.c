/* The model observer on an encoder, against the simulated bench motor. */
#include "firmware/estimator/encoder_observer.h"

#include <string.h>

#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

#define FINE      1073741824u /* counts per turn of an encoder without steps to speak of */
#define BANDWIDTH 1000.0

static struct per_unit base;
static struct motor_model_params model;
static struct encoder_observer_params params;
static struct encoder_observer observer;
static struct encoder_observer_task task;
static struct bench_motor motor;
static struct bench_vector mean_V;
static uint32_t counts_per_turn;
static bool holding;
static char error[DESIGN_ERROR_TEXT];

static int32_t count(void)
{
    return (int32_t)(int64_t)floor(motor.angle_rad / TWO_PI * (double)counts_per_turn);
}

static void design(uint32_t counts)
{
    counts_per_turn = counts;
    task.counts_per_turn = counts;
    TEST_ASSERT_TRUE_MESSAGE(encoder_observer_design(&params, &model, &task, error), error);
    encoder_observer_reset(&observer, &params,
                           position_from_rad(motor.angle_rad, bench_params.rotor_teeth), NUM(0.0),
                           model.nominal_resistance, count());
}

void setUp(void)
{
    base = per_unit_base(&bench_params, PERIOD_S);
    model = motor_model_design(&bench_params, &base, PERIOD_S, 0.0);
    task = (struct encoder_observer_task){
        .base = &base,
        .rotor_teeth = bench_params.rotor_teeth,
        .period_s = PERIOD_S,
        .bandwidth_rad_s = BANDWIDTH,
        .resistance_adaptation_s = 0.02,
        .hold_current_A = 1.5,
    };
    motor = (struct bench_motor){.motor = bench_params};
    holding = false;
}

void tearDown(void)
{
}

static void run_period(double i_d, double i_q)
{
    static const struct phases none = {NUM(0.0), NUM(0.0)};

    mean_V = bench_regulate(&motor, i_d, i_q);
    (void)encoder_observer_predict(&observer, &params,
                                   bench_phases(mean_V.a, mean_V.b, base.voltage_V));
    bench_run(&motor, mean_V.a, mean_V.b);
    (void)encoder_observer_step(&observer, &params,
                                bench_phases(motor.i_a, motor.i_b, base.current_A), none, none,
                                count(), holding);
}

static double angle_rad(void)
{
    return position_to_rad(observer.estimate.rotor.position, bench_params.rotor_teeth);
}

static double speed_rad_s(void)
{
    return num_to_double(observer.estimate.rotor.speed) * base.speed_rad_s;
}

static double load_Nm(void)
{
    return num_to_double(observer.estimate.rotor.load_torque) * base.torque_Nm;
}

static void test_speed_and_load_are_known_while_accelerating(void)
{
    design(FINE);
    motor.load_torque_Nm = 0.1;
    for (int k = 0; k < 600; k++) {
        run_period(0.0, bench_speed_current(&motor, 60.0));
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, motor.angle_rad, angle_rad());
    TEST_ASSERT_DOUBLE_WITHIN(0.02, motor.speed_rad_s, speed_rad_s());
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.1, load_Nm());
}

/*
 * The error after a load step dies out with the triple pole: its share 1 - e^-x (1 + x + x^2/2)
 * of the load is known after x = w_o t.
 */
static void test_a_load_step_is_learned_with_the_triple_pole(void)
{
    design(FINE);
    for (int k = 0; k < 200; k++) {
        run_period(0.0, bench_speed_current(&motor, 10.0));
    }
    motor.load_torque_Nm = 0.1;
    for (int k = 1; k <= 60; k++) {
        run_period(0.0, bench_speed_current(&motor, 10.0));
        const double x = BANDWIDTH * PERIOD_S * (double)k;

        TEST_ASSERT_DOUBLE_WITHIN(0.012, 0.1 * (1.0 - exp(-x) * (1.0 + x + 0.5 * x * x)),
                                  load_Nm());
    }
}

/* At rest between two edges nothing moves: the estimate stays within a count. */
static void test_a_coarse_encoder_is_known_to_a_count(void)
{
    const double lsb = TWO_PI / 4000.0;

    motor.angle_rad = 0.5 * lsb;
    design(4000);
    for (int k = 0; k < 3000; k++) {
        run_period(0.0, bench_speed_current(&motor, 5.0));
        TEST_ASSERT_DOUBLE_WITHIN(lsb, motor.angle_rad - 0.5 * lsb, angle_rad() - 0.5 * lsb);
    }
}

static void test_the_resistance_is_learned_in_the_hold_and_nowhere_else(void)
{
    motor.motor.resistance_ohm = 1.4 * 0.37;
    design(FINE);
    for (int k = 0; k < 300; k++) {
        run_period(1.5, 0.0);
    }
    TEST_ASSERT_DOUBLE_WITHIN(
        1e-6, 0.37, num_to_double(observer.estimate.winding.resistance) * base.resistance_ohm);
    holding = true;
    for (int k = 0; k < 1500; k++) {
        run_period(1.5, 0.0);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.005 * 0.37, 1.4 * 0.37,
                              num_to_double(observer.estimate.winding.resistance) *
                                  base.resistance_ohm);
}

static void test_the_load_that_is_preset_is_where_it_begins(void)
{
    design(FINE);
    encoder_observer_reset(&observer, &params, (struct position){0, 0},
                           num_from_double(0.1 / base.torque_Nm), model.nominal_resistance, 0);
    motor.load_torque_Nm = 0.1;
    for (int k = 0; k < 100; k++) {
        run_period(0.0, bench_speed_current(&motor, 0.0));
        TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.1, load_Nm());
    }
}

static void test_placing_moves_the_estimate_and_what_follows_from_it(void)
{
    design(16384);
    encoder_observer_place(&observer, position_from_rad(2.0, bench_params.rotor_teeth),
                           observer.encoder.count);
    for (int k = 0; k < 50; k++) {
        run_period(0.0, 0.0);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2.0, angle_rad());
}

static void test_a_rotor_that_is_placed_bears_what_its_current_holds(void)
{
    design(FINE);
    for (int k = 0; k < 200; k++) {
        run_period(1.0, 0.5);
    }
    const struct position quarter = {observer.estimate.rotor.position.turns,
                                     observer.estimate.rotor.position.fraction + (1u << 30)};

    encoder_observer_place(&observer, quarter, observer.encoder.count);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, -1.0, load_Nm() / bench_params.torque_constant_Nm_A);
}

static void test_what_the_encoder_or_the_period_cannot_bear_is_refused(void)
{
    task.counts_per_turn = 16384;
    task.bandwidth_rad_s = 6000.0;
    TEST_ASSERT_FALSE(encoder_observer_design(&params, &model, &task, error));
    TEST_ASSERT_EQUAL_STRING("observer_bandwidth_rad_s 6000 rad/s: must be at most 5000 rad/s, "
                             "0.5 per control period",
                             error);
    task.bandwidth_rad_s = 1000.0;
    task.counts_per_turn = 0;
    TEST_ASSERT_FALSE(encoder_observer_design(&params, &model, &task, error));
    TEST_ASSERT_EQUAL_STRING(
        "encoder counts per turn 0: must be at least 200, four per rotor tooth", error);
}

/* As far as one count shows as a speed behind the triple pole: 0.8 w_o of it. */
static void test_counts_that_feign_half_the_top_speed_are_refused(void)
{
    const double top_rad_s = bench_params.supply_V / bench_params.torque_constant_Nm_A;

    task.counts_per_turn = 400;
    for (double factor = 0.99; factor < 1.02; factor += 0.02) {
        struct per_unit slow = *task.base;

        task.bandwidth_rad_s = 2000.0;
        slow.speed_rad_s = 0.8 * 2000.0 * TWO_PI / 400.0 / 0.45 / factor;
        TEST_ASSERT_TRUE(slow.speed_rad_s < top_rad_s);
        task.base = &slow;
        TEST_ASSERT_EQUAL(factor < 1.0, encoder_observer_design(&params, &model, &task, error));
        task.base = &base;
    }
    TEST_ASSERT_NOT_NULL(strstr(error, "encoder_count_speed 25.13 rad/s: must be at most"));
    TEST_ASSERT_NOT_NULL(strstr(error, "more counts"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_speed_and_load_are_known_while_accelerating);
    RUN_TEST(test_a_load_step_is_learned_with_the_triple_pole);
    RUN_TEST(test_a_coarse_encoder_is_known_to_a_count);
    RUN_TEST(test_the_resistance_is_learned_in_the_hold_and_nowhere_else);
    RUN_TEST(test_the_load_that_is_preset_is_where_it_begins);
    RUN_TEST(test_placing_moves_the_estimate_and_what_follows_from_it);
    RUN_TEST(test_a_rotor_that_is_placed_bears_what_its_current_holds);
    RUN_TEST(test_counts_that_feign_half_the_top_speed_are_refused);
    RUN_TEST(test_what_the_encoder_or_the_period_cannot_bear_is_refused);
    return UNITY_END();
}
