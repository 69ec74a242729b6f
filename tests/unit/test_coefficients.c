/* An image for one motor: its coefficients have the shifts of the build, any other's their own. */
#include "firmware/drive/coefficients.h"

#include <string.h>

#include "tests/unit/drive_bench.h"
#include "tests/unit/num_assert.h"

#ifdef STEADYSTEP_COEFFICIENT_SHIFTS
#define ONE_MOTOR   true
#define SHIFT(name) COEF_SHIFT_##name
#else
#define ONE_MOTOR   false
#define SHIFT(name) 0
#endif

void setUp(void)
{
    drive_bench_reset();
    power_up();
}

void tearDown(void)
{
}

/* ---- what is shown ---- */

struct seen {
    int count;
    const char *wanted;
    int times; /* the wanted */
    double value;
};

static void see(void *context, const char *name, coef_t coefficient)
{
    struct seen *seen = context;

    seen->count++;
    if (strcmp(name, seen->wanted) == 0) {
        seen->times++;
        seen->value = coef_to_double(coefficient);
    }
}

static struct seen shown(const char *wanted)
{
    struct seen seen = {.wanted = wanted};

    coefficients_show(&drive, see, &seen);
    return seen;
}

static void test_each_is_shown_by_its_name(void)
{
    const struct drive_params *params = &drive.params;

    TEST_ASSERT_TRUE(shown("model_rate").value == coef_to_double(params->model.rate));
    TEST_ASSERT_TRUE(shown("current_reactance").value ==
                     coef_to_double(params->current_control.reactance));
    TEST_ASSERT_TRUE(shown("feedback_speed").value ==
                     coef_to_double(params->law.state_feedback.feedback.speed));
    TEST_ASSERT_TRUE(shown("hold_damping").value == coef_to_double(params->hold.damping));
    TEST_ASSERT_EQUAL_INT(1, shown("reference_jerk").times);
    TEST_ASSERT_EQUAL_INT(4, shown("ekf_angle_q").times); /* in motion, and three of the hold */
    TEST_ASSERT_TRUE(shown("ekf_load_settle").value ==    /* the last of them */
                     coef_to_double(params->estimator.invariant_ekf.following.load_settle));
    TEST_ASSERT_EQUAL_INT(0, shown("nothing").times);
}

static void test_a_law_that_is_not_linear_has_none(void)
{
    const int with = shown("").count;

    drive_bench_reset();
    drive_settings_select_law(&settings, POSITION_LAW_MICROSTEPPING);
    power_up();
    TEST_ASSERT_EQUAL_INT(0, shown("feedback_speed").times);
    TEST_ASSERT_EQUAL_INT(with - 4, shown("").count);
}

/* ---- shifts ---- */

#if STEADYSTEP_NUM == NUM_FIXED
static void has_shift(int shift, coef_t coefficient)
{
    if (ONE_MOTOR) {
        TEST_ASSERT_EQUAL_INT(shift, coefficient.left - coefficient.right);
    } else { /* as many bits as there are */
        TEST_ASSERT_TRUE(coefficient.mantissa >= 16384 || coefficient.mantissa <= -16384);
    }
}

static void test_the_shifts_are_those_of_the_image(void)
{
    const struct drive_params *params = &drive.params;

    has_shift(SHIFT(model_speed_per_torque), params->model.speed_per_torque);
    has_shift(SHIFT(ekf_speed_q), params->estimator.invariant_ekf.moving.speed_q);
    has_shift(SHIFT(ekf_speed_q), params->estimator.invariant_ekf.holding.speed_q);
    has_shift(SHIFT(reference_acceleration), params->reference.acceleration);
    has_shift(SHIFT(current_proportional), params->current_control.proportional);
    has_shift(SHIFT(modulator_counts), params->modulator.counts);
    has_shift(SHIFT(measured_current), params->measurement.current);
    has_shift(SHIFT(feedback_position), params->law.state_feedback.feedback.position);
}

static void test_what_is_learned_keeps_the_shifts(void)
{
    const coef_t gain = drive.params.estimator.invariant_ekf.moving.load_q;
    const coef_t more = coef_more(gain, NUM(0.65));

    TEST_ASSERT_DOUBLE_WITHIN(2.0 * COEF_ROUNDING * coef_to_double(more),
                              1.65 * coef_to_double(gain), coef_to_double(more));
    has_shift(SHIFT(ekf_load_q), more);
}
#endif

/* A product in the interrupt, to the bit. */
static void test_a_known_coefficient_is_the_coefficient(void)
{
    static const double factors[] = {0.0, 1e-7, -1e-7, 0.013, -0.37, 1.0, -1.0, 1.9};
    const struct motor_model_params *model = &drive.params.model;

    for (size_t i = 0; i < sizeof factors / sizeof factors[0]; i++) {
        const num_t a = num_from_double(factors[i]);
        const double expected = num_to_double(a) * coef_to_double(model->speed_per_torque);

        TEST_ASSERT_TRUE(num_mul_coef(a, model->speed_per_torque) ==
                         num_mul_coef(a, KNOWN(motor_model_params, model)->speed_per_torque));
        TEST_ASSERT_TRUE(
            num_mul_coef(a, drive.params.current_control.reactance) ==
            num_mul_coef(a,
                         KNOWN(current_control_params, &drive.params.current_control)->reactance));
        TEST_ASSERT_NUM_WITHIN(1.01 * NUM_ROUNDING, expected,
                               num_mul_coef(a, model->speed_per_torque));
    }
}

/* ---- another motor ---- */

static bool accepts(void)
{
    return drive_init(&drive, &fake_hal, &settings, error);
}

static void test_another_motor_is_refused_by_an_image_for_one(void)
{
    settings.motor.inertia_kgm2 /= 6.0;
    TEST_ASSERT_EQUAL_INT(!ONE_MOTOR, accepts());
    if (ONE_MOTOR) {
        TEST_ASSERT_EQUAL_STRING("model_speed_per_torque 0.02366: must be at most 0.01838, by the "
                                 "shifts of this image, which is for one motor",
                                 error);
    }
}

static void test_the_motor_with_its_tolerances_is_none_other(void)
{
    settings.motor.inertia_kgm2 *= 0.7;
    settings.motor.inductance_H *= 0.8;
    settings.motor.resistance_ohm *= 1.3;
    TEST_ASSERT_TRUE_MESSAGE(accepts(), error);
    settings.motor = bench_params;
    settings.motor.inertia_kgm2 *= 2.0;
    settings.motor.inductance_H *= 1.25;
    settings.motor.torque_constant_Nm_A *= 0.9;
    TEST_ASSERT_TRUE_MESSAGE(accepts(), error);
}

/* The gain of the position goes with the square of the bandwidth. */
static void test_a_law_that_is_too_quick_for_an_image_for_one_motor_is_refused(void)
{
    settings.current_bandwidth_rad_s = 3000.0;
    settings.law_bandwidth_rad_s = 300.0;
    TEST_ASSERT_TRUE_MESSAGE(accepts(), error);
    settings.law_bandwidth_rad_s = 700.0;
    TEST_ASSERT_EQUAL_INT_MESSAGE(!ONE_MOTOR, accepts(), error);
    if (ONE_MOTOR) {
        TEST_ASSERT_EQUAL_STRING("feedback_position 8 or more: must be at most 8, by the shifts of "
                                 "this image, which is for one motor",
                                 error);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_is_shown_by_its_name);
    RUN_TEST(test_a_law_that_is_not_linear_has_none);
#if STEADYSTEP_NUM == NUM_FIXED
    RUN_TEST(test_the_shifts_are_those_of_the_image);
    RUN_TEST(test_what_is_learned_keeps_the_shifts);
#endif
    RUN_TEST(test_a_known_coefficient_is_the_coefficient);
    RUN_TEST(test_another_motor_is_refused_by_an_image_for_one);
    RUN_TEST(test_the_motor_with_its_tolerances_is_none_other);
    RUN_TEST(test_a_law_that_is_too_quick_for_an_image_for_one_motor_is_refused);
    return UNITY_END();
}
