/* The whole drive on the simulated motor. */
#include "tests/unit/drive_bench.h"

void setUp(void)
{
    drive_bench_reset();
}

void tearDown(void)
{
}

/* ---- start-up ---- */

static void test_bandwidths_too_fast_are_refused_with_their_limit(void)
{
    settings.current_bandwidth_rad_s = 3001.0;
    TEST_ASSERT_FALSE(drive_init(&drive, &fake_hal, &settings, error));
    TEST_ASSERT_EQUAL_STRING("current bandwidth 3001 rad/s: must be at most 3000 rad/s, "
                             "0.3 per control period",
                             error);
    settings.current_bandwidth_rad_s = 1500.0;
    settings.law_bandwidth_rad_s = 376.0;
    for (int law = 0; law < POSITION_LAW_VOLTAGE_FIRST; law++) {
        settings.law = (enum position_law)law;
        TEST_ASSERT_FALSE(drive_init(&drive, &fake_hal, &settings, error));
        TEST_ASSERT_EQUAL_STRING("position bandwidth 376 rad/s: must be at most 375 rad/s, "
                                 "a quarter of the current's",
                                 error);
    }
    settings.law_bandwidth_rad_s = 375.0;
    power_up();
}

static void test_settings_out_of_range_are_refused_before_anything_is_designed(void)
{
    settings.hold_current_A = -1.0;
    TEST_ASSERT_FALSE(drive_init(&drive, &fake_hal, &settings, error));
    TEST_ASSERT_EQUAL_STRING(
        "hold_current_A -1 A: must be at least 0.03 A, the range of this setting", error);
}

static void test_a_motor_slower_than_the_control_is_refused(void)
{
    settings.motor.inductance_H = 0.36e-4; /* L/R below the period */
    TEST_ASSERT_FALSE(drive_init(&drive, &fake_hal, &settings, error));
    TEST_ASSERT_EQUAL_STRING("period 0.0001 s: must be below 9.73e-05 s, the motor's L / R", error);
}

/* N w L/R = 4: 32.9 rad/s; what nobody has given is not refused. */
static void test_a_law_without_current_control_lowers_the_speed_limit_itself(void)
{
    drive_settings_select_law(&settings, POSITION_LAW_STMMS);
    power_up();
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4.0 * 0.37 / (50.0 * 0.9e-3), drive.settings.speed_limit_rad_s);
    settings.speed_limit_rad_s = 34.0;
    TEST_ASSERT_FALSE(drive_init(&drive, &fake_hal, &settings, error));
    TEST_ASSERT_EQUAL_STRING("speed_limit_rad_s 34 rad/s: must be at most 32.89 rad/s, "
                             "N w L/R <= 4 without current control",
                             error);
}

/* ---- in operation ---- */

static void test_the_first_hold_aligns_the_rotor_and_finds_the_resistance(void)
{
    motor.motor.resistance_ohm = 0.45;
    settings.hold_on_enable_s = 0.15;
    power_up();
    post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE});
    run(OFFSET_PERIODS + 1501);
    TEST_ASSERT_EQUAL_STRING("operation-enabled", drive_state_name(drive.supervision.state));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 3.0, signals().i_d_A);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.45, signals().resistance_est_ohm);
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, 0.0, motor.angle_rad);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.45 * 3.0, signals().u_d_V);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.0, signals().u_q_V);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 24.0, signals().bus_V);
}

static void test_current_sensors_that_differ_are_balanced_and_the_rotor_comes_back(void)
{
    double furthest_rad = 0.0;

    bridge.gain_a = 1.06;
    settings.hold_on_enable_s = 0.15;
    settings.balance_phases = true;
    power_up();
    post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE});
    run(OFFSET_PERIODS + 1501);
    TEST_ASSERT_EQUAL_STRING("aligning", drive_state_name(drive.supervision.state));
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 0.37 / 1.06, signals().resistance_est_ohm);
    while (drive.supervision.state == DRIVE_ALIGNING) {
        run(1);
        furthest_rad = fmax(furthest_rad, fabs(motor.angle_rad));
    }
    TEST_ASSERT_EQUAL_STRING("operation-enabled", drive_state_name(drive.supervision.state));
    /* half a code of the phase voltages is 2 % of the drop, and no noise smooths it here */
    TEST_ASSERT_DOUBLE_WITHIN(0.008, -0.5 * 0.06 / 1.03, signals().phase_imbalance);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.37 / sqrt(1.06), signals().resistance_est_ohm);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, TWO_PI / 8.0 / 50.0, furthest_rad);
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, 0.0, motor.angle_rad);
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, 0.0, signals().theta_est_rad);
}

/* A bare NEMA 17, 0.54 times the torque and 29 times the agility of the reference motor. */
static const struct motor_params light = {
    .resistance_ohm = 2.1,
    .inductance_H = 4.2e-3,
    .torque_constant_Nm_A = 0.1886,
    .viscous_friction_Nms_rad = 0.133e-3,
    .inertia_kgm2 = 5.4e-6,
    .rated_current_A = 1.5,
    .supply_V = 24.0,
    .rotor_teeth = 50,
};

/* Aligned by the rated current; half of it holds. */
static void enable_with_encoder(const struct motor_params *with, double angle_rad)
{
    encoder_facts.encoder_counts_per_turn = 4000;
    board.facts = &encoder_facts;
    drive_settings_default(&settings, with);
    drive_settings_select_feedback(&settings, DRIVE_FEEDBACK_ENCODER);
    settings.calibrate_offsets = false;
    settings.hold_current_A = 0.5 * with->rated_current_A;
    motor = (struct bench_motor){.motor = *with, .angle_rad = angle_rad};
    power_up();
    post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE});
    run(2);
    while (drive.supervision.state == DRIVE_ALIGNING) {
        run(1);
    }
    TEST_ASSERT_EQUAL_STRING("operation-enabled", drive_state_name(drive.supervision.state));
}

/* Far from the final angle; by how much the rotor stands off its count's middle the drive cannot
 * see. */
static void test_an_encoder_is_aligned_with_a_rotor_at_rest(void)
{
    for (int m = 0; m < 2; m++) {
        const struct motor_params *with = m == 0 ? &bench_params : &light;

        enable_with_encoder(with, 0.03);
        TEST_ASSERT_FALSE(drive.supervision.aligns);
        TEST_ASSERT_DOUBLE_WITHIN(0.6 * TWO_PI / 4000.0, motor.angle_rad, signals().theta_est_rad);
        TEST_ASSERT_DOUBLE_WITHIN(0.6, 0.0, motor.speed_rad_s); /* swings by a count at most */
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * with->resistance_ohm, with->resistance_ohm,
                                  signals().resistance_est_ohm);
        TEST_ASSERT_TRUE(drive.hold.current == drive.params.hold.current);
    }
}

/* Else the voltage of a current that turned with the frame stays for L / R: the rotor leads. */
static void test_on_both_ways_of_the_alignment_the_rotor_stands_where_it_is_held(void)
{
    const num_t *mean = drive.enabling.alignment.deviation_on_way;

    enable_with_encoder(&light, 0.0);
    TEST_ASSERT_NUM_WITHIN(0.5 / 360.0, 0.0,
                           mean[ALIGNMENT_UP_STRONG] - mean[ALIGNMENT_DOWN_STRONG]);
}

static void test_the_drive_knows_what_the_bridge_takes_away(void)
{
    enable();
    run(100);
    TEST_ASSERT_NUM_WITHIN(0.02 / 24.0, -DEAD_TIME_LOSS_V / 24.0, drive.actuation.loss.a);
}

static void test_without_adaptation_the_resistance_stays_as_it_was_set(void)
{
    motor.motor.resistance_ohm = 0.45;
    settings.resistance_adaptation = false;
    enable();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.37, signals().resistance_est_ohm);
    motor.load_torque_Nm = 0.05; /* brings in the hold's quick gains */
    run(300);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.37, signals().resistance_est_ohm);
}

/* A single period of delay left out of account would show: 2.7 mrad at 27 rad/s. */
static void test_a_move_is_followed_without_lag_and_ends_where_it_should(void)
{
    enable();
    move(1.5, 0.08);
    for (int k = 0; k < 80; k++) {
        run(10);
        TEST_ASSERT_DOUBLE_WITHIN(2.5e-3, 0.0, following_error_rad());
    }
    run(600);
    TEST_ASSERT_TRUE(signals().holding);
    TEST_ASSERT_DOUBLE_WITHIN(5e-4, 1.5, motor.angle_rad);
    TEST_ASSERT_DOUBLE_WITHIN(5e-4, 1.5, signals().theta_est_rad);
}

/* The law as published lags by 2/w0 times the speed. */
static void test_without_feed_forward_the_rotor_lags_by_twice_the_speed_over_the_bandwidth(void)
{
    settings.feed_forward = false;
    enable();
    move(1.5, 0.12);
    run(700);
    const double lag_s = 2.0 / drive.settings.law_bandwidth_rad_s;
    TEST_ASSERT_DOUBLE_WITHIN(0.1 * lag_s * signals().omega_ref_rad_s,
                              lag_s * signals().omega_ref_rad_s, following_error_rad());
}

static void test_a_load_is_estimated_and_carried_while_turning(void)
{
    enable();
    move(4.0, 0.2);
    run(800);
    motor.load_torque_Nm = 0.1;
    run(300);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.1, signals().load_torque_est_Nm);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, motor.speed_rad_s, signals().omega_est_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.1 / 0.157 + 0.307e-3 * motor.speed_rad_s / 0.157,
                              signals().i_q_ref_A);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, signals().i_q_ref_A, signals().i_q_A);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.0, following_error_rad());
}

static void test_both_directions_are_the_same_to_the_drive(void)
{
    double end[2];
    double middle[2];

    for (int i = 0; i < 2; i++) {
        setUp();
        enable();
        move(i == 0 ? 1.0 : -1.0, 0.08);
        run(400);
        middle[i] = motor.angle_rad;
        run(700);
        end[i] = motor.angle_rad;
    }
    TEST_ASSERT_DOUBLE_WITHIN(5e-4, -middle[0], middle[1]);
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, -end[0], end[1]);
}

/* At 57 rad/s the motor needs 9 V, of which duties meant for 24 V would leave 5. */
static void test_a_bus_that_sags_to_14_V_in_motion_is_made_up_for_in_two_periods(void)
{
    enable();
    move(4.0, 0.1);
    run(500);
    bridge.bus_V = 14.0;
    run(2); /* whose duties were on their way */
    for (int k = 0; k < 150; k++) {
        run(1);
        TEST_ASSERT_DOUBLE_WITHIN(0.25, signals().i_q_ref_A, signals().i_q_A);
    }
}

/* The frame moves every fourth period, and acts in the middle of those it is for: 0.24 mrad. */
static void test_a_held_rotor_is_led_along_without_lag(void)
{
    for (int direction = -1; direction <= 1; direction += 2) {
        double mean_rad = 0.0;

        setUp();
        bridge.background = true;
        enable();
        post((struct drive_command){.kind = DRIVE_COMMAND_VELOCITY,
                                    .speed_rad_s = direction * 0.8,
                                    .acceleration_rad_s2 = 20.0,
                                    .jerk_rad_s3 = 1e4});
        run(1500);
        for (int k = 0; k < 2000; k++) {
            run(1);
            mean_rad += following_error_rad() / 2000.0;
        }
        TEST_ASSERT_TRUE(signals().holding);
        TEST_ASSERT_DOUBLE_WITHIN(0.08e-3, 0.0, mean_rad);
    }
}

static void test_the_pid_holds_its_place_and_follows(void)
{
    settings.law = POSITION_LAW_PID;
    settings.law_bandwidth_rad_s = 150.0;
    enable();
    move(1.0, 0.1);
    for (int k = 0; k < 100; k++) {
        run(10);
        TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.0, following_error_rad());
    }
}

static void test_the_steady_state_ekf_serves_a_slow_move(void)
{
    settings.estimator = DRIVE_ESTIMATOR_STEADY_STATE_EKF;
    enable();
    move(0.8, 0.08);
    for (int k = 0; k < 80; k++) {
        run(10);
        TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.0, following_error_rad());
    }
}

/*
 * At rest a displaced rotor and a loaded one look alike, so the first hold cannot undo all of it;
 * the back-EMF of the first move can.
 */
static void test_twenty_electrical_degrees_assumed_wrong_are_found_by_the_first_move(void)
{
    settings.initial_angle_error_rad = 20.0 / 360.0 * TWO_PI / 50.0;
    enable();
    move(1.0, 0.1);
    run(1000);
    TEST_ASSERT_DOUBLE_WITHIN(1.0 / 360.0 * TWO_PI / 50.0, motor.angle_rad,
                              signals().theta_est_rad);
    run(600);
    TEST_ASSERT_DOUBLE_WITHIN(5e-4, 1.0, motor.angle_rad);
}

static void test_a_disable_in_motion_opens_the_bridge_at_once(void)
{
    enable();
    move(2.0, 0.12);
    run(500);
    post((struct drive_command){.kind = DRIVE_COMMAND_DISABLE});
    run(1);
    TEST_ASSERT_FALSE(bridge.in_force.bridge_on);
}

static void test_the_monitor_waits_for_a_period_in_which_no_command_is_looked_at(void)
{
    enable();
    while (drive.synchronism.due != drive.supervision.period + 1u) {
        run(1);
    }
    const uint8_t step = (uint8_t)drive.synchronism.step;

    post((struct drive_command){.kind = DRIVE_COMMAND_HOLD});
    run(1);
    TEST_ASSERT_EQUAL_UINT32(drive.supervision.period, drive.commands.looked);
    TEST_ASSERT_EQUAL_UINT8(step, drive.synchronism.step);
    run(2);
    TEST_ASSERT_TRUE(step != drive.synchronism.step);
}

/* Without saturation impulses show nothing, and an alignment finds it. */
static void test_behind_an_alignment_its_current_flows_on_into_the_hold(void)
{
    double before_A = 0.0;

    settings.initial_position = DRIVE_INITIAL_POSITION_IMPULSES;
    power_up();
    post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE});
    for (int k = 0; drive.supervision.state != DRIVE_ALIGNING; k++) {
        before_A = hypot(motor.i_a, motor.i_b);
        run(1);
        TEST_ASSERT_TRUE_MESSAGE(k < 20000, "it never ends");
    }
    TEST_ASSERT_FALSE(drive.enabling.detection.by_impulses);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 3.0, before_A);
    for (int k = 0; k < 20; k++) {
        run(1);
        TEST_ASSERT_DOUBLE_WITHIN(0.15, before_A, hypot(motor.i_a, motor.i_b));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_bandwidths_too_fast_are_refused_with_their_limit);
    RUN_TEST(test_settings_out_of_range_are_refused_before_anything_is_designed);
    RUN_TEST(test_a_motor_slower_than_the_control_is_refused);
    RUN_TEST(test_a_law_without_current_control_lowers_the_speed_limit_itself);
    RUN_TEST(test_the_first_hold_aligns_the_rotor_and_finds_the_resistance);
    RUN_TEST(test_current_sensors_that_differ_are_balanced_and_the_rotor_comes_back);
    RUN_TEST(test_an_encoder_is_aligned_with_a_rotor_at_rest);
    RUN_TEST(test_on_both_ways_of_the_alignment_the_rotor_stands_where_it_is_held);
    RUN_TEST(test_the_drive_knows_what_the_bridge_takes_away);
    RUN_TEST(test_without_adaptation_the_resistance_stays_as_it_was_set);
    RUN_TEST(test_a_move_is_followed_without_lag_and_ends_where_it_should);
    RUN_TEST(test_without_feed_forward_the_rotor_lags_by_twice_the_speed_over_the_bandwidth);
    RUN_TEST(test_a_load_is_estimated_and_carried_while_turning);
    RUN_TEST(test_both_directions_are_the_same_to_the_drive);
    RUN_TEST(test_a_bus_that_sags_to_14_V_in_motion_is_made_up_for_in_two_periods);
    RUN_TEST(test_a_held_rotor_is_led_along_without_lag);
    RUN_TEST(test_the_pid_holds_its_place_and_follows);
    RUN_TEST(test_the_steady_state_ekf_serves_a_slow_move);
    RUN_TEST(test_twenty_electrical_degrees_assumed_wrong_are_found_by_the_first_move);
    RUN_TEST(test_a_disable_in_motion_opens_the_bridge_at_once);
    RUN_TEST(test_the_monitor_waits_for_a_period_in_which_no_command_is_looked_at);
    RUN_TEST(test_behind_an_alignment_its_current_flows_on_into_the_hold);
    return UNITY_END();
}
