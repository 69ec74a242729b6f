/* Learning of the detent torque, through an observer whose delay it has to know. */
#include "firmware/control/detent_compensation.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

#define OBSERVER   1400.0 /* rad/s, triple pole */
#define HOLDING_Nm (1.41421356 * 0.157 * 3.0)
#define ELECTRICAL 50.0

static struct per_unit base;
static struct detent_compensation_params params;
static struct detent_compensation detent;
static double load_Nm;
static double lag[3]; /* states of the observer's estimate, N m */
static double angle_rad;

/* True coefficients: 0.75 %, 1.5 % and 5 % of the holding torque. */
static const double truth[DETENT_COEFFICIENTS] = {0.003, 0.004, 0.006, -0.008, -0.02, 0.0265};
static const double unknown[DETENT_COEFFICIENTS];

void setUp(void)
{
    base = per_unit_base(&bench_params, PERIOD_S);
    params = detent_compensation_design(
        &(struct detent_compensation_task){.motor = &bench_params,
                                           .base = &base,
                                           .period_s = PERIOD_S,
                                           .counts_per_turn = 4000u,
                                           .observer_bandwidth_rad_s = OBSERVER});
    detent = (struct detent_compensation){0};
    load_Nm = 0.05;
    lag[0] = lag[1] = lag[2] = 0.0;
    angle_rad = 0.0;
}

void tearDown(void)
{
}

static double torque_of(const double c[DETENT_COEFFICIENTS], double electrical_rad)
{
    double torque = 0.0;

    for (int i = 0; i < DETENT_HARMONICS; i++) {
        const double x = (double)(1 << i) * electrical_rad;

        torque += c[2 * i] * cos(x) + c[2 * i + 1] * sin(x);
    }
    return torque;
}

static double played_Nm(void)
{
    return num_to_double(detent.torque) * base.torque_Nm;
}

static void step_at(int32_t angle)
{
    detent_compensation_step(&detent, &params, (angle_t)angle, sincos_of((angle_t)angle), NUM(0.0),
                             NUM(0.0), true);
}

/* Which way the angle goes makes no difference to what follows it. */
static void test_the_follower_keeps_its_play_on_either_side(void)
{
    for (int32_t side = -1; side <= 1; side += 2) {
        setUp();
        step_at(0);
        step_at(side * params.play);
        TEST_ASSERT_EQUAL_INT32(0, (int32_t)detent.follower);
        step_at(side * (params.play + 5000));
        TEST_ASSERT_EQUAL_INT32(side * 5000, (int32_t)detent.follower);
        step_at(side * (5000 - params.play + 7));
        TEST_ASSERT_EQUAL_INT32(side * 5000, (int32_t)detent.follower);
        step_at(side * (5000 - params.play - 9));
        TEST_ASSERT_EQUAL_INT32(side * (5000 - 9), (int32_t)detent.follower);
    }
}

/* One period at a speed: the observer sees what the compensation leaves, three lags late. */
static void run_period(double speed_rad_s)
{
    const double alpha = 1.0 - exp(-OBSERVER * PERIOD_S);
    double x = torque_of(truth, angle_rad) + load_Nm - played_Nm();

    for (int i = 0; i < 3; i++) {
        lag[i] += alpha * (x - lag[i]);
        x = lag[i];
    }
    angle_rad += ELECTRICAL * speed_rad_s * PERIOD_S;

    const double turns = angle_rad / TWO_PI;
    const angle_t angle = (angle_t)(int64_t)((turns - floor(turns)) * 4294967296.0);

    detent_compensation_step(&detent, &params, angle, sincos_of(angle),
                             num_from_double(speed_rad_s / base.speed_rad_s),
                             num_from_double(lag[2] / base.torque_Nm), true);
}

static void run(double speed_rad_s, double turns)
{
    const int periods = (int)(turns * TWO_PI / (ELECTRICAL * fabs(speed_rad_s) * PERIOD_S));

    for (int i = 0; i < periods; i++) {
        run_period(speed_rad_s);
    }
}

static double learned(int coefficient)
{
    double torque_Nm[DETENT_COEFFICIENTS];

    detent_compensation_get(&detent, &base, torque_Nm);
    return torque_Nm[coefficient];
}

static void test_all_harmonics_are_learned_at_creep_either_way_round(void)
{
    for (double speed = -0.5; speed < 1.0; speed += 1.0) {
        setUp();
        run(speed, 30.0);
        for (int i = 0; i < DETENT_COEFFICIENTS; i++) {
            TEST_ASSERT_DOUBLE_WITHIN(5e-4, truth[i], learned(i));
        }
    }
}

/* Four times the electrical speed is then seven tenths of the observer's bandwidth. */
static void test_the_delay_of_the_observer_is_known_to_the_learning(void)
{
    run(4.9, 400.0);
    for (int i = 0; i < DETENT_COEFFICIENTS; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, truth[i], learned(i));
    }
}

/* A position law with an encoder at rest: estimate and load go to and fro by a count. */
static void test_at_rest_nothing_is_learned_of_a_dither_between_counts(void)
{
    const double count_rad = ELECTRICAL * TWO_PI / 1000.0;

    params = detent_compensation_design(
        &(struct detent_compensation_task){.motor = &bench_params,
                                           .base = &base,
                                           .period_s = PERIOD_S,
                                           .counts_per_turn = 1000u,
                                           .observer_bandwidth_rad_s = OBSERVER});

    for (int i = 0; i < 100000; i++) {
        const double phase = TWO_PI * i / 50.0;
        const double turns = (1.0 + 0.9 * count_rad * sin(phase)) / TWO_PI;
        const angle_t angle = (angle_t)(int64_t)(turns * 4294967296.0);

        detent_compensation_step(&detent, &params, angle, sincos_of(angle),
                                 num_from_double(0.9 * count_rad * TWO_PI / 50.0 / PERIOD_S *
                                                 cos(phase) / ELECTRICAL / base.speed_rad_s),
                                 num_from_double((0.01 + 0.02 * sin(phase + 1.0)) / base.torque_Nm),
                                 true);
    }
    for (int i = 0; i < DETENT_COEFFICIENTS; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, learned(i));
    }
}

static void test_what_was_learned_slowly_stands_at_every_speed(void)
{
    detent_compensation_set(&detent, &params, &base, truth);
    for (double speed = 0.2; speed < 150.0; speed *= 1.5) {
        run(speed, 40.0);
        for (int i = 0; i < DETENT_COEFFICIENTS; i++) {
            TEST_ASSERT_DOUBLE_WITHIN(0.0035, truth[i], learned(i));
        }
    }
}

static void test_from_nothing_no_speed_makes_it_worse_than_the_detent(void)
{
    for (double speed = 0.2; speed < 150.0; speed *= 1.4) {
        setUp();
        run(speed, 200.0);
        for (int i = 0; i < DETENT_COEFFICIENTS; i++) {
            TEST_ASSERT_TRUE(fabs(learned(i) - truth[i]) <= 1.1 * fabs(truth[i]) + 1e-3);
        }
    }
}

static void test_at_rest_nothing_is_learned_from_a_load(void)
{
    detent_compensation_set(&detent, &params, &base, truth);
    load_Nm = 0.3;
    for (int i = 0; i < 20000; i++) {
        run_period(0.0);
    }
    for (int i = 0; i < DETENT_COEFFICIENTS; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, truth[i], learned(i));
    }
}

/* A quarter of the rated torque in mid-turn, by which the rotor stops soon: none of the detent's.
 */
static void test_a_load_step_in_motion_is_not_learned(void)
{
    detent_compensation_set(&detent, &params, &base, truth);
    run(2.0, 2.3);
    load_Nm += 0.25 * HOLDING_Nm;
    run(2.0, 0.6);
    for (int i = 0; i < DETENT_COEFFICIENTS; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(0.012 * HOLDING_Nm, truth[i], learned(i));
    }
}

static void test_the_torque_is_that_of_the_angle(void)
{
    detent_compensation_set(&detent, &params, &base, truth);
    load_Nm = 0.0;
    for (int i = 0; i < 400; i++) {
        run_period(0.5);
        TEST_ASSERT_DOUBLE_WITHIN(3e-4, torque_of(truth, angle_rad), played_Nm());
    }
}

static void test_at_speed_it_is_left_to_the_inertia(void)
{
    detent_compensation_set(&detent, &params, &base, truth);
    run_period(130.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, played_Nm());
}

static void test_no_coefficient_passes_its_bound(void)
{
    static const double absurd[DETENT_COEFFICIENTS] = {1.0, -1.0, 1.0, -1.0, 1.0, -1.0};

    detent_compensation_set(&detent, &params, &base, absurd);
    for (int i = 0; i < DETENT_COEFFICIENTS; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, (i % 2 == 0 ? 0.15 : -0.15) * HOLDING_Nm, learned(i));
    }
    detent_compensation_set(&detent, &params, &base, unknown);
    for (int i = 0; i < 40000; i++) { /* a load that swings with the rotor at 30 % of holding */
        load_Nm = 0.3 * HOLDING_Nm * cos(angle_rad);
        run_period(0.5);
    }
    TEST_ASSERT_TRUE(fabs(learned(0)) < 0.151 * HOLDING_Nm);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_follower_keeps_its_play_on_either_side);
    RUN_TEST(test_all_harmonics_are_learned_at_creep_either_way_round);
    RUN_TEST(test_the_delay_of_the_observer_is_known_to_the_learning);
    RUN_TEST(test_at_rest_nothing_is_learned_of_a_dither_between_counts);
    RUN_TEST(test_what_was_learned_slowly_stands_at_every_speed);
    RUN_TEST(test_from_nothing_no_speed_makes_it_worse_than_the_detent);
    RUN_TEST(test_at_rest_nothing_is_learned_from_a_load);
    RUN_TEST(test_a_load_step_in_motion_is_not_learned);
    RUN_TEST(test_the_torque_is_that_of_the_angle);
    RUN_TEST(test_at_speed_it_is_left_to_the_inertia);
    RUN_TEST(test_no_coefficient_passes_its_bound);
    return UNITY_END();
}
