/* The d current in motion: all of it where the reference is slow, none where it is fast. */
#include "firmware/drive/motion_current.h"
#include "tests/unit/drive_bench.h"

static const num_t all = NUM(0.2);

void setUp(void)
{
    drive_bench_reset();
    bridge.background = true;
}

void tearDown(void)
{
}

static void test_there_is_all_of_it_up_to_an_eighth_of_the_speed_without_load(void)
{
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.2, motion_current_at(all, NUM(0.0)));
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.2, motion_current_at(all, NUM(0.12)));
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.2, motion_current_at(all, NUM(-0.12)));
}

static void test_there_is_none_from_a_quarter_on_and_half_half_way(void)
{
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.1, motion_current_at(all, NUM(0.1875)));
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.1, motion_current_at(all, NUM(-0.1875)));
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.0, motion_current_at(all, NUM(0.25)));
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.0, motion_current_at(all, NUM(3.0)));
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.0, motion_current_at(all, NUM(-3.0)));
}

/* In the middle of a move of 0.2 s, as a share of what is set. */
static double share_at(double speed_rad_s)
{
    setUp();
    settings.motion_current_A = 0.9;
    enable();
    move(speed_rad_s * 0.7 * 0.2, 0.2);
    run(1000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * speed_rad_s, speed_rad_s, signals().omega_ref_rad_s);
    return num_to_double(drive.current_reference.d) * drive.base.current_A / 0.9;
}

/* Without load it turns with 153 rad/s. */
static void test_a_move_has_it_by_its_speed(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1.0, share_at(15.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.43, share_at(30.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.0, share_at(45.0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_there_is_all_of_it_up_to_an_eighth_of_the_speed_without_load);
    RUN_TEST(test_there_is_none_from_a_quarter_on_and_half_half_way);
    RUN_TEST(test_a_move_has_it_by_its_speed);
    return UNITY_END();
}
