/* Quadrature counts to an electrical position. */
#include "firmware/motor/encoder.h"
#include "tests/unit/num_assert.h"

#define TEETH 50

void setUp(void)
{
}

void tearDown(void)
{
}

static double turns(struct position p)
{
    return (double)p.turns + (double)p.fraction / 4294967296.0;
}

/* Electrical turns of so many counts. */
static double turns_of(double counts, double counts_per_turn)
{
    return TEETH * counts / counts_per_turn;
}

static void test_counts_add_up_without_rounding_over_a_million_turns(void)
{
    static const uint32_t resolutions[] = {4000, 16384, 32000, 65536, 7777};

    for (unsigned i = 0; i < sizeof resolutions / sizeof resolutions[0]; i++) {
        const struct encoder_params params = encoder_design(TEETH, resolutions[i]);
        const struct position start = {.turns = 0, .fraction = 0};
        const int32_t step = (int32_t)resolutions[i] / 201;
        const int64_t steps = 201000000LL / 1000;
        struct encoder encoder;
        struct position position = start;
        int32_t count = 0;

        encoder_set(&encoder, start, count);
        for (int64_t k = 0; k < steps; k++) {
            count = (int32_t)((uint32_t)count + (uint32_t)step);
            position = encoder_step(&encoder, &params, count);
        }
        TEST_ASSERT_DOUBLE_WITHIN(
            1e-9, turns_of((double)steps * (double)step, (double)resolutions[i]), turns(position));
    }
}

static void test_there_and_back_is_where_it_was(void)
{
    const struct encoder_params params = encoder_design(TEETH, 32000);
    const struct position start = {.turns = -3, .fraction = 123456789u};
    struct encoder encoder;
    struct position position;

    encoder_set(&encoder, start, -5);
    position = encoder_step(&encoder, &params, 200);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, turns(start) + turns_of(205, 32000), turns(position));
    position = encoder_step(&encoder, &params, -100);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, turns(start) - turns_of(95, 32000), turns(position));
    position = encoder_step(&encoder, &params, -5);
    TEST_ASSERT_EQUAL_INT32(start.turns, position.turns);
    TEST_ASSERT_EQUAL_UINT32(start.fraction, position.fraction);
}

static void test_any_number_of_counts_is_converted_exactly(void)
{
    static const int32_t counts[] = {1, -1, 65535, -65536, 65537, INT32_MAX, INT32_MIN, -123456789};
    const struct encoder_params params[] = {{0xfedcba9876543210u}, {0xffffffffffffffffu}, {1u}};

    for (unsigned i = 0; i < sizeof params / sizeof params[0]; i++) {
        for (unsigned k = 0; k < sizeof counts / sizeof counts[0]; k++) {
            TEST_ASSERT_EQUAL_HEX64((uint64_t)(int64_t)counts[k] * params[i].angle_per_count,
                                    encoder_travel(&params[i], counts[k]));
        }
    }
}

static void test_a_counter_that_wraps_goes_on(void)
{
    const struct encoder_params params = encoder_design(TEETH, 16384);
    const struct position start = {.turns = 0, .fraction = 0};
    struct encoder encoder;

    encoder_set(&encoder, start, INT32_MAX);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, turns_of(11, 16384),
                              turns(encoder_step(&encoder, &params, INT32_MIN + 10)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, turns(encoder_step(&encoder, &params, INT32_MAX)));
}

/* A count is rounded down, so the rotor is on average half a count further. */
static void test_a_count_with_a_known_zero_means_its_middle(void)
{
    static const int32_t counts[] = {0, 1, -1, 16383, -16385, 2000000000, -2000000000};
    const struct encoder_params params = encoder_design(TEETH, 16384);
    const struct position zero = {.turns = 7, .fraction = 3u << 30};

    for (unsigned i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-8, 7.75 + turns_of(counts[i] + 0.5, 16384),
                                  turns(encoder_position(&params, zero, counts[i])));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_counts_add_up_without_rounding_over_a_million_turns);
    RUN_TEST(test_there_and_back_is_where_it_was);
    RUN_TEST(test_any_number_of_counts_is_converted_exactly);
    RUN_TEST(test_a_counter_that_wraps_goes_on);
    RUN_TEST(test_a_count_with_a_known_zero_means_its_middle);
    return UNITY_END();
}
