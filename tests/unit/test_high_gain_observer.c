/* The high-gain observer: speed and acceleration from encoder counts alone. */
#include "firmware/estimator/high_gain_observer.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

#include <string.h>

#define COUNTS 1073741824.0
#define TEETH  50.0

static struct per_unit base;
static struct motor_model_params model;
static struct encoder_params encoder;
static struct high_gain_observer_task task;
static struct high_gain_observer_params params;
static struct high_gain_observer observer;
static char error[DESIGN_ERROR_TEXT];

static const struct phases no_current = {NUM(0.0), NUM(0.0)};

void setUp(void)
{
    base = per_unit_base(&bench_params, PERIOD_S);
    model = motor_model_design(&bench_params, &base, PERIOD_S, 0.0);
    encoder = encoder_design(50, (uint32_t)COUNTS);
    task = (struct high_gain_observer_task){
        .base = &base,
        .encoder = &encoder,
        .period_s = PERIOD_S,
        .epsilon_s = 5e-3,
        .speed_limit_rad_s = 200.0,
    };
}

void tearDown(void)
{
}

static void reset(double assumed_rad)
{
    TEST_ASSERT_TRUE_MESSAGE(high_gain_observer_design(&params, &model, &task, error), error);
    high_gain_observer_reset(&observer, &params, position_from_rad(assumed_rad, 50),
                             (struct position){0, 0}, model.nominal_resistance, 0);
}

static void step(double position_rad)
{
    const int32_t count = (int32_t)floor(position_rad / TWO_PI * COUNTS);

    (void)high_gain_observer_step(&observer, &params, no_current, no_current, count);
}

static double speed_rad_s(void)
{
    return num_to_double(observer.estimate.rotor.speed) * base.speed_rad_s;
}

/* Without current: what friction and the load leave. */
static double acceleration_rad_s2(void)
{
    const double torque_Nm = -num_to_double(observer.estimate.rotor.load_torque) * base.torque_Nm -
                             bench_params.viscous_friction_Nms_rad * speed_rad_s();

    return torque_Nm / bench_params.inertia_kgm2;
}

static void test_a_constant_acceleration_is_seen_with_its_speed(void)
{
    reset(0.0);
    for (int k = 1; k <= 1000; k++) {
        const double time_s = k * PERIOD_S;
        step(0.5 * 20.0 * time_s * time_s);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.1 + 10000.0 * COEF_ROUNDING, 20.0, acceleration_rad_s2());
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 20.0 * 1000.0 * PERIOD_S, speed_rad_s());
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.1, position_to_rad(observer.estimate.rotor.position, 50));
}

/* z2 and z3 from an error e at rest: partial fractions of (6) over the poles -2, -5, -10. */
static void test_an_initial_error_peaks_and_decays_as_equation_6(void)
{
    const double e_rad = 1e-3, eps = task.epsilon_s;

    reset(e_rad);
    for (int k = 1; k <= 200; k++) {
        step(0.0);
        const double t = k * PERIOD_S / eps;
        const double a = exp(-2.0 * t), b = exp(-5.0 * t), c = exp(-10.0 * t);
        /* s^2/((s+2)(s+5)(s+10)), times (s^2, s + 17 and s^2 + 17 s + 80 less s^2) for z1, z2, z3
         */
        const double z1 = 4.0 / 24.0 * a - 25.0 / 15.0 * b + 100.0 / 40.0 * c;
        const double z1_rate = -8.0 / 24.0 * a + 125.0 / 15.0 * b - 1000.0 / 40.0 * c;
        const double z1_rate2 = 16.0 / 24.0 * a - 625.0 / 15.0 * b + 10000.0 / 40.0 * c;
        const double z2 = z1_rate + 17.0 * z1;
        const double z3 = z1_rate2 + 17.0 * z1_rate + 80.0 * z1;

        TEST_ASSERT_DOUBLE_WITHIN(2e-4 * e_rad / eps * 10.0, e_rad / eps * z2, speed_rad_s());
        TEST_ASSERT_DOUBLE_WITHIN(2e-4 * e_rad / (eps * eps) * 40.0, e_rad / (eps * eps) * z3,
                                  acceleration_rad_s2());
    }
}

/* Euler's poles 1 - 10 T/eps would be at -9: here they are those of the differential equation. */
static void test_it_is_stable_with_an_epsilon_of_one_period(void)
{
#if STEADYSTEP_NUM != NUM_FIXED
    task.epsilon_s = PERIOD_S;
    reset(0.01);
    for (int k = 0; k < 20; k++) {
        step(0.0);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, speed_rad_s());
#else
    TEST_ASSERT_TRUE(true);
#endif
}

static void test_an_epsilon_beyond_what_can_be_computed_is_refused(void)
{
    task.epsilon_s = 1e-7;
    TEST_ASSERT_FALSE(high_gain_observer_design(&params, &model, &task, error));
    TEST_ASSERT_EQUAL_STRING(
        "high_gain_epsilon_s 1e-07 s: must be at least 1e-06 s, 0.01 control period", error);
}

/* A full step of error peaks beyond +-32 per-unit in fixed point. */
static void test_fixed_point_refuses_peaks_beyond_its_range(void)
{
    task.epsilon_s = 1e-4;
#if STEADYSTEP_NUM == NUM_FIXED
    TEST_ASSERT_FALSE(high_gain_observer_design(&params, &model, &task, error));
    TEST_ASSERT_NOT_NULL(strstr(error, "the range of fixed point"));
#else
    TEST_ASSERT_TRUE(high_gain_observer_design(&params, &model, &task, error));
#endif
}

/* An alignment says where the rotor is; the counts go on from there. */
static void test_it_goes_on_from_where_the_rotor_is_placed(void)
{
    const double from_rad = 0.02;
    const double count_rad = TWO_PI / COUNTS;

    reset(0.0);
    high_gain_observer_place(&observer, position_from_rad(from_rad, 50), 1000);
    for (int k = 1; k <= 50; k++) {
        (void)high_gain_observer_step(&observer, &params, no_current, no_current, 1000 + 100 * k);
    }
    TEST_ASSERT_DOUBLE_WITHIN(100.0 * count_rad, from_rad + 5000.0 * count_rad,
                              position_to_rad(observer.estimate.rotor.position, 50));
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, 100.0 * count_rad / PERIOD_S, speed_rad_s());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_constant_acceleration_is_seen_with_its_speed);
    RUN_TEST(test_an_initial_error_peaks_and_decays_as_equation_6);
    RUN_TEST(test_it_is_stable_with_an_epsilon_of_one_period);
    RUN_TEST(test_an_epsilon_beyond_what_can_be_computed_is_refused);
    RUN_TEST(test_fixed_point_refuses_peaks_beyond_its_range);
    RUN_TEST(test_it_goes_on_from_where_the_rotor_is_placed);
    return UNITY_END();
}
