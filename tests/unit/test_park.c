/* Phase and rotor frames: the conventions every other block relies on. */
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

#define QUARTER_TURN 0x40000000u

static const struct phases vector = {NUM(0.75), NUM(-0.5)};

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_a_magnet_on_phase_a_sees_its_current_as_d(void)
{
    const struct phases phase_a = {NUM(0.5), NUM(0.0)};
    const struct dq x = park(phase_a, sincos_of(0));

    TEST_ASSERT_NUM_WITHIN(NUM_ROUNDING, 0.5, x.d);
    TEST_ASSERT_NUM_WITHIN(NUM_ROUNDING, 0.0, x.q);
}

/* Torque is Km i_q = Km (-i_a sin + i_b cos). */
static void test_current_a_quarter_turn_ahead_of_the_magnet_makes_torque(void)
{
    const struct phases phase_b = {NUM(0.0), NUM(0.5)};
    const struct phases minus_phase_a = {NUM(-0.5), NUM(0.0)};

    TEST_ASSERT_NUM_WITHIN(NUM_ROUNDING, 0.5, park(phase_b, sincos_of(0)).q);
    TEST_ASSERT_NUM_WITHIN(NUM_ROUNDING, 0.5, park(minus_phase_a, sincos_of(QUARTER_TURN)).q);
}

static void test_the_frame_changes_no_energy(void)
{
    for (uint32_t i = 0; i < 1000u; i++) {
        const struct dq x = park(vector, sincos_of(i * 4294967u));
        const double d = num_to_double(x.d);
        const double q = num_to_double(x.q);

        TEST_ASSERT_DOUBLE_WITHIN(2.0 * (SINE_ERROR + NUM_ROUNDING), 0.75 * 0.75 + 0.5 * 0.5,
                                  d * d + q * q);
    }
}

static void test_there_and_back_is_where_it_was(void)
{
    for (uint32_t i = 0; i < 1000u; i++) {
        const struct sincos angle = sincos_of(i * 4294967u);
        const struct phases back = inverse_park(park(vector, angle), angle);

        TEST_ASSERT_NUM_WITHIN(2.0 * SINE_ERROR + 4.0 * NUM_ROUNDING, 0.75, back.a);
        TEST_ASSERT_NUM_WITHIN(2.0 * SINE_ERROR + 4.0 * NUM_ROUNDING, -0.5, back.b);
    }
}

/* An inverse transform is a transform by the opposite angle. */
static void test_turning_back_is_turning_by_the_opposite_angle(void)
{
    for (uint32_t i = 0; i < 100u; i++) {
        const angle_t angle = i * 42949672u;
        const struct dq x = {vector.a, vector.b};
        const struct phases inverse = inverse_park(x, sincos_of(angle));
        const struct dq opposite = park(vector, sincos_of(0u - angle));

        TEST_ASSERT_NUM_WITHIN(2.0 * SINE_ERROR + 4.0 * NUM_ROUNDING, num_to_double(opposite.d),
                               inverse.a);
        TEST_ASSERT_NUM_WITHIN(2.0 * SINE_ERROR + 4.0 * NUM_ROUNDING, num_to_double(opposite.q),
                               inverse.b);
    }
}

/* A vector that turns with the rotor stands still in its frame. */
static void test_a_turning_vector_stands_still_in_the_rotor_frame(void)
{
    for (uint32_t i = 0; i < 100u; i++) {
        const struct bench_vector turning = bench_to_phases(0.3, -0.6, (double)i * 0.01 * TWO_PI);
        const angle_t angle = (angle_t)((double)i * 0.01 * 4294967296.0);
        const struct dq x = park(bench_phases(turning.a, turning.b, 1.0), sincos_of(angle));

        TEST_ASSERT_NUM_WITHIN(2.0 * SINE_ERROR + 4.0 * NUM_ROUNDING, 0.3, x.d);
        TEST_ASSERT_NUM_WITHIN(2.0 * SINE_ERROR + 4.0 * NUM_ROUNDING, -0.6, x.q);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_magnet_on_phase_a_sees_its_current_as_d);
    RUN_TEST(test_current_a_quarter_turn_ahead_of_the_magnet_makes_torque);
    RUN_TEST(test_the_frame_changes_no_energy);
    RUN_TEST(test_there_and_back_is_where_it_was);
    RUN_TEST(test_turning_back_is_turning_by_the_opposite_angle);
    RUN_TEST(test_a_turning_vector_stands_still_in_the_rotor_frame);
    return UNITY_END();
}
