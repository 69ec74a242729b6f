/* The torque constant that motion shows: the ratio of the speed of the back-EMF to that of the
 * angle. */
#include "tests/unit/drive_bench.h"

void setUp(void)
{
    drive_bench_reset();
    bridge.background = true;
}

void tearDown(void)
{
}

static double learned(double truth)
{
    setUp();
    motor.motor.torque_constant_Nm_A *= truth;
    enable();
    run(500);
    move(12.0, 0.4);
    run(4500);
    return num_to_double(drive.torque_constant.change);
}

static void test_a_magnet_ten_per_cent_off_is_learned_in_a_move_and_put_in_force(void)
{
    const double base = per_unit_base(&settings.motor, PERIOD_S).speed_rad_s;

    TEST_ASSERT_DOUBLE_WITHIN(0.025, -0.1, learned(0.9));
    TEST_ASSERT_DOUBLE_WITHIN(0.035 * base, base / 0.9, drive.base.speed_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.025, 0.1, learned(1.1));
    TEST_ASSERT_DOUBLE_WITHIN(0.035 * base, base / 1.1, drive.base.speed_rad_s);
}

static void test_one_as_the_settings_say_changes_nothing(void)
{
    const double base = per_unit_base(&settings.motor, PERIOD_S).speed_rad_s;

    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.0, learned(1.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.0, base, drive.base.speed_rad_s);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_magnet_ten_per_cent_off_is_learned_in_a_move_and_put_in_force);
    RUN_TEST(test_one_as_the_settings_say_changes_nothing);
    return UNITY_END();
}
