/* Whether a rotor comes along that a hold leads. */
#include <math.h>

#include "firmware/drive/lead_watch.h"
#include "unity.h"

static struct lead_watch watch;

void setUp(void)
{
    lead_watch_reset(&watch);
}

void tearDown(void)
{
}

/* A third of a rad/s of a motor of 50 teeth, in blocks of 1.6 ms. */
#define BLOCKS_OF_TURN 231

/* What is seen of a back-EMF, in shares of it, and an offset along an axis at rest. */
struct seen {
    double share, offset;
};

/* So many blocks, in this direction: whether the rotor is left. */
static bool is_left(struct seen seen, double direction, int blocks)
{
    bool left = false;

    for (int n = 0; n < blocks && !left; n++) {
        const double led = direction / BLOCKS_OF_TURN;
        const double offset = seen.offset * cos(6.2831853 * n / BLOCKS_OF_TURN) / BLOCKS_OF_TURN;

        left = lead_watch_is_left(&watch, num_from_double(led),
                                  num_from_double(seen.share * led + offset));
    }
    return left;
}

static void test_a_rotor_that_does_not_come_along_is_left_behind_two_turns(void)
{
    static const double directions[] = {-1.0, 1.0};
    const struct seen stands = {.share = 0.2};
    const struct seen lags = {.share = 0.3};

    for (unsigned i = 0; i < sizeof directions / sizeof *directions; i++) {
        lead_watch_reset(&watch);
        TEST_ASSERT_FALSE(is_left(lags, directions[i], 10 * BLOCKS_OF_TURN));
        lead_watch_reset(&watch);
        TEST_ASSERT_FALSE(is_left(stands, directions[i], 2 * BLOCKS_OF_TURN - 3));
        TEST_ASSERT_TRUE(is_left(stands, directions[i], 6));
    }
    lead_watch_reset(&watch);
    TEST_ASSERT_TRUE(is_left((struct seen){.share = -1.0}, 1.0, 2 * BLOCKS_OF_TURN + 3));
}

/* Ten times the back-EMF: 0.5 V on the reference motor. */
static void
test_an_offset_is_taken_neither_for_a_rotor_that_comes_along_nor_for_one_that_stands(void)
{
    TEST_ASSERT_FALSE(
        is_left((struct seen){.share = 0.8, .offset = 10.0}, 1.0, 10 * BLOCKS_OF_TURN));
    lead_watch_reset(&watch);
    TEST_ASSERT_TRUE(is_left((struct seen){.offset = 10.0}, 1.0, 2 * BLOCKS_OF_TURN + 3));
}

static void test_turns_that_are_not_one_behind_the_other_leave_none(void)
{
    const struct seen stands = {.share = 0.0};
    const struct seen comes_along = {.share = 1.0};

    for (int n = 0; n < 6; n++) { /* to and fro */
        TEST_ASSERT_FALSE(is_left(stands, n % 2 == 0 ? 1.0 : -1.0, BLOCKS_OF_TURN - 3));
    }
    for (int n = 0; n < 4; n++) {
        TEST_ASSERT_FALSE(is_left(stands, 1.0, BLOCKS_OF_TURN + 3));
        lead_watch_reset(&watch);
    }
    for (int n = 0; n < 4; n++) {
        TEST_ASSERT_FALSE(is_left(stands, 1.0, BLOCKS_OF_TURN));
        TEST_ASSERT_FALSE(is_left(comes_along, 1.0, BLOCKS_OF_TURN));
    }
}

static void test_a_turn_begins_where_the_direction_changes(void)
{
    const struct seen stands = {.share = 0.0};

    for (int n = 0; n < 2; n++) {
        const double direction = n == 0 ? 1.0 : -1.0;

        lead_watch_reset(&watch);
        TEST_ASSERT_FALSE(is_left(stands, direction, BLOCKS_OF_TURN - 3));
        TEST_ASSERT_FALSE(is_left(stands, -direction, 2 * BLOCKS_OF_TURN - 3));
        TEST_ASSERT_TRUE(is_left(stands, -direction, 6));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_rotor_that_does_not_come_along_is_left_behind_two_turns);
    RUN_TEST(test_an_offset_is_taken_neither_for_a_rotor_that_comes_along_nor_for_one_that_stands);
    RUN_TEST(test_turns_that_are_not_one_behind_the_other_leave_none);
    RUN_TEST(test_a_turn_begins_where_the_direction_changes);
    return UNITY_END();
}
