/* The internal model of a sinusoidal reference, as it is designed: its poles are where they were
   asked for. Nothing here depends on the number format. */
#include <complex.h>
#include <math.h>
#include <string.h>
#include <unity.h>

#include "firmware/design/servocompensator_design.h"

#define J ((double complex)I)

static struct servocompensator_task task;
static struct servocompensator_design design;
static char error[DESIGN_ERROR_TEXT];

void setUp(void)
{
    task = (struct servocompensator_task){
        .period_s = 1e-4, .frequency_rad_s = 30.0, .decay_1_s = 12.0, .harmonics = 2};
}

void tearDown(void)
{
}

/* x0 += r0 u, x_h = e^(j h w0 T) x_h + 2 r_h u; the answer x0 + sum Re x_h to u at z. */
static double complex answer_of_design(double complex z)
{
    double complex sum = design.input / (z - 1.0);

    for (int h = 1; h <= task.harmonics; h++) {
        const struct servocompensator_mode *mode = &design.mode[h - 1];
        const double complex input = mode->input_re + J * mode->input_im;
        const double complex pole = 1.0 - mode->one_minus_cosine + J * mode->sine;

        sum += 0.5 * (input / (z - pole) + conj(input) / (z - conj(pole)));
    }
    return sum;
}

/* p(z)/q(z) - 1, by the pattern of the paper. */
static double complex answer_asked_for(double complex z)
{
    static const double complex pattern[] = {-1.0, -2.0 + J, -2.0 - J, -3.0 + J, -3.0 - J};
    const double angle = task.frequency_rad_s * task.period_s;
    double complex quotient = 1.0 / (z - 1.0);

    for (int i = 0; i < 1 + 2 * task.harmonics; i++) {
        quotient *= z - cexp(task.decay_1_s * task.period_s * pattern[i]);
    }
    for (int h = 1; h <= task.harmonics; h++) {
        quotient /= (z - cexp(J * (h * angle))) * (z - cexp(-J * (h * angle)));
    }
    return quotient - 1.0;
}

static void test_its_poles_are_the_pattern_of_the_paper_at_any_period(void)
{
    static const double frequencies_rad_s[] = {0.5, 30.0, 600.0};
    static const double complex places[] = {1.01, 1.002 + 0.003 * J, 0.97 - 0.05 * J, -0.4,
                                            2.0 * J};

    for (int i = 0; i < 18; i++) {
        task.harmonics = 1 + i % 2;
        task.frequency_rad_s = frequencies_rad_s[i / 2 % 3];
        task.decay_1_s = task.frequency_rad_s;
        task.period_s = i / 6 == 0 ? 1e-4 : i / 6 == 1 ? 5e-5 : 2e-5;
        TEST_ASSERT_TRUE_MESSAGE(servocompensator_design(&task, &design, error), error);
        for (int k = 0; k < 5; k++) {
            const double complex asked = answer_asked_for(places[k]);

            TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0,
                                      cabs(answer_of_design(places[k]) - asked) / cabs(asked));
        }
    }
}

static void test_the_rotation_of_a_mode_is_that_of_its_harmonic(void)
{
    TEST_ASSERT_TRUE_MESSAGE(servocompensator_design(&task, &design, error), error);
    for (int h = 1; h <= 2; h++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, sin(h * 3e-3), design.mode[h - 1].sine);
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, 2.0 * sin(h * 1.5e-3) * sin(h * 1.5e-3),
                                  design.mode[h - 1].one_minus_cosine);
    }
}

static void is_refused(const char *reason)
{
    TEST_ASSERT_FALSE(servocompensator_design(&task, &design, error));
    TEST_ASSERT_EQUAL_STRING(reason, error);
}

static void test_what_no_period_can_bear_is_refused_with_its_limit(void)
{
    task.frequency_rad_s = 625.0; /* the second harmonic has fifty samples */
    TEST_ASSERT_TRUE_MESSAGE(servocompensator_design(&task, &design, error), error);
    task.frequency_rad_s = 625.1;
    is_refused(
        "servo_frequency_rad_s 625.1 rad/s: must be at most 625 rad/s, fifty samples a cycle");
    task.harmonics = 1;
    TEST_ASSERT_TRUE_MESSAGE(servocompensator_design(&task, &design, error), error);
    task.frequency_rad_s = 0.0;
    is_refused("servo_frequency_rad_s 0 rad/s: must be above 0 rad/s, and finite");
    task.frequency_rad_s = 30.0;
    task.decay_1_s = 1250.0;
    TEST_ASSERT_TRUE_MESSAGE(servocompensator_design(&task, &design, error), error);
    task.decay_1_s = 1251.0;
    is_refused("servo_decay_1_s 1251 1/s: must be at most 1250 1/s, an eighth per control period");
    task.decay_1_s = -1.0;
    is_refused("servo_decay_1_s -1 1/s: must be above 0 1/s, and finite");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_its_poles_are_the_pattern_of_the_paper_at_any_period);
    RUN_TEST(test_the_rotation_of_a_mode_is_that_of_its_harmonic);
    RUN_TEST(test_what_no_period_can_bear_is_refused_with_its_limit);
    return UNITY_END();
}
