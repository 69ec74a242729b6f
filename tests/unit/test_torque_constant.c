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

/* In a move of 0.4 s. */
static double learned_on_a_way(double truth, double rad)
{
    setUp();
    motor.motor.torque_constant_Nm_A *= truth;
    enable();
    run(500);
    move(rad, 0.4);
    run(4500);
    return num_to_double(drive.torque_constant.change);
}

static double learned(double truth)
{
    return learned_on_a_way(truth, 12.0);
}

static void test_a_magnet_ten_per_cent_off_is_learned_in_a_move_and_put_in_force(void)
{
    const double base = per_unit_base(&settings.motor, PERIOD_S).speed_rad_s;

    TEST_ASSERT_DOUBLE_WITHIN(0.025, -0.1, learned(0.9));
    TEST_ASSERT_DOUBLE_WITHIN(0.035 * base, base / 0.9, drive.base.speed_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.025, 0.1, learned(1.1));
    TEST_ASSERT_DOUBLE_WITHIN(0.035 * base, base / 1.1, drive.base.speed_rad_s);
}

/* Many a motor never has an eighth of the supply as back-EMF: here it is a fifteenth. */
static void test_it_is_learned_from_a_motion_as_slow_as_this(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(0.025, -0.1, learned_on_a_way(0.9, 3.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.025, 0.1, learned_on_a_way(1.1, 3.0));
}

static void test_one_as_the_settings_say_changes_nothing(void)
{
    const double base = per_unit_base(&settings.motor, PERIOD_S).speed_rad_s;

    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.0, learned(1.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.0, base, drive.base.speed_rad_s);
}

/* What the interrupt has by the torque constant, seen as often as interrupts are held back. */
static struct {
    struct drive_params before, after;
    int begun, ended;
} deferral;

static void look(void *context, bool defers)
{
    (void)context;
    if (defers) {
        deferral.before = drive.params;
        deferral.begun++;
    } else {
        deferral.after = drive.params;
        deferral.ended++;
    }
}

/* Of those that go by it, without padding. */
static bool same(const struct drive_params *a, const struct drive_params *b)
{
    return memcmp(&a->model, &b->model, sizeof a->model) == 0 &&
           memcmp(&a->estimator.invariant_ekf.model, &b->estimator.invariant_ekf.model,
                  sizeof a->model) == 0 &&
           memcmp(&a->current_control, &b->current_control, sizeof a->current_control) == 0 &&
           memcmp(&a->reference, &b->reference, sizeof a->reference) == 0;
}

/* No interrupt finds a part of it. */
static void test_it_is_put_in_force_while_interrupts_are_held_back(void)
{
    memset(&deferral, 0, sizeof deferral);
    board.defer_interrupts = look;
    power_up();
    const struct drive_params designed = drive.params;

    torque_constant_put(&drive, NUM(0.02)); /* too little to matter */
    TEST_ASSERT_EQUAL_INT(0, deferral.begun);
    TEST_ASSERT_TRUE(same(&designed, &drive.params));
    torque_constant_put(&drive, NUM(-0.1));
    TEST_ASSERT_EQUAL_INT(1, deferral.begun);
    TEST_ASSERT_EQUAL_INT(1, deferral.ended);
    TEST_ASSERT_TRUE(same(&designed, &deferral.before));
    TEST_ASSERT_FALSE(same(&designed, &deferral.after));
    TEST_ASSERT_TRUE(same(&deferral.after, &drive.params));
}

/* Of one that was learned in motion nothing else is in force. */
static void test_a_drive_that_begins_with_it_is_as_one_that_has_learned_it(void)
{
    power_up();
    torque_constant_put(&drive, NUM(-0.1));

    const struct drive_params learned_ones = drive.params;
    const double base = drive.base.speed_rad_s;

    settings.initial_torque_constant_change = -0.1;
    power_up();
    TEST_ASSERT_TRUE(same(&learned_ones, &drive.params));
    TEST_ASSERT_DOUBLE_WITHIN(0.0, base, drive.base.speed_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, -0.1, num_to_double(drive.torque_constant.change));
    torque_constant_put(&drive, NUM(0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, per_unit_base(&settings.motor, PERIOD_S).speed_rad_s,
                              drive.base.speed_rad_s);
}

#ifndef STEADYSTEP_COEFFICIENT_SHIFTS /* its shifts are another motor's */
/* 0.15: the interrupt multiplies by a large gain, which is never shifted to the right. */
static void test_a_reactance_below_a_quarter_is_a_large_gain_as_before(void)
{
    struct motor_params motor;

    settings.motor.inductance_H *= 0.08;
    power_up();
    torque_constant_put(&drive, NUM(-0.1));
    motor = settings.motor;
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 0.15, per_unit_reactance(&drive.base, &motor));
    TEST_ASSERT_EQUAL_HEX32(
        coef_bits(coef_large_from_double(per_unit_reactance(&drive.base, &motor))),
        coef_bits(drive.params.current_control.reactance));
}
#endif

/* Of a rotor whose speed is imposed on the estimate. */
static void test_it_looks_for_13_ms_whatever_the_period(void)
{
    static const double period_s[] = {50e-6, 100e-6, 200e-6};

    for (int i = 0; i < 3; i++) {
        uint32_t periods = 0u;

#ifdef STEADYSTEP_COEFFICIENT_SHIFTS
        if (i != 1) { /* an image for one motor is for one period, too */
            continue;
        }
#endif

        drive_bench_reset();
        encoder_facts.control_period_s = period_s[i];
        board.facts = &encoder_facts;
        power_up();
        drive.supervision.state = DRIVE_OPERATION_ENABLED;
        drive.supervision.period = 1u;
        torque_constant_background(&drive);
        drive.estimator.estimate.rotor.speed = NUM(0.25);
        const uint32_t begun = drive.torque_constant.begun;

        while (drive.torque_constant.begun == begun && periods < 1000u) {
            drive.supervision.period++;
            drive.estimator.estimate.rotor.position =
                position_add(drive.estimator.estimate.rotor.position, 1 << 20);
            torque_constant_background(&drive);
            periods++;
        }
        TEST_ASSERT_EQUAL_UINT(256u >> i, periods);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_magnet_ten_per_cent_off_is_learned_in_a_move_and_put_in_force);
    RUN_TEST(test_it_is_learned_from_a_motion_as_slow_as_this);
    RUN_TEST(test_one_as_the_settings_say_changes_nothing);
    RUN_TEST(test_it_is_put_in_force_while_interrupts_are_held_back);
    RUN_TEST(test_a_drive_that_begins_with_it_is_as_one_that_has_learned_it);
#ifndef STEADYSTEP_COEFFICIENT_SHIFTS
    RUN_TEST(test_a_reactance_below_a_quarter_is_a_large_gain_as_before);
#endif
    RUN_TEST(test_it_looks_for_13_ms_whatever_the_period);
    return UNITY_END();
}
