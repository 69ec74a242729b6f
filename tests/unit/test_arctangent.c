/* The direction of a vector. */
#include <math.h>

#include "firmware/numeric/arctangent.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

void setUp(void)
{
}

void tearDown(void)
{
}

/* Difference in turns of what is found from the direction of the vector as it is represented. */
static double error_turns(double x, double y)
{
    const num_t a = num_from_double(x);
    const num_t b = num_from_double(y);
    const double found = (double)angle_of_vector(a, b) / 4294967296.0;

    return remainder(found - atan2(num_to_double(b), num_to_double(a)) / TWO_PI, 1.0);
}

static double worst_turns(double length)
{
    double worst = 0.0;

    for (int step = 0; step < 720; step++) {
        const double angle = TWO_PI * (step + 0.3) / 720.0;

        worst = fmax(worst, fabs(error_turns(length * cos(angle), length * sin(angle))));
    }
    return worst;
}

static void test_the_direction_is_found_all_around(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, worst_turns(1.0));
    TEST_ASSERT_DOUBLE_WITHIN(4e-6, 0.0, worst_turns(0.1));
    TEST_ASSERT_DOUBLE_WITHIN(4e-5, 0.0, worst_turns(0.01));
}

static void test_the_length_may_be_anything_below_its_bound(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, worst_turns(31.0));
}

static void test_the_axes_are_their_quarters(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, error_turns(0.5, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, error_turns(0.0, 0.5));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, error_turns(-0.5, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, error_turns(0.0, -0.5));
}

static void test_the_vector_of_no_length_has_direction_zero(void)
{
    TEST_ASSERT_EQUAL_HEX32(0u, angle_of_vector(NUM(0.0), NUM(0.0)));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_direction_is_found_all_around);
    RUN_TEST(test_the_length_may_be_anything_below_its_bound);
    RUN_TEST(test_the_axes_are_their_quarters);
    RUN_TEST(test_the_vector_of_no_length_has_direction_zero);
    return UNITY_END();
}
