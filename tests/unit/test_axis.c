/* Where the axis is: through disable and fault, with its zero set, and at the ends of the range.
   The whole drive on the simulated motor: averaged bridge, converters without noise. */
#include <string.h>

#include "firmware/drive/state_machine.h"
#include "tests/unit/fake_board.h"
#include "tests/unit/num_assert.h"

/* A drive on a motor of its own. */
struct axle {
    struct drive drive;
    struct drive_settings settings;
    struct hal_facts facts;
    struct hal board;
    struct bench_motor motor;
    struct hal_outputs in_force;
    struct bench_vector mean_V; /* over the past period */
    uint32_t flags;             /* of the board, in the next samples */
    bool held;                  /* the rotor, by something outside */
};

static struct axle one;
static struct axle other;
static char error[DRIVE_ERROR_TEXT];

void setUp(void)
{
    fake_board = (struct fake_board){.trip_latched = false};
}

void tearDown(void)
{
}

static void no_watchdog(void *context)
{
    (void)context;
}

static void power_up(struct axle *axle, bool encoder)
{
    memset(axle, 0, sizeof *axle);
    axle->motor.motor = bench_params;
    axle->facts = bench_facts;
    axle->board = fake_hal;
    axle->board.facts = &axle->facts;
    axle->board.watchdog_feed = no_watchdog;
    drive_settings_default(&axle->settings, &bench_params);
    axle->settings.hold_on_enable_s = 0.03;
    axle->settings.balance_phases = false;
    axle->settings.calibrate_offsets = false;
    if (encoder) {
        axle->facts.encoder_counts_per_turn = 4000;
        drive_settings_select_feedback(&axle->settings, DRIVE_FEEDBACK_ENCODER);
    }
    TEST_ASSERT_TRUE_MESSAGE(drive_init(&axle->drive, &axle->board, &axle->settings, error), error);
}

static uint16_t code_of(double current_A)
{
    return (uint16_t)floor(2048.5 + current_A / bench_facts.current_A_per_code);
}

static struct hal_samples sample(const struct axle *axle)
{
    const struct bench_motor *motor = &axle->motor;

    return (struct hal_samples){
        .encoder_count = (int32_t)floor(motor->angle_rad / TWO_PI * 4000.0),
        .flags = (uint8_t)axle->flags,
        .current_a = code_of(motor->i_a),
        .current_b = code_of(motor->i_b),
        .bus_voltage = samples_at_rest.bus_voltage,
        .phase_voltage_a =
            (int16_t)floor(0.5 + axle->mean_V.a / bench_facts.phase_voltage_V_per_code),
        .phase_voltage_b =
            (int16_t)floor(0.5 + axle->mean_V.b / bench_facts.phase_voltage_V_per_code),
    };
}

static void turn_motor(struct axle *axle)
{
    const uint16_t *high = axle->in_force.high_counts;
    const double angle_rad = axle->motor.angle_rad;

    if (axle->in_force.bridge_on) {
        axle->mean_V.a = 24.0 * ((double)high[0] - (double)high[1]) / 8500.0;
        axle->mean_V.b = 24.0 * ((double)high[2] - (double)high[3]) / 8500.0;
        bench_run(&axle->motor, axle->mean_V.a, axle->mean_V.b);
    } else {
        axle->mean_V = (struct bench_vector){0.0, 0.0};
        axle->motor.i_a = 0.0;
        axle->motor.i_b = 0.0;
        axle->motor.angle_rad += axle->motor.speed_rad_s * PERIOD_S;
    }
    if (axle->held) {
        axle->motor.angle_rad = angle_rad;
        axle->motor.speed_rad_s = 0.0;
    }
}

static void run(struct axle *axle, int periods)
{
    for (int k = 0; k < periods; k++) {
        const struct hal_samples samples = sample(axle);
        struct hal_outputs next;

        drive_background(&axle->drive);
        drive_control_cycle(&axle->drive, &samples, &next);
        turn_motor(axle);
        axle->in_force = next;
        axle->flags = 0u;
    }
}

static void post(struct axle *axle, struct drive_command command)
{
    TEST_ASSERT_TRUE_MESSAGE(drive_command(&axle->drive, &command, error), error);
}

static void post_kind(struct axle *axle, enum drive_command_kind kind)
{
    post(axle, (struct drive_command){.kind = kind});
}

static struct drive_command set_position(double position_rad)
{
    return (struct drive_command){.kind = DRIVE_COMMAND_SET_POSITION, .position_rad = position_rad};
}

static void must_refuse(struct axle *axle, struct drive_command command, const char *reason)
{
    TEST_ASSERT_FALSE(drive_command(&axle->drive, &command, error));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, reason), error);
}

static struct drive_signals signals(const struct axle *axle)
{
    struct drive_signals now;

    drive_signals_read(&axle->drive, &now);
    return now;
}

static void enable(struct axle *axle)
{
    post_kind(axle, DRIVE_COMMAND_ENABLE);
    run(axle, 2);
    while (signals(axle).state != DRIVE_OPERATION_ENABLED) {
        TEST_ASSERT_NOT_EQUAL(DRIVE_FAULT, signals(axle).state);
        run(axle, 1);
    }
}

static void disable(struct axle *axle)
{
    post_kind(axle, DRIVE_COMMAND_DISABLE);
    run(axle, 2);
    axle->motor.speed_rad_s = 0.0; /* friction, which this motor has not */
    TEST_ASSERT_EQUAL(DRIVE_SWITCH_ON_DISABLED, signals(axle).state);
}

static struct drive_command move_to(double position_rad)
{
    return (struct drive_command){.kind = DRIVE_COMMAND_MOVE_TRAPEZOID,
                                  .position_rad = position_rad,
                                  .duration_s = 0.1,
                                  .ramp_s = 0.04};
}

static void move(struct axle *axle, double position_rad)
{
    post(axle, move_to(position_rad));
    run(axle, 1600);
}

static struct drive_command velocity(double speed_rad_s)
{
    return (struct drive_command){.kind = DRIVE_COMMAND_VELOCITY,
                                  .speed_rad_s = speed_rad_s,
                                  .acceleration_rad_s2 = 500.0,
                                  .jerk_rad_s3 = 1e5};
}

static struct drive_command retarget(double position_rad)
{
    return (struct drive_command){.kind = DRIVE_COMMAND_RETARGET,
                                  .position_rad = position_rad,
                                  .speed_rad_s = 10.0,
                                  .acceleration_rad_s2 = 500.0,
                                  .jerk_rad_s3 = 1e5};
}

static void the_reference_is_at(double position_rad, const struct axle *axle)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, position_rad, signals(axle).theta_ref_rad);
}

static void the_rotor_is_at(double angle_rad, const struct axle *axle)
{
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, angle_rad, axle->motor.angle_rad);
}

static void the_position_is(const char *name, const struct axle *axle)
{
    TEST_ASSERT_EQUAL_STRING(name, drive_position_reference_name(signals(axle).position_reference));
}

/* ---- kept ---- */

static void test_a_disable_at_rest_keeps_the_position(void)
{
    for (int encoder = 0; encoder < 2; encoder++) {
        power_up(&one, encoder != 0);
        enable(&one);
        move(&one, 1.0053);
        const double stood_rad = one.motor.angle_rad;
        const double known_to_rad = encoder != 0 ? TWO_PI / 4000.0 : 1e-3; /* a count */

        disable(&one);
        run(&one, 100);
        enable(&one);
        TEST_ASSERT_DOUBLE_WITHIN(known_to_rad, 1.0053, signals(&one).theta_ref_rad);
        TEST_ASSERT_DOUBLE_WITHIN(known_to_rad, stood_rad, one.motor.angle_rad);
        move(&one, 2.0);
        the_rotor_is_at(2.0, &one);
        the_position_is("assumed", &one);
    }
}

static void test_so_does_a_fault_of_the_board_at_rest(void)
{
    power_up(&one, false);
    enable(&one);
    move(&one, 1.0053);
    one.flags = HAL_FLAG_OVERCURRENT_TRIP;
    run(&one, 2);
    TEST_ASSERT_EQUAL(DRIVE_FAULT_HARDWARE_OVERCURRENT, signals(&one).fault);
    disable(&one);
    enable(&one);
    the_reference_is_at(1.0053, &one);
    move(&one, 2.0);
    the_rotor_is_at(2.0, &one);
    the_position_is("assumed", &one);
}

static void test_without_an_encoder_a_reference_is_kept_unseen_with_one_it_stays(void)
{
    for (int encoder = 0; encoder < 2; encoder++) {
        power_up(&one, encoder != 0);
        enable(&one);
        post(&one, set_position(7.0));
        run(&one, 2);
        the_position_is("referenced", &one);
        disable(&one);
        the_position_is(encoder != 0 ? "referenced" : "kept", &one);
        enable(&one);
        the_position_is(encoder != 0 ? "referenced" : "kept", &one);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 7.0, signals(&one).theta_ref_rad);
    }
}

/* The rotor coasts, and nobody sees it. */
static void test_without_an_encoder_a_disable_in_motion_leaves_the_position_uncertain(void)
{
    power_up(&one, false);
    enable(&one);
    post(&one, set_position(3.0));
    run(&one, 2);
    post(&one, velocity(10.0));
    run(&one, 1000);
    disable(&one);
    const double last_rad = signals(&one).theta_est_rad;

    TEST_ASSERT_DOUBLE_WITHIN(0.01, one.motor.angle_rad + 3.0, last_rad);
    the_position_is("uncertain", &one);
    one.motor.speed_rad_s = 0.0;
    enable(&one);
    the_position_is("uncertain", &one);
    the_reference_is_at(last_rad, &one);
    post(&one, set_position(0.0));
    run(&one, 2);
    the_position_is("referenced", &one);
}

/* A step's reference rests at once, its rotor does not. */
static void test_a_reference_at_rest_does_not_vouch_for_a_rotor_on_its_way(void)
{
    power_up(&one, false);
    enable(&one);
    post(&one, (struct drive_command){.kind = DRIVE_COMMAND_STEP, .position_rad = 1.0});
    run(&one, 100);
    disable(&one);
    the_position_is("uncertain", &one);
}

/* Beside it by more than the hold draws back in any case, or too fast to stop within that. */
static void test_a_rotor_beside_its_reference_or_passing_it_is_not_kept(void)
{
    for (int passing = 0; passing < 2; passing++) {
        power_up(&one, false);
        enable(&one);
        struct rotor *rotor = &one.drive.estimator.estimate.rotor;

        if (passing != 0) {
            rotor->speed = 2 * one.drive.params.hold.speed_limit;
        } else {
            rotor->position.fraction += 0x50000000u;
        }
        post_kind(&one, DRIVE_COMMAND_DISABLE);
        run(&one, 1);
        the_position_is("uncertain", &one);
    }
}

static void test_a_rotor_that_is_lost_leaves_the_position_uncertain(void)
{
    power_up(&one, false);
    enable(&one);
    post(&one, set_position(3.0));
    run(&one, 2);
    one.held = true;
    post(&one, move_to(4.0));
    run(&one, 3000);
    TEST_ASSERT_EQUAL(DRIVE_FAULT, signals(&one).state);
    the_position_is("uncertain", &one);
    disable(&one);
    the_position_is("uncertain", &one);
}

static void test_a_warning_of_a_lost_rotor_does_so_at_once(void)
{
    power_up(&one, false);
    one.settings.synchronism_policy = DRIVE_SYNCHRONISM_WARN;
    TEST_ASSERT_TRUE(drive_init(&one.drive, &one.board, &one.settings, error));
    enable(&one);
    one.held = true;
    post(&one, move_to(1.0));
    run(&one, 3000);
    TEST_ASSERT_EQUAL(DRIVE_OPERATION_ENABLED, signals(&one).state);
    the_position_is("uncertain", &one);
}

/* ---- an encoder counts on ---- */

static void turn_by_hand(struct axle *axle, double speed_rad_s, int periods)
{
    axle->motor.speed_rad_s = speed_rad_s;
    run(axle, periods);
    axle->motor.speed_rad_s = 0.0;
    run(axle, 2);
}

static void test_an_encoder_sees_a_rotor_that_is_turned_while_disabled(void)
{
    power_up(&one, true);
    enable(&one);
    move(&one, 1.0);
    disable(&one);
    for (int there = 0; there < 2; there++) {
        turn_by_hand(&one, there == 0 ? 6.0 : -4.0, 5000); /* 24 electrical turns; 16 back */
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, one.motor.angle_rad, signals(&one).theta_est_rad);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, one.motor.angle_rad, signals(&one).theta_ref_rad);
        enable(&one);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, one.motor.angle_rad, signals(&one).theta_ref_rad);
        move(&one, 3.0);
        the_rotor_is_at(3.0, &one);
        disable(&one);
    }
}

/* Its zero is known by then: the rotor need not be led over an electrical turn. */
static void test_an_encoder_is_aligned_once(void)
{
    power_up(&one, true);
    enable(&one);
    const uint32_t first = signals(&one).period;

    TEST_ASSERT_GREATER_THAN(3000, first);
    disable(&one);
    const uint32_t disabled_in = signals(&one).period;

    enable(&one);
    TEST_ASSERT_LESS_THAN(400, signals(&one).period - disabled_in);
}

/* What does not follow its reference may be an encoder that does not count. */
static void test_a_following_error_leaves_an_encoder_to_be_aligned_anew(void)
{
    power_up(&one, true);
    enable(&one);
    post(&one, set_position(3.0));
    run(&one, 2);
    one.held = true;
    post(&one, move_to(4.0));
    run(&one, 2000);
    TEST_ASSERT_EQUAL(DRIVE_FAULT_FOLLOWING_ERROR, signals(&one).fault);
    one.held = false;
    disable(&one);
    the_position_is("uncertain", &one);
    const uint32_t disabled_in = signals(&one).period;

    enable(&one);
    TEST_ASSERT_GREATER_THAN(3000, signals(&one).period - disabled_in);
    the_position_is("uncertain", &one);
}

/* Asked for by the background, as the watches do, of a drive at rest that has been homed. */
static const char *position_behind(enum drive_fault fault, bool encoder)
{
    power_up(&one, encoder);
    enable(&one);
    post(&one, set_position(3.0));
    run(&one, 2);
    state_machine_ask_for_fault(&one.drive, fault);
    run(&one, 2);
    TEST_ASSERT_EQUAL(fault, signals(&one).fault);
    disable(&one);
    return drive_position_reference_name(signals(&one).position_reference);
}

static void test_heat_says_nothing_of_the_rotor(void)
{
    TEST_ASSERT_EQUAL_STRING("kept", position_behind(DRIVE_FAULT_MOTOR_OVERHEATED, false));
    TEST_ASSERT_EQUAL_STRING("kept", position_behind(DRIVE_FAULT_BRIDGE_OVERHEATED, false));
    TEST_ASSERT_EQUAL_STRING("referenced", position_behind(DRIVE_FAULT_MOTOR_OVERHEATED, true));
}

static void test_a_broken_lead_says_nothing_of_what_an_encoder_counts(void)
{
    TEST_ASSERT_EQUAL_STRING("uncertain", position_behind(DRIVE_FAULT_OPEN_PHASE_A, false));
    TEST_ASSERT_EQUAL_STRING("referenced", position_behind(DRIVE_FAULT_OPEN_PHASE_A, true));
}

static void test_an_encoder_that_stands_still_is_aligned_anew(void)
{
    TEST_ASSERT_EQUAL_STRING("uncertain", position_behind(DRIVE_FAULT_ENCODER, true));
    TEST_ASSERT_FALSE(one.drive.axis.aligned);
}

static void test_a_disable_within_the_search_does_not_take_it_for_done(void)
{
    power_up(&one, true);
    post_kind(&one, DRIVE_COMMAND_ENABLE);
    run(&one, 2000);
    TEST_ASSERT_TRUE(one.drive.supervision.aligns);
    disable(&one);
    turn_by_hand(&one, 3.0, 100);
    TEST_ASSERT_EQUAL(0, one.drive.reference.next.position.turns);
    post_kind(&one, DRIVE_COMMAND_ENABLE);
    run(&one, 4);
    TEST_ASSERT_TRUE(one.drive.supervision.aligns);
}

/* ---- settings ---- */

static void test_a_setting_of_the_zero_begins_anew_and_no_other_does(void)
{
    power_up(&one, false);
    enable(&one);
    move(&one, 1.0);
    post(&one, set_position(7.0));
    run(&one, 2);
    disable(&one);
    one.settings.hold_current_A = 2.0;
    TEST_ASSERT_TRUE(drive_design(&one.drive, &one.settings, error));
    enable(&one);
    the_reference_is_at(7.0, &one);
    disable(&one);
    one.settings.initial_angle_rad = 1.0;
    TEST_ASSERT_TRUE(drive_design(&one.drive, &one.settings, error));
    the_position_is("assumed", &one);
    enable(&one);
    the_reference_is_at(1.0, &one);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, signals(&one).motor_zero_rad);
}

/* ---- set-position ---- */

/* At any position, not only whole electrical turns away; the currents do not notice. */
static void test_no_bit_of_the_duties_depends_on_the_zero(void)
{
    for (int encoder = 0; encoder < 2; encoder++) {
        power_up(&one, encoder != 0);
        power_up(&other, encoder != 0);
        enable(&one);
        enable(&other);
        post(&one, set_position(0.0));
        post(&other, set_position(-1234.5678));
        for (int k = 0; k < 4000; k++) {
            if (k == 500) {
                post(&one, velocity(20.0));
                post(&other, velocity(20.0));
            } else if (k == 2500) {
                post_kind(&one, DRIVE_COMMAND_STOP);
                post_kind(&other, DRIVE_COMMAND_STOP);
            }
            run(&one, 1);
            run(&other, 1);
            TEST_ASSERT_EQUAL_MEMORY(&one.in_force, &other.in_force, sizeof one.in_force);
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, signals(&one).theta_ref_rad - 1234.5678,
                                  signals(&other).theta_ref_rad);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, signals(&one).theta_est_rad - 1234.5678,
                                  signals(&other).theta_est_rad);
        TEST_ASSERT_TRUE(one.motor.angle_rad > 3.0);
    }
}

static void test_all_that_is_commanded_is_in_the_new_coordinates(void)
{
    power_up(&one, false);
    enable(&one);
    move(&one, 0.5);
    post(&one, set_position(100.0));
    post(&one, move_to(101.0)); /* behind it, before it has acted */
    run(&one, 1600);
    the_reference_is_at(101.0, &one);
    the_rotor_is_at(1.5, &one);
    post(&one, retarget(100.25));
    run(&one, 5000);
    the_reference_is_at(100.25, &one);
    the_rotor_is_at(0.75, &one);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 100.25, drive_planned_end_rad(&one.drive));
    for (int i = 0; i < 3; i++) {
        post(&one, (struct drive_command){.kind = DRIVE_COMMAND_SET_POINT,
                                          .position_rad = 100.26,
                                          .interval_s = 0.01,
                                          .acceleration_rad_s2 = 500.0,
                                          .jerk_rad_s3 = 1e5});
    }
    run(&one, 2000);
    the_reference_is_at(100.26, &one);
}

static void test_in_motion_in_fault_and_behind_a_command_it_is_refused(void)
{
    power_up(&one, false);
    enable(&one);
    post(&one, move_to(1.0));
    must_refuse(&one, set_position(0.0),
                "set-position refused: the reference moves, or a command "
                "waits; stop, and wait for rest");
    run(&one, 300);
    must_refuse(&one, set_position(0.0), "set-position refused: the reference moves");
    run(&one, 1600);
    must_refuse(&one, set_position(1.3e8), "position 1.3e+08 rad: must be at most");
    post(&one, set_position(0.0));
    run(&one, 2);
    the_reference_is_at(0.0, &one);
    one.flags = HAL_FLAG_OVERCURRENT_TRIP;
    run(&one, 2);
    must_refuse(&one, set_position(1.0), "set-position refused: the drive is in fault");
    post_kind(&one, DRIVE_COMMAND_DISABLE);
    post(&one, set_position(1.0)); /* acts behind it */
    run(&one, 3);
    the_reference_is_at(1.0, &one);
    post_kind(&one, DRIVE_COMMAND_ENABLE);
    must_refuse(&one, set_position(1.0), "set-position refused: the drive is being enabled");
}

static void test_a_fault_drops_it_like_any_command(void)
{
    struct drive_command late = set_position(6.0);

    power_up(&one, false);
    enable(&one);
    late.at_period = signals(&one).period + 20u;
    post(&one, late);
    one.flags = HAL_FLAG_OVERCURRENT_TRIP;
    run(&one, 30);
    TEST_ASSERT_EQUAL_UINT32(1, signals(&one).commands_dropped);
    TEST_ASSERT_EQUAL(DRIVE_COMMAND_SET_POSITION, signals(&one).dropped_kind);
    the_reference_is_at(0.0, &one);
    disable(&one);
    enable(&one);
    move(&one, 0.5); /* not planned from 6 */
    the_rotor_is_at(0.5, &one);
}

/* An absolute encoder that has not been enabled shows nothing yet, but counts. */
static void test_an_absolute_encoder_is_referenced_and_set_where_it_stands(void)
{
    power_up(&one, true);
    one.settings.encoder_zero_known = true;
    TEST_ASSERT_TRUE(drive_init(&one.drive, &one.board, &one.settings, error));
    the_position_is("referenced", &one);
    one.motor.angle_rad = 2.0;
    run(&one, 1);
    post(&one, set_position(10.0));
    run(&one, 2);
    the_reference_is_at(10.0, &one);
    one.motor.angle_rad = 2.5;
    enable(&one);
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, 10.5, signals(&one).theta_ref_rad);
    the_position_is("referenced", &one);
}

/* ---- the ends of the range ---- */

/* Two electrical turns before the positions go round. */
static void begin_at_the_end(struct axle *axle, bool encoder)
{
    const struct position end = {INT32_MAX - 2, 0};

    power_up(axle, encoder);
    encoder_set(&axle->drive.axis.encoder, end, 0);
    axle->drive.axis.counts = encoder;
    axle->drive.axis.aligned = encoder;
    reference_reset(&axle->drive.reference, end);
}

static void test_a_speed_goes_on_where_positions_go_round(void)
{
    for (int encoder = 0; encoder < 2; encoder++) {
        begin_at_the_end(&one, encoder != 0);
        power_up(&other, encoder != 0);
        encoder_set(&other.drive.axis.encoder, (struct position){0, 0}, 0);
        other.drive.axis.counts = encoder != 0;
        other.drive.axis.aligned = encoder != 0;
        enable(&one);
        enable(&other);
        post(&one, velocity(20.0));
        post(&other, velocity(20.0));
        for (int k = 0; k < 2000; k++) {
            run(&one, 1);
            run(&other, 1);
            TEST_ASSERT_EQUAL_MEMORY(&one.in_force, &other.in_force, sizeof one.in_force);
        }
        TEST_ASSERT_EQUAL(DRIVE_OPERATION_ENABLED, signals(&one).state);
        TEST_ASSERT_TRUE(signals(&one).theta_ref_rad < -2.6e8);
        TEST_ASSERT_TRUE(signals(&one).theta_est_rad < -2.6e8);
    }
}

static void test_beyond_the_range_of_moves_the_zero_must_be_set_first(void)
{
    begin_at_the_end(&one, false);
    enable(&one);
    must_refuse(&one, move_to(1.2e8),
                "move refused: the present position 2.699e+08 rad: must be at most");
    must_refuse(&one, retarget(1.2e8),
                "move refused: the present position 2.699e+08 rad: must be at most");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, "set-position"), error);
    post(&one, set_position(0.5));
    run(&one, 2);
    move(&one, 1.0);
    the_reference_is_at(1.0, &one);
    the_rotor_is_at(0.5, &one);
    move(&one, -0.5); /* and back over the end of the motor's turns */
    the_rotor_is_at(-1.0, &one);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_disable_at_rest_keeps_the_position);
    RUN_TEST(test_so_does_a_fault_of_the_board_at_rest);
    RUN_TEST(test_without_an_encoder_a_reference_is_kept_unseen_with_one_it_stays);
    RUN_TEST(test_without_an_encoder_a_disable_in_motion_leaves_the_position_uncertain);
    RUN_TEST(test_a_reference_at_rest_does_not_vouch_for_a_rotor_on_its_way);
    RUN_TEST(test_a_rotor_beside_its_reference_or_passing_it_is_not_kept);
    RUN_TEST(test_a_rotor_that_is_lost_leaves_the_position_uncertain);
    RUN_TEST(test_a_warning_of_a_lost_rotor_does_so_at_once);
    RUN_TEST(test_an_encoder_sees_a_rotor_that_is_turned_while_disabled);
    RUN_TEST(test_an_encoder_is_aligned_once);
    RUN_TEST(test_a_following_error_leaves_an_encoder_to_be_aligned_anew);
    RUN_TEST(test_heat_says_nothing_of_the_rotor);
    RUN_TEST(test_a_broken_lead_says_nothing_of_what_an_encoder_counts);
    RUN_TEST(test_an_encoder_that_stands_still_is_aligned_anew);
    RUN_TEST(test_a_disable_within_the_search_does_not_take_it_for_done);
    RUN_TEST(test_a_setting_of_the_zero_begins_anew_and_no_other_does);
    RUN_TEST(test_no_bit_of_the_duties_depends_on_the_zero);
    RUN_TEST(test_all_that_is_commanded_is_in_the_new_coordinates);
    RUN_TEST(test_in_motion_in_fault_and_behind_a_command_it_is_refused);
    RUN_TEST(test_a_fault_drops_it_like_any_command);
    RUN_TEST(test_an_absolute_encoder_is_referenced_and_set_where_it_stands);
    RUN_TEST(test_a_speed_goes_on_where_positions_go_round);
    RUN_TEST(test_beyond_the_range_of_moves_the_zero_must_be_set_first);
    return UNITY_END();
}
