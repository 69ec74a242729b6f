/* The states of the drive and what leads from one to the next, on a board where nothing moves. */
#include <string.h>

#include "firmware/drive/command_rules.h"
#include "firmware/drive/state_machine.h"
#include "tests/unit/fake_board.h"
#include "tests/unit/num_assert.h"

#define HOLD_PERIODS 100u /* of the hold on enable, 10 ms */

static struct drive drive;
static struct drive_settings settings;
static struct hal_samples samples;
static struct hal_outputs outputs;
static char error[DRIVE_ERROR_TEXT];

static void power_up(void)
{
    TEST_ASSERT_TRUE_MESSAGE(drive_init(&drive, &fake_hal, &settings, error), error);
}

void setUp(void)
{
    drive_settings_default(&settings, &bench_params);
    settings.synchronism_policy = DRIVE_SYNCHRONISM_OFF; /* the rotor here follows nothing */
    settings.hold_on_enable_s = HOLD_PERIODS * PERIOD_S;
    settings.balance_phases = false; /* no current flows */
    fake_board = (struct fake_board){.trip_latched = false};
    samples = samples_at_rest;
    power_up();
}

void tearDown(void)
{
}

static void run(uint32_t periods)
{
    for (uint32_t k = 0; k < periods; k++) {
        drive_control_cycle(&drive, &samples, &outputs);
    }
}

static bool post(struct drive_command command)
{
    return drive_command(&drive, &command, error);
}

static void must_post(struct drive_command command)
{
    TEST_ASSERT_TRUE_MESSAGE(post(command), error);
}

static void must_refuse(struct drive_command command, const char *reason)
{
    TEST_ASSERT_FALSE(post(command));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, reason), error);
}

static void post_kind(enum drive_command_kind kind)
{
    must_post((struct drive_command){.kind = kind});
}

static struct drive_command move_to(double position_rad)
{
    return (struct drive_command){.kind = DRIVE_COMMAND_MOVE_TRAPEZOID,
                                  .position_rad = position_rad,
                                  .duration_s = 0.02,
                                  .ramp_s = 0.005};
}

/* A move, and some periods for its begin and for the one it is looked at in. */
enum { MOVE_PERIODS = 200, MOVE_AND_REST = MOVE_PERIODS + 5 };

static struct drive_signals signals(void)
{
    struct drive_signals now;

    drive_signals_read(&drive, &now);
    return now;
}

static void is_in(enum drive_state state, bool bridge_on)
{
    TEST_ASSERT_EQUAL_STRING(drive_state_name(state), drive_state_name(signals().state));
    TEST_ASSERT_EQUAL(bridge_on, outputs.bridge_on);
    for (int leg = 0; !bridge_on && leg < HAL_LEGS; leg++) {
        TEST_ASSERT_EQUAL_UINT16(0, outputs.high_counts[leg]);
    }
}

static void has_fault(enum drive_fault fault)
{
    is_in(DRIVE_FAULT, false);
    TEST_ASSERT_EQUAL_STRING(drive_fault_name(fault), drive_fault_name(signals().fault));
}

/* Ready by the shortest way. The period that powers up does no more; the next one drives. */
static void enable(void)
{
    settings.calibrate_offsets = false;
    settings.hold_on_enable = false;
    power_up();
    post_kind(DRIVE_COMMAND_ENABLE);
    run(2);
    is_in(DRIVE_OPERATION_ENABLED, true);
}

static void the_reference_is_at(double position_rad)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, position_rad, signals().theta_ref_rad);
}

/* ---- the way to operation ---- */

static void test_a_drive_powers_up_disabled_and_stays_so(void)
{
    run(100);
    is_in(DRIVE_SWITCH_ON_DISABLED, false);
    TEST_ASSERT_EQUAL(DRIVE_FAULT_NONE, signals().fault);
    TEST_ASSERT_FALSE(fake_board.bridge_enabled);
}

static void test_enabling_goes_through_offsets_and_alignment_to_operation(void)
{
    post_kind(DRIVE_COMMAND_ENABLE);
    TEST_ASSERT_TRUE(fake_board.bridge_enabled);
    run(1);
    is_in(DRIVE_CALIBRATING_OFFSETS, false);
    run(OFFSET_SAMPLES - 2u);
    is_in(DRIVE_CALIBRATING_OFFSETS, false);
    run(1);
    is_in(DRIVE_CALIBRATING_OFFSETS, true);
    for (int leg = 0; leg < HAL_LEGS; leg++) {
        TEST_ASSERT_EQUAL_UINT(8500 / 2, outputs.high_counts[leg]);
    }
    run(OFFSET_PERIODS - OFFSET_SAMPLES - 1u);
    is_in(DRIVE_CALIBRATING_OFFSETS, true);
    run(1);
    is_in(DRIVE_ALIGNING, false);
    run(1);
    is_in(DRIVE_ALIGNING, true);
    TEST_ASSERT_TRUE(signals().holding);
    run(HOLD_PERIODS - 1u);
    is_in(DRIVE_ALIGNING, true);
    run(1);
    is_in(DRIVE_OPERATION_ENABLED, true);
    TEST_ASSERT_TRUE(signals().holding);
}

static void test_without_calibration_enabling_begins_with_the_alignment(void)
{
    settings.calibrate_offsets = false;
    power_up();
    post_kind(DRIVE_COMMAND_ENABLE);
    run(2);
    is_in(DRIVE_ALIGNING, true);
    run(HOLD_PERIODS);
    is_in(DRIVE_OPERATION_ENABLED, true);
}

/* Drawn nearer by no current and led nowhere: an encoder whose counts stand has no zero. */
static void test_an_encoder_whose_counts_do_not_follow_the_alignment_ends_it_in_a_fault(void)
{
    static struct hal_facts facts;
    static struct hal board;

    facts = bench_facts;
    facts.encoder_counts_per_turn = 4000;
    board = fake_hal;
    board.facts = &facts;
    drive_settings_select_feedback(&settings, DRIVE_FEEDBACK_ENCODER);
    settings.calibrate_offsets = false;
    TEST_ASSERT_TRUE_MESSAGE(drive_init(&drive, &board, &settings, error), error);
    post_kind(DRIVE_COMMAND_ENABLE);
    run(2);
    is_in(DRIVE_ALIGNING, true);
    for (uint32_t k = 0; k < 40000u && signals().state == DRIVE_ALIGNING; k++) {
        run(1);
    }
    has_fault(DRIVE_FAULT_POSITION_NOT_FOUND);
    post_kind(DRIVE_COMMAND_DISABLE);
    run(1);
    TEST_ASSERT_FALSE(drive.supervision.aligns);
}

static void test_without_hold_on_enable_operation_follows_the_calibration(void)
{
    settings.hold_on_enable = false;
    power_up();
    post_kind(DRIVE_COMMAND_ENABLE);
    run(OFFSET_PERIODS - 1u);
    is_in(DRIVE_CALIBRATING_OFFSETS, true);
    run(2);
    is_in(DRIVE_OPERATION_ENABLED, true);
    TEST_ASSERT_FALSE(signals().holding);
}

static void test_phases_that_carry_no_current_are_not_let_pass(void)
{
    settings.balance_phases = true;
    settings.calibrate_offsets = false;
    power_up();
    post_kind(DRIVE_COMMAND_ENABLE);
    run(HOLD_PERIODS + 2u);
    is_in(DRIVE_ALIGNING, true);
    run(phase_balance_periods(&drive.enabling.balance_params));
    has_fault(DRIVE_FAULT_PHASE_IMBALANCE);
}

static void test_a_current_that_does_not_swing_as_that_of_a_winding_is_not_let_pass(void)
{
    settings.balance_phases = true;
    settings.calibrate_offsets = false;
    power_up();
    samples.current_a = 2048 + 360;
    samples.current_b = 2048 + 360;
    samples.phase_voltage_a = 26 * 10;
    samples.phase_voltage_b = 26 * 10;
    post_kind(DRIVE_COMMAND_ENABLE);
    run(HOLD_PERIODS + 2u + phase_balance_periods(&drive.enabling.balance_params));
    has_fault(DRIVE_FAULT_INDUCTANCE);
}

/* Their sensor says the same in both phases wherever the rotor is held. */
static void test_the_phases_are_balanced_behind_the_hold(void)
{
    const coef_t before = drive.params.measurement.current;

    settings.balance_phases = true;
    settings.identify_inductance = false; /* nothing swings */
    settings.calibrate_offsets = false;
    power_up();
    samples.current_a = 2048 + 360;
    samples.current_b = 2048 + 370;
    samples.phase_voltage_a = 26 * 10;
    samples.phase_voltage_b = 26 * 10;
    post_kind(DRIVE_COMMAND_ENABLE);
    run(HOLD_PERIODS + 2u + phase_balance_periods(&drive.enabling.balance_params));
    is_in(DRIVE_OPERATION_ENABLED, true);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 5.0 / 365.0, signals().phase_imbalance);
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, 1.0 + 5.0 / 365.0,
                              coef_to_double(drive.measurement.current_a) / coef_to_double(before));
    post_kind(DRIVE_COMMAND_DISABLE);
    post_kind(DRIVE_COMMAND_ENABLE);
    run(3);
    TEST_ASSERT_EQUAL_DOUBLE(1.0,
                             coef_to_double(drive.measurement.current_b) / coef_to_double(before));
}

static void test_without_either_the_drive_is_ready_at_once(void)
{
    enable();
    TEST_ASSERT_FALSE(signals().holding);
}

static void test_the_hold_current_is_in_when_the_alignment_ends(void)
{
    settings.calibrate_offsets = false;
    power_up();
    post_kind(DRIVE_COMMAND_ENABLE);
    run(HOLD_PERIODS + 1u);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 3.0, signals().i_d_ref_A);
}

static void test_enabling_waits_for_the_period_it_is_addressed_to(void)
{
    settings.calibrate_offsets = false;
    power_up();
    must_post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE, .at_period = 7});
    run(7); /* periods 0...6 */
    is_in(DRIVE_SWITCH_ON_DISABLED, false);
    run(1);
    is_in(DRIVE_ALIGNING, false);
    TEST_ASSERT_EQUAL_UINT32(7, signals().period);
}

static void test_enabling_is_refused_while_the_boards_trip_cannot_be_cleared(void)
{
    fake_board.short_circuit = true;
    TEST_ASSERT_FALSE(post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE}));
    TEST_ASSERT_EQUAL_STRING("enable refused: the board's overcurrent trip is latched", error);
    run(10);
    is_in(DRIVE_SWITCH_ON_DISABLED, false);
}

static void test_after_a_trip_of_the_board_the_drive_can_be_enabled_again(void)
{
    enable();
    samples.flags = HAL_FLAG_OVERCURRENT_TRIP;
    fake_board.trip_latched = true;
    run(1);
    has_fault(DRIVE_FAULT_HARDWARE_OVERCURRENT);
    samples.flags = 0;
    TEST_ASSERT_FALSE(post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE}));
    post_kind(DRIVE_COMMAND_DISABLE);
    run(1);
    post_kind(DRIVE_COMMAND_ENABLE);
    run(2);
    is_in(DRIVE_OPERATION_ENABLED, true);
}

static void test_a_fault_that_the_background_sees_opens_the_bridge_in_the_next_interrupt(void)
{
    enable();
    state_machine_ask_for_fault(&drive, DRIVE_FAULT_OPEN_PHASE_B);
    is_in(DRIVE_OPERATION_ENABLED, true);
    run(1);
    has_fault(DRIVE_FAULT_OPEN_PHASE_B);
    run(10);
    post_kind(DRIVE_COMMAND_DISABLE);
    run(1);
    is_in(DRIVE_SWITCH_ON_DISABLED, false);
}

/* The drive has been disabled before the interrupt came: nothing is left for the next enable. */
static void test_a_fault_that_comes_too_late_is_none(void)
{
    enable();
    post_kind(DRIVE_COMMAND_DISABLE);
    run(1);
    state_machine_ask_for_fault(&drive, DRIVE_FAULT_OPEN_PHASE_B);
    run(1);
    is_in(DRIVE_SWITCH_ON_DISABLED, false);
    post_kind(DRIVE_COMMAND_ENABLE);
    run(5);
    is_in(DRIVE_OPERATION_ENABLED, true);
}

/* The disable is on its way: it counts although the drive is in fault still. */
static void test_after_a_trip_of_the_board_disable_and_enable_can_be_posted_at_once(void)
{
    enable();
    samples.flags = HAL_FLAG_OVERCURRENT_TRIP;
    fake_board.trip_latched = true;
    run(1);
    samples.flags = 0;
    post_kind(DRIVE_COMMAND_DISABLE);
    post_kind(DRIVE_COMMAND_ENABLE);
    has_fault(DRIVE_FAULT_HARDWARE_OVERCURRENT);
    run(3);
    is_in(DRIVE_OPERATION_ENABLED, true);
    TEST_ASSERT_TRUE(fake_board.bridge_enabled);
}

static void test_a_disable_for_later_does_not_clear_the_boards_trip(void)
{
    enable();
    samples.flags = HAL_FLAG_OVERCURRENT_TRIP;
    fake_board.trip_latched = true;
    run(1);
    must_post((struct drive_command){.kind = DRIVE_COMMAND_DISABLE, .at_period = 5000});
    TEST_ASSERT_FALSE(post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE}));
    TEST_ASSERT_TRUE(fake_board.trip_latched);
}

static void test_a_drive_starts_at_the_angle_it_assumes(void)
{
    settings.initial_angle_rad = 0.3;
    settings.initial_angle_error_rad = -0.05;
    enable();
    the_reference_is_at(0.25);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.25, signals().theta_est_rad);
}

static void test_enabling_an_enabled_drive_changes_nothing(void)
{
    enable();
    must_post(move_to(0.1));
    run(MOVE_AND_REST);
    post_kind(DRIVE_COMMAND_ENABLE);
    must_post(move_to(0.2));
    run(1);
    is_in(DRIVE_OPERATION_ENABLED, true);
    the_reference_is_at(0.1);
    run(MOVE_AND_REST);
    the_reference_is_at(0.2);
}

/* What the last operation left behind would be a kick at the begin of the next. */
static void test_enabling_begins_with_all_blocks_at_rest(void)
{
    settings.law = POSITION_LAW_PID;
    settings.law_bandwidth_rad_s = 150.0;
    enable();
    samples.current_a = 2048 + 300;
    samples.phase_voltage_a = 21; /* what the resistance takes */
    must_post(move_to(0.003));
    run(MOVE_AND_REST);
    post_kind(DRIVE_COMMAND_HOLD);
    run(10);
    TEST_ASSERT_TRUE(signals().holding);
    TEST_ASSERT_TRUE(drive.law.pid.integral != NUM(0.0));
    post_kind(DRIVE_COMMAND_DISABLE);
    run(1);
    post_kind(DRIVE_COMMAND_ENABLE);
    run(1);
    TEST_ASSERT_FALSE(drive.hold.active);
    TEST_ASSERT_NUM_WITHIN(0.0, 0.0, drive.hold.i_d);
    TEST_ASSERT_NUM_WITHIN(0.0, 0.0, drive.law.pid.integral);
    TEST_ASSERT_NUM_WITHIN(0.0, 0.0, drive.current_control.integral.d);
    TEST_ASSERT_NUM_WITHIN(0.0, 0.0, drive.current_control.integral.q);
    TEST_ASSERT_NUM_WITHIN(0.0, 0.0, drive.actuation.in_force.a);
    TEST_ASSERT_NUM_WITHIN(0.0, 0.0, drive.estimator.invariant_ekf.estimate.rotor.speed);
    TEST_ASSERT_FALSE(drive.reference.next.moving);
}

/* ---- initial position detection ---- */

static void disabling_works_at_once(void)
{
    post_kind(DRIVE_COMMAND_DISABLE);
    run(1);
    is_in(DRIVE_SWITCH_ON_DISABLED, false);
    run(50);
    is_in(DRIVE_SWITCH_ON_DISABLED, false);
    TEST_ASSERT_EQUAL(DRIVE_FAULT_NONE, signals().fault);
}

/* On this board no current flows: that is not taken for a position. */
static void begin_detection(void)
{
    settings.calibrate_offsets = false;
    settings.initial_position = DRIVE_INITIAL_POSITION_IMPULSES;
    power_up();
    post_kind(DRIVE_COMMAND_ENABLE);
    run(1);
    is_in(DRIVE_DETECTING_POSITION, true);
}

static void test_a_position_that_cannot_be_found_is_a_fault_with_a_name(void)
{
    begin_detection();
    run(400);
    has_fault(DRIVE_FAULT_POSITION_NOT_FOUND);
    disabling_works_at_once();
}

static void test_initial_position_detection_follows_the_offsets(void)
{
    settings.initial_position = DRIVE_INITIAL_POSITION_IMPULSES;
    power_up();
    post_kind(DRIVE_COMMAND_ENABLE);
    run(OFFSET_PERIODS - 1u);
    is_in(DRIVE_CALIBRATING_OFFSETS, true);
    run(1);
    is_in(DRIVE_DETECTING_POSITION, true);
}

static void test_a_fault_opens_the_bridge_while_the_position_is_found(void)
{
    begin_detection();
    samples.current_a = 4000;
    run(1);
    has_fault(DRIVE_FAULT_OVERCURRENT);
    samples = samples_at_rest;
    begin_detection();
    samples.bus_voltage = 1000;
    run(1);
    has_fault(DRIVE_FAULT_BUS_VOLTAGE);
}

static void test_initial_position_detection_can_be_ended_at_once(void)
{
    begin_detection();
    run(100); /* into the impulses */
    disabling_works_at_once();
}

static void test_motion_is_refused_until_the_position_is_found(void)
{
    begin_detection();
    must_refuse(move_to(0.1), "the drive is being enabled, wait until it is ready");
}

/* What is found is the angle; the turn is that of the angle assumed. */
static void the_start_is(double assumed_rad, double found_turns, double expected_rad)
{
    settings.initial_angle_rad = assumed_rad;
    begin_detection();
    state_machine_position_found(&drive, (angle_t)(int64_t)(found_turns * 4294967296.0));
    is_in(DRIVE_ALIGNING, true);
    the_reference_is_at(expected_rad);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, expected_rad, signals().theta_est_rad);
}

static void test_the_rotor_is_in_the_electrical_turn_nearest_to_the_angle_assumed(void)
{
    const double turn_rad = TWO_PI / 50.0;

    the_start_is(0.0, 0.1, 0.1 * turn_rad);
    the_start_is(0.0, 0.9, -0.1 * turn_rad);
    the_start_is(7.0 * turn_rad, 0.2, 7.2 * turn_rad);
    the_start_is(-3.4 * turn_rad, 0.99, -3.01 * turn_rad);
    the_start_is(-3.4 * turn_rad, 0.2, -3.8 * turn_rad);
}

/* ---- disabling ---- */

static void test_a_drive_can_be_disabled_from_everywhere(void)
{
    disabling_works_at_once(); /* disabled already */

    post_kind(DRIVE_COMMAND_ENABLE);
    run(100);
    is_in(DRIVE_CALIBRATING_OFFSETS, false);
    disabling_works_at_once();

    post_kind(DRIVE_COMMAND_ENABLE);
    run(OFFSET_SAMPLES + 100u);
    is_in(DRIVE_CALIBRATING_OFFSETS, true);
    disabling_works_at_once();

    post_kind(DRIVE_COMMAND_ENABLE);
    run(OFFSET_PERIODS + 10u);
    is_in(DRIVE_ALIGNING, true);
    disabling_works_at_once();

    enable();
    disabling_works_at_once();

    enable();
    must_post(move_to(0.2));
    run(50);
    TEST_ASSERT_TRUE(signals().reference_moving);
    disabling_works_at_once();

    enable();
    samples.flags = HAL_FLAG_OVERCURRENT_TRIP;
    run(1);
    is_in(DRIVE_FAULT, false);
    disabling_works_at_once();
}

static void test_a_disable_flushes_the_moves_before_it(void)
{
    enable();
    must_post(move_to(0.1));
    must_post(move_to(0.2));
    post_kind(DRIVE_COMMAND_DISABLE);
    run(1);
    post_kind(DRIVE_COMMAND_ENABLE);
    run(2 * MOVE_AND_REST);
    the_reference_is_at(0.0);
}

static void test_after_disabling_the_drive_can_be_enabled_and_moved_again(void)
{
    enable();
    must_post(move_to(0.2));
    run(50);
    post_kind(DRIVE_COMMAND_DISABLE);
    run(1);
    post_kind(DRIVE_COMMAND_ENABLE);
    run(1);
    must_post(move_to(0.1));
    run(MOVE_AND_REST);
    is_in(DRIVE_OPERATION_ENABLED, true);
    the_reference_is_at(0.1);
}

static void test_an_enable_right_behind_a_disable_still_opens_the_bridge(void)
{
    enable();
    run(10);
    post_kind(DRIVE_COMMAND_DISABLE);
    post_kind(DRIVE_COMMAND_ENABLE);
    run(1);
    is_in(DRIVE_SWITCH_ON_DISABLED, false);
    run(2);
    is_in(DRIVE_OPERATION_ENABLED, true);
}

/* ---- faults ---- */

static void opens_the_bridge_at_once(struct hal_samples faulty, enum drive_fault fault)
{
    enable();
    run(10);
    is_in(DRIVE_OPERATION_ENABLED, true);
    samples = faulty;
    run(1);
    has_fault(fault);
    samples = samples_at_rest;
    run(100);
    has_fault(fault);
}

static void test_every_fault_opens_the_bridge_in_the_period_of_its_sample_and_stays(void)
{
    struct hal_samples faulty = samples_at_rest;

    faulty.flags = HAL_FLAG_OVERCURRENT_TRIP;
    opens_the_bridge_at_once(faulty, DRIVE_FAULT_HARDWARE_OVERCURRENT);
    faulty.flags = HAL_FLAG_DEADLINE_MISSED;
    opens_the_bridge_at_once(faulty, DRIVE_FAULT_DEADLINE_MISSED);
    faulty = samples_at_rest;
    faulty.current_b = 4000;
    opens_the_bridge_at_once(faulty, DRIVE_FAULT_OVERCURRENT);
    faulty = samples_at_rest;
    faulty.bus_voltage = 1000;
    opens_the_bridge_at_once(faulty, DRIVE_FAULT_BUS_VOLTAGE);
}

static void test_a_fault_while_aligning_opens_the_bridge_too(void)
{
    settings.calibrate_offsets = false;
    power_up();
    post_kind(DRIVE_COMMAND_ENABLE);
    run(10);
    samples.bus_voltage = 4095;
    run(1);
    has_fault(DRIVE_FAULT_BUS_VOLTAGE);
}

/* The bridge stays open even in the period that turns it on. */
static void test_a_supply_that_is_missing_on_enable_is_a_fault_before_the_bridge_is_on(void)
{
    settings.calibrate_offsets = false;
    power_up();
    samples.bus_voltage = 0;
    post_kind(DRIVE_COMMAND_ENABLE);
    run(1);
    has_fault(DRIVE_FAULT_BUS_VOLTAGE);
}

static void test_an_offset_out_of_range_is_a_fault(void)
{
    samples.current_a = 2048 + OFFSET_CODES_MAX + 1;
    post_kind(DRIVE_COMMAND_ENABLE);
    run(OFFSET_SAMPLES);
    has_fault(DRIVE_FAULT_OFFSET_RANGE);
    TEST_ASSERT_TRUE(drive.measurement.offset.current.a > NUM(0.0)); /* shown */
}

static void test_the_second_stage_of_the_offsets_is_protected_as_operation_is(void)
{
    post_kind(DRIVE_COMMAND_ENABLE);
    run(OFFSET_SAMPLES + 10u);
    is_in(DRIVE_CALIBRATING_OFFSETS, true);
    samples.current_b = 4095;
    run(1);
    has_fault(DRIVE_FAULT_OVERCURRENT);
    post_kind(DRIVE_COMMAND_DISABLE);
    samples = samples_at_rest;
    run(1);
    post_kind(DRIVE_COMMAND_ENABLE); /* begins with the first stage again */
    run(OFFSET_SAMPLES - 1u);
    is_in(DRIVE_CALIBRATING_OFFSETS, false);
}

static void test_a_disabled_drive_needs_no_supply(void)
{
    samples.bus_voltage = 0;
    samples.flags = HAL_FLAG_DEADLINE_MISSED;
    run(10);
    is_in(DRIVE_SWITCH_ON_DISABLED, false);
    TEST_ASSERT_EQUAL(DRIVE_FAULT_NONE, signals().fault);
}

static void test_an_estimate_out_of_range_opens_the_bridge_in_the_same_period(void)
{
    static const double speeds[] = {1.4, -1.4}; /* of the no-load speed */

    for (unsigned i = 0; i < sizeof speeds / sizeof speeds[0]; i++) {
        enable();
        run(10);
        drive.estimator.invariant_ekf.estimate.next.speed = num_from_double(speeds[i]);
        run(1);
        has_fault(DRIVE_FAULT_ESTIMATE_RANGE);
    }
}

static bool trips_at(double speed_rad_s)
{
    enable();
    run(10);
    drive.estimator.invariant_ekf.estimate.next.speed =
        num_from_double(speed_rad_s / drive.base.speed_rad_s);
    run(1);
    return drive.supervision.state == DRIVE_FAULT;
}

/* 0.24 electrical turn a period is 301.6 rad/s. */
static void test_no_limit_lets_the_speed_pass_what_the_sampling_can_follow(void)
{
    settings.speed_limit_rad_s = 1000.0;
    TEST_ASSERT_FALSE(trips_at(295.0));
    TEST_ASSERT_TRUE(trips_at(305.0));
    TEST_ASSERT_TRUE(trips_at(-305.0));
}

/* Four times supply / Km, whose square is half of what fixed point bears. */
static void test_no_limit_lets_the_speed_pass_what_its_square_can_bear(void)
{
    settings.speed_limit_rad_s = 1000.0;
    settings.motor.torque_constant_Nm_A *= 3.0;
    const double most = 4.0 * settings.motor.supply_V / settings.motor.torque_constant_Nm_A;

    TEST_ASSERT_TRUE(most < 290.0);
    TEST_ASSERT_FALSE(trips_at(0.98 * most));
    TEST_ASSERT_TRUE(trips_at(1.02 * most));
    TEST_ASSERT_TRUE(trips_at(-1.02 * most));
}

#if STEADYSTEP_NUM != NUM_FIXED
static void test_an_estimate_that_is_not_finite_opens_the_bridge_in_the_same_period(void)
{
    enable();
    run(10);
    drive.estimator.invariant_ekf.estimate.rotor.load_torque = (num_t)__builtin_nan("");
    run(1);
    has_fault(DRIVE_FAULT_ESTIMATE_RANGE);
    post_kind(DRIVE_COMMAND_DISABLE);
    run(1);
    post_kind(DRIVE_COMMAND_ENABLE);
    run(10);
    is_in(DRIVE_OPERATION_ENABLED, true);
}
#endif

static void test_a_fault_is_cleared_by_disabling_only(void)
{
    enable();
    must_post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE, .at_period = 5});
    samples.flags = HAL_FLAG_DEADLINE_MISSED;
    run(1);
    samples.flags = 0;
    must_refuse((struct drive_command){.kind = DRIVE_COMMAND_ENABLE},
                "enable refused: fault deadline-missed: a control interrupt has ended too late; "
                "disable clears it");
    run(10);
    has_fault(DRIVE_FAULT_DEADLINE_MISSED);
    TEST_ASSERT_EQUAL_UINT32(1, signals().commands_dropped);
    TEST_ASSERT_EQUAL(DRIVE_COMMAND_ENABLE, signals().dropped_kind);
    must_refuse((struct drive_command){.kind = DRIVE_COMMAND_STOP},
                "stop refused: the drive is in fault, disable clears it");
    run(10);
    has_fault(DRIVE_FAULT_DEADLINE_MISSED);
    post_kind(DRIVE_COMMAND_DISABLE);
    run(1);
    is_in(DRIVE_SWITCH_ON_DISABLED, false);
    post_kind(DRIVE_COMMAND_ENABLE);
    run(2);
    is_in(DRIVE_OPERATION_ENABLED, true);
    TEST_ASSERT_EQUAL(DRIVE_FAULT_NONE, signals().fault);
}

/* ---- moves, stops, holds ---- */

static void test_moves_follow_one_another_without_waiting_to_be_posted(void)
{
    enable();
    must_post(move_to(0.1));
    must_post(move_to(-0.05));
    run(MOVE_AND_REST);
    TEST_ASSERT_TRUE(signals().theta_ref_rad > 0.0999);
    TEST_ASSERT_TRUE(signals().reference_moving);
    run(MOVE_AND_REST);
    the_reference_is_at(-0.05);
    TEST_ASSERT_FALSE(signals().reference_moving);
}

static void test_steps_and_smooth_moves_are_made_too(void)
{
    enable();
    must_post((struct drive_command){.kind = DRIVE_COMMAND_STEP, .position_rad = 0.02});
    must_post((struct drive_command){.kind = DRIVE_COMMAND_MOVE_SMOOTH,
                                     .position_rad = 0.1,
                                     .duration_s = 0.03,
                                     .ramp_s = 0.01,
                                     .jerk_s = 0.002});
    run(5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.02, signals().theta_ref_rad);
    run(310);
    the_reference_is_at(0.1);
}

/* The interrupt of that period computes what acts from the next on; a period later it has moved. */
static void test_a_move_begins_with_the_period_it_is_addressed_to(void)
{
    struct drive_command command = move_to(0.1);

    enable();
    command.at_period = 50;
    must_post(command);
    run(50); /* enabled in 2 */
    TEST_ASSERT_EQUAL_UINT32(51, signals().period);
    the_reference_is_at(0.0);
    run(1);
    TEST_ASSERT_TRUE(signals().theta_ref_rad > 1e-7);
}

static void test_a_stop_brings_the_reference_to_rest_short_of_its_target(void)
{
    enable();
    must_post(move_to(0.2));
    run(80);
    post_kind(DRIVE_COMMAND_STOP);
    run(1);
    TEST_ASSERT_TRUE(signals().reference_moving);
    run(60);
    TEST_ASSERT_FALSE(signals().reference_moving);
    TEST_ASSERT_TRUE(signals().theta_ref_rad > 0.05);
    TEST_ASSERT_TRUE(signals().theta_ref_rad < 0.15);
    is_in(DRIVE_OPERATION_ENABLED, true);
}

static void test_a_stop_acts_in_the_period_it_is_addressed_to(void)
{
    struct drive_command stop = {.kind = DRIVE_COMMAND_STOP};

    enable();
    must_post(move_to(0.2));
    run(40);
    stop.at_period = signals().period + 30u;
    must_post(stop);
    run(60);
    TEST_ASSERT_EQUAL_UINT32(stop.at_period, drive.commands.stop_acted_in);
}

static void test_a_stop_overtakes_the_moves_that_wait(void)
{
    enable();
    must_post(move_to(0.2));
    must_post(move_to(0.4));
    run(80);
    post_kind(DRIVE_COMMAND_STOP);
    run(3 * MOVE_AND_REST);
    TEST_ASSERT_TRUE(signals().theta_ref_rad < 0.2);
}

/* The move under way is not in the queue any more, but what it is made along still is in use. */
static void test_commands_posted_behind_a_stop_leave_its_ramp_alone(void)
{
    enable();
    must_post(move_to(0.2));
    must_post(move_to(0.4));
    run(80);
    post_kind(DRIVE_COMMAND_STOP);
    run(1);
    while (post((struct drive_command){.kind = DRIVE_COMMAND_HOLD})) {
    }
    run(40); /* of the 50 that its ramp takes */
    TEST_ASSERT_TRUE(signals().reference_moving);
    run(20);
    TEST_ASSERT_FALSE(signals().reference_moving);
}

static void test_moves_are_refused_while_a_stop_is_under_way_and_accepted_after(void)
{
    enable();
    must_post(move_to(0.2));
    run(80);
    post_kind(DRIVE_COMMAND_STOP);
    TEST_ASSERT_FALSE(post(move_to(0.3)));
    TEST_ASSERT_EQUAL_STRING("move refused: the reference has not come to rest after the stop",
                             error);
    run(1);
    TEST_ASSERT_FALSE(post(move_to(0.3)));
    run(60);
    must_post(move_to(0.3));
    run(MOVE_AND_REST);
    the_reference_is_at(0.3);
}

static void test_after_a_stop_moves_can_be_queued_again(void)
{
    enable();
    must_post(move_to(0.2));
    run(80);
    post_kind(DRIVE_COMMAND_STOP);
    run(60);
    must_post(move_to(0.1));
    run(10);
    must_post(move_to(0.3));
    run(2 * MOVE_AND_REST);
    the_reference_is_at(0.3);
}

static void test_a_stop_cut_off_by_a_disable_does_not_block_later_moves(void)
{
    enable();
    must_post(move_to(0.2));
    run(80);
    post_kind(DRIVE_COMMAND_STOP);
    run(1);
    post_kind(DRIVE_COMMAND_DISABLE);
    run(1);
    post_kind(DRIVE_COMMAND_ENABLE);
    run(1);
    must_post(move_to(0.1));
    run(MOVE_AND_REST);
    the_reference_is_at(0.1);
}

static void test_a_stop_at_rest_is_harmless(void)
{
    enable();
    post_kind(DRIVE_COMMAND_STOP);
    run(1);
    must_post(move_to(0.1));
    run(MOVE_AND_REST);
    the_reference_is_at(0.1);
}

static void test_a_move_before_the_drive_is_ready_is_refused_and_leaves_no_trace(void)
{
    must_refuse(move_to(0.1), "move refused: the drive is switch-on-disabled, enable it first");
    post_kind(DRIVE_COMMAND_ENABLE);
    must_refuse(move_to(0.1), "move refused: the drive is being enabled, wait until it is ready");
    run(10);
    must_refuse(move_to(0.1), "move refused: the drive is being enabled, wait until it is ready");
    run(OFFSET_PERIODS + HOLD_PERIODS + 10u);
    is_in(DRIVE_OPERATION_ENABLED, true);
    the_reference_is_at(0.0);
    must_post(move_to(0.2));
    run(MOVE_AND_REST);
    the_reference_is_at(0.2);
}

/* ---- what is legal when ---- */

/* A bit for each state, in its order: legal. */
static void is_legal_in(enum drive_command_kind kind, const char *states)
{
    for (int i = 0; i < DRIVE_STATES; i++) {
        enum drive_state state = (enum drive_state)i;

        TEST_ASSERT_EQUAL_MESSAGE(states[i] == '1', command_rules_obeyed(kind, state),
                                  drive_state_name(state));
    }
}

static void test_what_is_legal_when_stands_in_one_table(void)
{
    is_legal_in(DRIVE_COMMAND_ENABLE, "111110");
    is_legal_in(DRIVE_COMMAND_DISABLE, "111111");
    is_legal_in(DRIVE_COMMAND_STORE, "111111");
    for (enum drive_command_kind kind = DRIVE_COMMAND_HOLD; kind < DRIVE_COMMAND_STORE; kind++) {
        is_legal_in(kind, "000010");
    }
}

static void test_a_command_is_judged_by_the_state_that_it_will_find(void)
{
    struct drive_command move = move_to(0.1);

    enable();
    must_post((struct drive_command){.kind = DRIVE_COMMAND_DISABLE, .at_period = 1000});
    move.at_period = 500;
    must_post(move);
    move.at_period = 1000;
    must_refuse(move, "move refused: a disable acts in period 1000, enable the drive behind it");
    must_post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE, .at_period = 1001});
    move.at_period = 3000;
    must_refuse(move, "move refused: the drive is being enabled, wait until it is ready");
    move.at_period = 500; /* but in its turn, behind the enable */
    must_refuse(move, "move refused: the drive is being enabled, wait until it is ready");
    must_post((struct drive_command){.kind = DRIVE_COMMAND_STOP, .at_period = 500});
}

static void test_a_command_asked_for_before_the_drive_was_ready_is_refused_behind_it(void)
{
    const struct drive_command move = move_to(0.1);

    enable();
    TEST_ASSERT_EQUAL_UINT32(0, drive.supervision.state_since);
    run(20);
    TEST_ASSERT_FALSE(drive_command_asked_in(&drive, &move, UINT32_MAX, error));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, "being enabled"), error);
    TEST_ASSERT_TRUE_MESSAGE(drive_command_asked_in(&drive, &move, 0, error), error);
}

static void test_what_waits_for_the_end_of_a_move_is_dropped_when_a_fault_ends_it(void)
{
    enable();
    must_post(move_to(0.1));
    must_post(move_to(0.2));
    must_post(move_to(0.3));
    run(100);
    samples.flags = HAL_FLAG_DEADLINE_MISSED;
    run(1);
    has_fault(DRIVE_FAULT_DEADLINE_MISSED);
    TEST_ASSERT_EQUAL_UINT32(0, signals().commands_dropped);
    run(2);
    TEST_ASSERT_EQUAL_UINT32(2, signals().commands_dropped);
    run(100);
    TEST_ASSERT_EQUAL_UINT32(2, signals().commands_dropped);
}

/* Two at once and one later; a fault comes first. */
static void test_what_a_fault_keeps_from_acting_is_dropped_in_its_period_and_counted(void)
{
    struct drive_command later = {.kind = DRIVE_COMMAND_HOLD};

    enable();
    run(10);
    must_post(move_to(0.1));
    must_post(move_to(0.2));
    later.at_period = drive.supervision.period + 100u;
    must_post(later);
    samples.flags = HAL_FLAG_DEADLINE_MISSED;
    run(1); /* loads the first */
    has_fault(DRIVE_FAULT_DEADLINE_MISSED);
    TEST_ASSERT_EQUAL_UINT32(0, signals().commands_dropped);
    run(1);
    TEST_ASSERT_EQUAL_UINT32(1, signals().commands_dropped);
    TEST_ASSERT_EQUAL(DRIVE_COMMAND_MOVE_TRAPEZOID, signals().dropped_kind);
    run(97);
    TEST_ASSERT_EQUAL_UINT32(1, signals().commands_dropped);
    run(1);
    TEST_ASSERT_EQUAL_UINT32(2, signals().commands_dropped);
    TEST_ASSERT_EQUAL(DRIVE_COMMAND_HOLD, signals().dropped_kind);
}

static void test_what_is_so_already_or_flushed_is_not_counted(void)
{
    post_kind(DRIVE_COMMAND_ENABLE);
    run(10);
    post_kind(DRIVE_COMMAND_ENABLE); /* it is on its way */
    run(10);
    TEST_ASSERT_EQUAL_UINT32(0, signals().commands_dropped);
    enable();
    must_post(move_to(0.1));
    must_post(move_to(0.2));
    post_kind(DRIVE_COMMAND_STOP);
    run(10);
    must_post(move_to(0.1));
    must_post(move_to(0.2));
    post_kind(DRIVE_COMMAND_DISABLE);
    run(10);
    post_kind(DRIVE_COMMAND_ENABLE);
    run(10);
    post_kind(DRIVE_COMMAND_ENABLE); /* it is already */
    run(10);
    TEST_ASSERT_EQUAL_UINT32(0, signals().commands_dropped);
}

static void test_a_move_that_does_not_begin_where_the_reference_is_is_dropped_and_counted(void)
{
    enable();
    must_post(move_to(0.1));
    drive.commands.entry[1].profile.start.fraction++;
    run(10);
    TEST_ASSERT_EQUAL_UINT32(1, signals().commands_dropped);
    TEST_ASSERT_EQUAL(DRIVE_COMMAND_MOVE_TRAPEZOID, signals().dropped_kind);
    the_reference_is_at(0.0);
}

static void test_a_hold_command_holds_without_the_delay(void)
{
    enable();
    run(3);
    TEST_ASSERT_FALSE(signals().holding);
    post_kind(DRIVE_COMMAND_HOLD);
    run(1);
    TEST_ASSERT_TRUE(signals().holding);
}

static void test_the_drive_holds_by_itself_15_ms_after_a_move(void)
{
    settings.hold_delay_s = 0.015;
    enable();
    drive.params.reference.creep_speed = NUM(0.0);
    must_post(move_to(0.003)); /* near, for a board where nothing moves */
    run(1);
    while (signals().reference_moving || reference_busy(&drive.reference)) {
        run(1);
    }
    run(148);
    TEST_ASSERT_FALSE(signals().holding);
    run(1);
    TEST_ASSERT_TRUE(signals().holding); /* from the 150th period on */
}

static void test_a_move_too_fast_is_refused_and_the_next_one_starts_where_the_last_ended(void)
{
    enable();
    must_post(move_to(0.1));
    TEST_ASSERT_FALSE(post(move_to(50.0)));
    TEST_ASSERT_TRUE(strstr(error, "must be at most") != NULL);
    must_post(move_to(0.2));
    run(2 * MOVE_AND_REST);
    the_reference_is_at(0.2);
}

static void test_one_command_too_many_is_refused(void)
{
    enable();
    for (int i = 0; i < 15; i++) {
        must_post(move_to(0.01 * i));
    }
    TEST_ASSERT_FALSE(post(move_to(0.2)));
    TEST_ASSERT_EQUAL_STRING("command refused: 15 commands are waiting already", error);
    post_kind(DRIVE_COMMAND_DISABLE);
    run(1);
    is_in(DRIVE_SWITCH_ON_DISABLED, false);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_drive_powers_up_disabled_and_stays_so);
    RUN_TEST(test_enabling_goes_through_offsets_and_alignment_to_operation);
    RUN_TEST(test_without_calibration_enabling_begins_with_the_alignment);
    RUN_TEST(test_an_encoder_whose_counts_do_not_follow_the_alignment_ends_it_in_a_fault);
    RUN_TEST(test_without_hold_on_enable_operation_follows_the_calibration);
    RUN_TEST(test_phases_that_carry_no_current_are_not_let_pass);
    RUN_TEST(test_a_current_that_does_not_swing_as_that_of_a_winding_is_not_let_pass);
    RUN_TEST(test_the_phases_are_balanced_behind_the_hold);
    RUN_TEST(test_without_either_the_drive_is_ready_at_once);
    RUN_TEST(test_the_hold_current_is_in_when_the_alignment_ends);
    RUN_TEST(test_enabling_waits_for_the_period_it_is_addressed_to);
    RUN_TEST(test_enabling_is_refused_while_the_boards_trip_cannot_be_cleared);
    RUN_TEST(test_a_fault_that_the_background_sees_opens_the_bridge_in_the_next_interrupt);
    RUN_TEST(test_a_fault_that_comes_too_late_is_none);
    RUN_TEST(test_after_a_trip_of_the_board_the_drive_can_be_enabled_again);
    RUN_TEST(test_after_a_trip_of_the_board_disable_and_enable_can_be_posted_at_once);
    RUN_TEST(test_a_disable_for_later_does_not_clear_the_boards_trip);
    RUN_TEST(test_a_drive_starts_at_the_angle_it_assumes);
    RUN_TEST(test_enabling_an_enabled_drive_changes_nothing);
    RUN_TEST(test_enabling_begins_with_all_blocks_at_rest);
    RUN_TEST(test_a_position_that_cannot_be_found_is_a_fault_with_a_name);
    RUN_TEST(test_initial_position_detection_follows_the_offsets);
    RUN_TEST(test_a_fault_opens_the_bridge_while_the_position_is_found);
    RUN_TEST(test_initial_position_detection_can_be_ended_at_once);
    RUN_TEST(test_motion_is_refused_until_the_position_is_found);
    RUN_TEST(test_the_rotor_is_in_the_electrical_turn_nearest_to_the_angle_assumed);
    RUN_TEST(test_a_drive_can_be_disabled_from_everywhere);
    RUN_TEST(test_a_disable_flushes_the_moves_before_it);
    RUN_TEST(test_after_disabling_the_drive_can_be_enabled_and_moved_again);
    RUN_TEST(test_an_enable_right_behind_a_disable_still_opens_the_bridge);
    RUN_TEST(test_every_fault_opens_the_bridge_in_the_period_of_its_sample_and_stays);
    RUN_TEST(test_a_fault_while_aligning_opens_the_bridge_too);
    RUN_TEST(test_a_supply_that_is_missing_on_enable_is_a_fault_before_the_bridge_is_on);
    RUN_TEST(test_an_offset_out_of_range_is_a_fault);
    RUN_TEST(test_the_second_stage_of_the_offsets_is_protected_as_operation_is);
    RUN_TEST(test_a_disabled_drive_needs_no_supply);
    RUN_TEST(test_an_estimate_out_of_range_opens_the_bridge_in_the_same_period);
    RUN_TEST(test_no_limit_lets_the_speed_pass_what_the_sampling_can_follow);
    RUN_TEST(test_no_limit_lets_the_speed_pass_what_its_square_can_bear);
#if STEADYSTEP_NUM != NUM_FIXED
    RUN_TEST(test_an_estimate_that_is_not_finite_opens_the_bridge_in_the_same_period);
#endif
    RUN_TEST(test_a_fault_is_cleared_by_disabling_only);
    RUN_TEST(test_moves_follow_one_another_without_waiting_to_be_posted);
    RUN_TEST(test_steps_and_smooth_moves_are_made_too);
    RUN_TEST(test_a_move_begins_with_the_period_it_is_addressed_to);
    RUN_TEST(test_a_stop_brings_the_reference_to_rest_short_of_its_target);
    RUN_TEST(test_a_stop_acts_in_the_period_it_is_addressed_to);
    RUN_TEST(test_a_stop_overtakes_the_moves_that_wait);
    RUN_TEST(test_commands_posted_behind_a_stop_leave_its_ramp_alone);
    RUN_TEST(test_moves_are_refused_while_a_stop_is_under_way_and_accepted_after);
    RUN_TEST(test_after_a_stop_moves_can_be_queued_again);
    RUN_TEST(test_a_stop_cut_off_by_a_disable_does_not_block_later_moves);
    RUN_TEST(test_a_stop_at_rest_is_harmless);
    RUN_TEST(test_a_move_before_the_drive_is_ready_is_refused_and_leaves_no_trace);
    RUN_TEST(test_what_is_legal_when_stands_in_one_table);
    RUN_TEST(test_a_command_is_judged_by_the_state_that_it_will_find);
    RUN_TEST(test_a_command_asked_for_before_the_drive_was_ready_is_refused_behind_it);
    RUN_TEST(test_what_a_fault_keeps_from_acting_is_dropped_in_its_period_and_counted);
    RUN_TEST(test_what_waits_for_the_end_of_a_move_is_dropped_when_a_fault_ends_it);
    RUN_TEST(test_what_is_so_already_or_flushed_is_not_counted);
    RUN_TEST(test_a_move_that_does_not_begin_where_the_reference_is_is_dropped_and_counted);
    RUN_TEST(test_a_hold_command_holds_without_the_delay);
    RUN_TEST(test_the_drive_holds_by_itself_15_ms_after_a_move);
    RUN_TEST(test_a_move_too_fast_is_refused_and_the_next_one_starts_where_the_last_ended);
    RUN_TEST(test_one_command_too_many_is_refused);
    return UNITY_END();
}
