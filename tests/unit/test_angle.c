/* Positions: whole electrical turns and a fraction, without loss after a million turns. */
#include <unity.h>

#include "firmware/numeric/angle.h"

static const double two_pi = 6.283185307179586476925;

void setUp(void)
{
}

void tearDown(void)
{
}

static void is_at(int32_t turns, angle_t fraction, struct position p)
{
    TEST_ASSERT_EQUAL_INT32(turns, p.turns);
    TEST_ASSERT_EQUAL_HEX32(fraction, p.fraction);
}

/* Weight of the last bit position_difference shows of a difference, turns. */
static double resolution(double difference)
{
#if STEADYSTEP_NUM == NUM_FIXED
    (void)difference;
    return 1.0 / 67108864.0;
#elif STEADYSTEP_NUM == NUM_FLOAT
    return 1.0 / 134217728.0 + (difference < 0.0 ? -difference : difference) / 8388608.0;
#else
    (void)difference;
    return 1.0 / 4294967296.0;
#endif
}

static void test_a_position_carries_into_the_next_turn_and_back(void)
{
    const struct position end_of_turn = {7, 0xffffffffu};
    const struct position begin_of_turn = {8, 0};

    is_at(8, 0, position_add(end_of_turn, 1));
    is_at(7, 0xffffffffu, position_add(begin_of_turn, -1));
    is_at(8, 0x7ffffffeu, position_add(end_of_turn, INT32_MAX));
    is_at(7, 0x80000000u, position_add(begin_of_turn, INT32_MIN));
    is_at(7, 0xffffffffu, position_add(end_of_turn, 0));
    is_at(8, 0, position_add(begin_of_turn, 0));
    is_at(-1, 0xffffffffu, position_add((struct position){0, 0}, -1));
    is_at(0, 0, position_add((struct position){-1, 0xffffffffu}, 1));
}

static void test_a_million_turns_there_and_back_lose_nothing(void)
{
    const int32_t step = 1999999973; /* just under half a turn, prime */
    const int32_t steps = 2200000;
    struct position p = {0, 12345};
    int64_t travelled;

    for (int32_t i = 0; i < steps; i++) {
        p = position_add(p, step);
    }
    travelled = p.turns * ((int64_t)1 << 32) + p.fraction;
    TEST_ASSERT_EQUAL_INT64(12345 + (int64_t)step * steps, travelled);
    TEST_ASSERT_TRUE(p.turns > 1000000);
    for (int32_t i = 0; i < steps; i++) {
        p = position_add(p, -step);
    }
    is_at(0, 12345, p);
}

static void test_a_difference_is_as_fine_far_out_as_at_zero(void)
{
    static const int32_t turns[] = {0, -1, 1000000, -1000000, INT32_MAX - 20, INT32_MIN + 20};
    static const struct {
        int32_t turns;
        angle_t fraction;
        double difference;
    } ahead[] = {
        {0, 64, 64.0 / 4294967296.0}, {0, 0x40000000u, 0.25},
        {3, 0x80000000u, 3.5},        {-1, 0xffffffc0u, -64.0 / 4294967296.0},
        {-4, 0x80000000u, -3.5},      {14, 0xffffffc0u, 15.0 - 64.0 / 4294967296.0},
    };

    for (unsigned i = 0; i < sizeof turns / sizeof turns[0]; i++) {
        for (unsigned j = 0; j < sizeof ahead / sizeof ahead[0]; j++) {
            struct position from = {turns[i], 0x9e3779c0u};
            struct position to = {turns[i] + ahead[j].turns, from.fraction + ahead[j].fraction};
            to.turns += to.fraction < from.fraction ? 1 : 0;

            TEST_ASSERT_DOUBLE_WITHIN(resolution(ahead[j].difference), ahead[j].difference,
                                      num_to_double(position_difference(to, from)));
            TEST_ASSERT_DOUBLE_WITHIN(resolution(ahead[j].difference), -ahead[j].difference,
                                      num_to_double(position_difference(from, to)));
        }
    }
}

static void test_a_large_difference_saturates_with_its_sign(void)
{
    static const int32_t far[] = {15, 16, 17, 100, 1000000, 2000000000};
    const struct position origin = {0, 0x80000000u};

    for (unsigned i = 0; i < sizeof far / sizeof far[0]; i++) {
        struct position there = {far[i], 0x80000001u};

        TEST_ASSERT_DOUBLE_WITHIN(1e-6, POSITION_DIFFERENCE_MAX,
                                  num_to_double(position_difference(there, origin)));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, -POSITION_DIFFERENCE_MAX,
                                  num_to_double(position_difference(origin, there)));
    }
}

static void test_an_angle_and_its_turns_are_one(void)
{
    static const double turns[] = {0.0, 0.25, -0.25, 0.123456, -0.49, 0.49, 1e-6, -1e-6};

    for (unsigned i = 0; i < sizeof turns / sizeof turns[0]; i++) {
        int32_t angle = angle_from_turns(num_from_double(turns[i]));

        TEST_ASSERT_DOUBLE_WITHIN(6e-8, turns[i], (double)angle / 4294967296.0);
        TEST_ASSERT_EQUAL_INT32(angle, angle_from_any_turns(num_from_double(turns[i])));
        TEST_ASSERT_DOUBLE_WITHIN(6e-8, turns[i], num_to_double(turns_from_angle(angle)));
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, -0.5, num_to_double(turns_from_angle(INT32_MIN)));
}

static void test_an_angle_of_any_number_never_wraps_to_the_other_side(void)
{
    static const double beyond[] = {0.4991, 0.5, 0.75, 1.0, 5.0, 30.0};

    for (unsigned i = 0; i < sizeof beyond / sizeof beyond[0]; i++) {
        TEST_ASSERT_TRUE(angle_from_any_turns(num_from_double(beyond[i])) > 0x7f000000);
        TEST_ASSERT_TRUE(angle_from_any_turns(num_from_double(-beyond[i])) < -0x7f000000);
    }
#if STEADYSTEP_NUM != NUM_FIXED
    TEST_ASSERT_EQUAL_INT32(0, angle_from_any_turns((num_t)__builtin_nan("")));
    TEST_ASSERT_TRUE(angle_from_any_turns((num_t)__builtin_inf()) > 0x7f000000);
    TEST_ASSERT_TRUE(angle_from_any_turns(-(num_t)__builtin_inf()) < -0x7f000000);
#endif
}

static void test_radians_become_electrical_turns(void)
{
    is_at(0, 0, position_from_rad(0.0, 50));
    is_at(50, 0, position_from_rad(two_pi, 50));
    is_at(-1, 0x80000000u, position_from_rad(-two_pi / 100.0, 50));
    is_at(0, 0x40000000u, position_from_rad(two_pi / 200.0, 50));
    is_at(1000000, 0, position_from_rad(two_pi * 20000.0, 50));
    /* Less than half of 2^-32 turn below a whole turn is that turn. */
    is_at(0, 0, position_from_rad(-1e-13, 50));
}

static void test_radians_survive_the_way_there_and_back(void)
{
    for (double rad = 1e-4; rad < 1e5; rad *= 1.37) {
        TEST_ASSERT_DOUBLE_WITHIN(2e-11 + 4e-16 * rad, rad,
                                  position_to_rad(position_from_rad(rad, 50), 50));
        TEST_ASSERT_DOUBLE_WITHIN(2e-11 + 4e-16 * rad, -rad,
                                  position_to_rad(position_from_rad(-rad, 50), 50));
    }
}

static void test_radians_beyond_the_range_saturate(void)
{
    static const double beyond[] = {1e12, 1e300, __builtin_inf()};

    for (unsigned i = 0; i < sizeof beyond / sizeof beyond[0]; i++) {
        TEST_ASSERT_TRUE(position_from_rad(beyond[i], 50).turns > 2147483000);
        TEST_ASSERT_TRUE(position_from_rad(-beyond[i], 50).turns < -2147483000);
    }
    TEST_ASSERT_TRUE(position_from_rad(__builtin_nan(""), 50).turns < -2147483000);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_position_carries_into_the_next_turn_and_back);
    RUN_TEST(test_a_million_turns_there_and_back_lose_nothing);
    RUN_TEST(test_a_difference_is_as_fine_far_out_as_at_zero);
    RUN_TEST(test_a_large_difference_saturates_with_its_sign);
    RUN_TEST(test_an_angle_and_its_turns_are_one);
    RUN_TEST(test_an_angle_of_any_number_never_wraps_to_the_other_side);
    RUN_TEST(test_radians_become_electrical_turns);
    RUN_TEST(test_radians_survive_the_way_there_and_back);
    RUN_TEST(test_radians_beyond_the_range_saturate);
    return UNITY_END();
}
