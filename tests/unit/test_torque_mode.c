/* Torque is commanded of a drive with an encoder, and the load makes the position of it. */
#include <unity.h>

#include "firmware/drive/settings_in_motion.h"
#include "tests/unit/drive_bench.h"

enum { COUNTS = 16384 };

static void set_up(enum position_law law)
{
    drive_bench_reset();
    encoder_facts.encoder_counts_per_turn = COUNTS;
    board.facts = &encoder_facts;
    drive_settings_select_feedback(&settings, DRIVE_FEEDBACK_ENCODER);
    drive_settings_select_law(&settings, law);
    settings.encoder_zero_known = true;
    bridge.background = true;
    enable();
}

void setUp(void)
{
    set_up(POSITION_LAW_FEEDBACK_LINEARISATION);
}

void tearDown(void)
{
}

static struct drive_command torque(double torque_Nm, double speed_rad_s)
{
    return (struct drive_command){
        .kind = DRIVE_COMMAND_TORQUE, .torque_Nm = torque_Nm, .speed_rad_s = speed_rad_s};
}

static struct drive_command velocity(double speed_rad_s)
{
    return (struct drive_command){.kind = DRIVE_COMMAND_VELOCITY,
                                  .speed_rad_s = speed_rad_s,
                                  .acceleration_rad_s2 = 500.0,
                                  .jerk_rad_s3 = 5e4};
}

static double q_current_A(void)
{
    return bench_to_rotor(motor.i_a, motor.i_b, bench_electrical_rad(&motor)).b;
}

/* Greatest step of the reference's speed from period to period. */
static double run_and_see_jumps(int periods)
{
    double most = 0.0;

    for (int k = 0; k < periods; k++) {
        const double before = signals().omega_ref_rad_s;

        run(1);
        most = fmax(most, fabs(signals().omega_ref_rad_s - before));
    }
    return most;
}

static void test_a_torque_accelerates_the_inertia_under_every_law(void)
{
    static const enum position_law laws[] = {POSITION_LAW_FEEDBACK_LINEARISATION, POSITION_LAW_FOC,
                                             POSITION_LAW_STATE_FEEDBACK, POSITION_LAW_PID};

    for (size_t i = 0; i < sizeof laws / sizeof laws[0]; i++) {
        set_up(laws[i]);
        post(torque(-0.1, 0.0));
        run(20);
        const double before = motor.speed_rad_s;

        run(400);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(
            0.3, -0.04 * 0.1 / bench_params.inertia_kgm2,
            motor.speed_rad_s - before + 0.04 * 0.0003 * -13.0 / 15.62e-5, drive_law_name(laws[i]));
        TEST_ASSERT_DOUBLE_WITHIN(0.02, -0.1 / 0.157, q_current_A());
    }
}

static void test_a_speed_that_is_reached_stays_under_whatever_load(void)
{
    post(torque(0.3, 30.0));
    run(400);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 30.0, motor.speed_rad_s);
    motor.load_torque_Nm = 0.2;
    run(200);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 30.0, motor.speed_rad_s);
    motor.load_torque_Nm = -0.2; /* pulls */
    run(400);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 30.0, motor.speed_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, -0.19 / 0.157, q_current_A());
}

static void test_a_load_that_is_stronger_turns_the_rotor_back_up_to_the_speed(void)
{
    motor.load_torque_Nm = 0.2;
    run(300);
    post(torque(0.1, 20.0));
    run(800);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, -20.0, motor.speed_rad_s);
}

static void stand_still(struct bench_motor *m, double u_a, double u_b)
{
    const double angle = m->angle_rad;

    m->speed_rad_s = 0.0;
    bench_run(m, u_a, u_b);
    m->angle_rad = angle;
    m->speed_rad_s = 0.0;
}

static void test_a_rotor_that_is_held_is_no_fault(void)
{
    bridge.run_motor = stand_still;
    post(torque(0.47, 0.0));
    run(3000);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.47 / 0.157, q_current_A());
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, motor.angle_rad, signals().theta_ref_rad);
}

static void test_a_count_that_stands_still_of_a_rotor_that_turns_is_a_fault(void)
{
    post(torque(0.1, 50.0));
    run(300);
    encoder_facts.encoder_counts_per_turn = 1; /* of the bench's encoder */
    for (int k = 0; k < 3000 && drive.supervision.fault == DRIVE_FAULT_NONE; k++) {
        period();
    }
    TEST_ASSERT_EQUAL_STRING("encoder", drive_fault_name(drive.supervision.fault));
}

static void test_a_stop_begins_at_the_rotor_s_speed_and_ends_at_rest(void)
{
    post(torque(0.2, 40.0));
    run(600);
    post((struct drive_command){.kind = DRIVE_COMMAND_STOP});
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 0.0, run_and_see_jumps(600));
    TEST_ASSERT_FALSE(signals().reference_moving);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, signals().theta_ref_rad, motor.angle_rad);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 0.0, motor.speed_rad_s);
    move(signals().theta_ref_rad + 0.1, 0.05);
    run(800);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, signals().theta_ref_rad, motor.angle_rad);
}

static void test_a_speed_and_a_target_begin_with_the_rotor_s_motion(void)
{
    post(torque(0.2, 40.0));
    run(300);
    post(velocity(-10.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 0.0, run_and_see_jumps(1500));
    TEST_ASSERT_DOUBLE_WITHIN(0.2, -10.0, motor.speed_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -10.0, signals().omega_ref_rad_s);
    post(torque(0.1, 0.0));
    run(100);
    post((struct drive_command){.kind = DRIVE_COMMAND_RETARGET,
                                .position_rad = 1.0,
                                .speed_rad_s = 30.0,
                                .acceleration_rad_s2 = 800.0,
                                .jerk_rad_s3 = 5e4});
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 0.0, run_and_see_jumps(3000));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1.0, motor.angle_rad);
}

static void test_a_torque_acts_in_its_period_in_the_middle_of_a_move(void)
{
    struct drive_command later = torque(-0.15, 0.0);

    move(3.0, 0.2);
    later.at_period = drive.supervision.period + 500u;
    post(later);
    run(499);
    TEST_ASSERT_FALSE(drive.torque.speed != NUM(0.0));
    run(1);
    TEST_ASSERT_TRUE(drive.torque.speed != NUM(0.0));
    run(20);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, -0.15 / 0.157, q_current_A());
}

static void test_what_goes_on_when_a_torque_comes_is_void(void)
{
    post((struct drive_command){
        .kind = DRIVE_COMMAND_SINE, .amplitude_rad = 0.5, .frequency_Hz = 5.0, .ramp_s = 0.1});
    run(1500);
    post(torque(0.1, 20.0));
    run(1000);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 20.0, motor.speed_rad_s);
    TEST_ASSERT_EQUAL(PLANNER_IDLE, drive.planner.motion);
    TEST_ASSERT_EQUAL_UINT32(0, drive.planner.underruns);
}

static void test_a_drive_that_is_enabled_anew_controls_the_position(void)
{
    post(torque(0.1, 20.0));
    run(300);
    post((struct drive_command){.kind = DRIVE_COMMAND_DISABLE});
    run(2);
    motor.speed_rad_s = 0.0;
    post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE});
    run(2);
    TEST_ASSERT_TRUE(drive.torque.speed == NUM(0.0)); /* not when control begins */
    run(OFFSET_PERIODS + 1000);
    TEST_ASSERT_FALSE(signals().reference_moving);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, signals().theta_ref_rad, motor.angle_rad);
}

static void test_a_current_limit_that_falls_cuts_the_torque(void)
{
    struct drive_settings less = drive.settings;

    bridge.run_motor = stand_still;
    post(torque(0.4, 0.0));
    run(100);
    less.current_limit_A = 1.0;
    TEST_ASSERT_TRUE_MESSAGE(settings_in_motion_change(&drive, &less, error), error);
    run(100);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 1.0, q_current_A());
    less.current_limit_A = 3.0;
    TEST_ASSERT_TRUE_MESSAGE(settings_in_motion_change(&drive, &less, error), error);
    drive.thermal.motor_derated =
        32; /* half of all steps: to the rated current, which no hold takes */
    settings_in_motion_derate(&drive);
    run(10);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.4 / 0.157, signals().i_q_ref_A);
    drive.thermal.bridge_derated = 32;
    settings_in_motion_derate(&drive);
    run(10);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, drive.settings.current_limit_A, signals().i_q_ref_A);
    TEST_ASSERT_TRUE(drive.settings.current_limit_A < 2.0);
}

static void test_a_torque_under_a_load_begins_with_its_current(void)
{
    const int periods = 40;
    double sum = 0.0;

    motor.load_torque_Nm = 0.2;
    run(1000);
    post(torque(0.2, 0.0));
    run(5); /* what the law's noise had made of it */
    for (int k = 0; k < periods; k++) {
        run(1);
        sum += q_current_A();
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 0.2 / 0.157, sum / periods);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 0.0, motor.speed_rad_s);
    post((struct drive_command){.kind = DRIVE_COMMAND_STOP});
    run(300);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, signals().theta_ref_rad, motor.angle_rad);
}

static void refuses(struct drive_command command, const char *reason)
{
    TEST_ASSERT_FALSE(drive_command(&drive, &command, error));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, reason), error);
}

static void test_what_the_drive_cannot_is_refused(void)
{
    refuses(torque(0.48, 0.0), "current_limit_A");
    refuses(torque(-0.48, 0.0), "current_limit_A");
    refuses(torque(0.1, 1e4), "speed");
    refuses(torque(0.1, -10.0), "speed");
    post(torque(0.1, 0.0));
    run(50);
    refuses((struct drive_command){.kind = DRIVE_COMMAND_STEP, .position_rad = 1.0}, "move");
    post((struct drive_command){.kind = DRIVE_COMMAND_STOP});
    refuses(torque(0.1, 0.0), "stop");
}

static void test_without_an_encoder_it_is_refused(void)
{
    drive_bench_reset();
    enable();
    refuses(torque(0.1, 0.0), "without an encoder");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_torque_accelerates_the_inertia_under_every_law);
    RUN_TEST(test_a_speed_that_is_reached_stays_under_whatever_load);
    RUN_TEST(test_a_load_that_is_stronger_turns_the_rotor_back_up_to_the_speed);
    RUN_TEST(test_a_rotor_that_is_held_is_no_fault);
    RUN_TEST(test_a_count_that_stands_still_of_a_rotor_that_turns_is_a_fault);
    RUN_TEST(test_a_stop_begins_at_the_rotor_s_speed_and_ends_at_rest);
    RUN_TEST(test_a_speed_and_a_target_begin_with_the_rotor_s_motion);
    RUN_TEST(test_a_torque_acts_in_its_period_in_the_middle_of_a_move);
    RUN_TEST(test_what_goes_on_when_a_torque_comes_is_void);
    RUN_TEST(test_a_drive_that_is_enabled_anew_controls_the_position);
    RUN_TEST(test_a_current_limit_that_falls_cuts_the_torque);
    RUN_TEST(test_a_torque_under_a_load_begins_with_its_current);
    RUN_TEST(test_what_the_drive_cannot_is_refused);
    RUN_TEST(test_without_an_encoder_it_is_refused);
    return UNITY_END();
}
