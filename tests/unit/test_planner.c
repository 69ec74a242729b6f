/* Sines, set-points, speeds and new targets: from the command to the reference. */
#include <stddef.h>
#include <string.h>

#include "tests/unit/fake_board.h"
#include "tests/unit/num_assert.h"

#define LEAD_PERIODS 10u /* DRIVE_LEAD_s */

static const double acceleration_rad_s2 = 500.0;
static const double jerk_rad_s3 = 50000.0;

static struct drive drive;
static struct drive_settings settings;
static struct hal_samples samples;
static char error[DRIVE_ERROR_TEXT];
static double largest_jerk; /* of all periods since enable(), rad/s^3, from the exact states */
static uint32_t background_every;

/* One period; the background is called as the application's loop would. */
static void run(uint32_t periods)
{
    const double rad_s3 = drive.base.rad_per_turn / 1e-12;

    for (uint32_t k = 0; k < periods; k++) {
        const double before = motion_to_turns(drive.reference.at.acceleration);

        struct hal_outputs outputs;

        drive_control_cycle(&drive, &samples, &outputs);

        const double jerk = (motion_to_turns(drive.reference.at.acceleration) - before) * rad_s3;

        largest_jerk = jerk > largest_jerk ? jerk : -jerk > largest_jerk ? -jerk : largest_jerk;
        if (drive.supervision.period % background_every == 0u) {
            drive_background(&drive);
        }
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

static void must_refuse(struct drive_command command, const char *text)
{
    TEST_ASSERT_FALSE(post(command));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, text), error);
}

static struct drive_signals signals(void)
{
    struct drive_signals now;

    drive_signals_read(&drive, &now);
    return now;
}

void setUp(void)
{
    drive_settings_default(&settings, &bench_params);
    settings.calibrate_offsets = false;
    settings.hold_on_enable = false;
    settings.synchronism_policy = DRIVE_SYNCHRONISM_OFF; /* the rotor here follows nothing */
    fake_board = (struct fake_board){.trip_latched = false};
    samples = samples_at_rest;
    background_every = 1;
    TEST_ASSERT_TRUE_MESSAGE(drive_init(&drive, &fake_hal, &settings, error), error);
    must_post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE});
    run(2);
    TEST_ASSERT_EQUAL(DRIVE_OPERATION_ENABLED, signals().state);
    largest_jerk = 0.0;
}

void tearDown(void)
{
}

static struct drive_command velocity(double speed_rad_s)
{
    return (struct drive_command){.kind = DRIVE_COMMAND_VELOCITY,
                                  .speed_rad_s = speed_rad_s,
                                  .acceleration_rad_s2 = acceleration_rad_s2,
                                  .jerk_rad_s3 = jerk_rad_s3};
}

static struct drive_command retarget(double position_rad)
{
    return (struct drive_command){.kind = DRIVE_COMMAND_RETARGET,
                                  .position_rad = position_rad,
                                  .speed_rad_s = 2.0,
                                  .acceleration_rad_s2 = acceleration_rad_s2,
                                  .jerk_rad_s3 = jerk_rad_s3};
}

static struct drive_command move_to(double position_rad)
{
    return (struct drive_command){.kind = DRIVE_COMMAND_MOVE_SMOOTH,
                                  .position_rad = position_rad,
                                  .duration_s = 0.05,
                                  .ramp_s = 0.02,
                                  .jerk_s = 0.005};
}

static struct drive_command sine(double cycles, double ramp_s)
{
    return (struct drive_command){.kind = DRIVE_COMMAND_SINE,
                                  .amplitude_rad = 0.02,
                                  .frequency_Hz = 20.0,
                                  .cycles = cycles,
                                  .ramp_s = ramp_s};
}

static struct drive_command set_point(double position_rad)
{
    return (struct drive_command){.kind = DRIVE_COMMAND_SET_POINT,
                                  .position_rad = position_rad,
                                  .interval_s = 1e-3,
                                  .acceleration_rad_s2 = acceleration_rad_s2,
                                  .jerk_rad_s3 = jerk_rad_s3};
}

static void stop_now(void)
{
    must_post((struct drive_command){.kind = DRIVE_COMMAND_STOP});
}

static void run_to_rest(void)
{
    for (uint32_t k = 0; signals().reference_moving || k < LEAD_PERIODS + 3u; k++) {
        run(1);
        TEST_ASSERT_TRUE(k < 10000u);
    }
}

/* The jerk of the sine and of its ramps below. */
static void nothing_jerked_but_the_sine(void)
{
    TEST_ASSERT_TRUE(largest_jerk <= 200000.0);
}

static void nothing_jerked(void)
{
    TEST_ASSERT_TRUE(largest_jerk <= 1.001 * jerk_rad_s3);
}

static void the_reference_is_at(double position_rad)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, position_rad, signals().theta_ref_rad);
}

static void the_speed_is(double speed_rad_s)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, speed_rad_s, signals().omega_ref_rad_s);
}

/* ---- velocity ---- */

static void test_a_speed_begins_in_the_period_it_is_addressed_to(void)
{
    struct drive_command command = velocity(2.0);

    command.at_period = drive.supervision.period + 40u;
    must_post(command);
    run(40);
    TEST_ASSERT_FALSE(signals().reference_moving);
    run(1); /* the reference of this interrupt was that of the one before */
    TEST_ASSERT_TRUE(signals().reference_moving);
    run(300);
    the_speed_is(2.0);
    nothing_jerked();
}

static void test_reversed_in_mid_change_and_stopped_without_a_kink(void)
{
    must_post(velocity(2.0));
    run(70);
    must_post(velocity(-2.0));
    run(45);
    must_post(velocity(1.0));
    run(33);
    stop_now();
    run_to_rest();
    the_speed_is(0.0);
    nothing_jerked();
}

static void test_after_a_stop_of_a_speed_moves_start_where_it_came_to_rest(void)
{
    must_post(velocity(2.0));
    run(200);
    must_refuse(move_to(0.1), "the reference follows a sine, set-points or a speed");
    stop_now();
    must_refuse(move_to(0.1), "has not come to rest after the stop");
    must_refuse(velocity(1.0), "has not come to rest after the stop");
    run_to_rest();
    nothing_jerked();
    must_post(move_to(0.1));
    run_to_rest();
    the_reference_is_at(0.1);
}

static void test_a_stop_flushes_a_speed_that_has_not_begun(void)
{
    struct drive_command command = velocity(2.0);

    command.at_period = drive.supervision.period + 15u;
    must_post(command);
    run(8); /* planned already */
    stop_now();
    run(100);
    TEST_ASSERT_FALSE(signals().reference_moving);
    the_reference_is_at(0.0);
    must_post(velocity(1.0)); /* and nothing is stuck */
    run(200);
    the_speed_is(1.0);
}

static void test_disabling_and_enabling_leaves_nothing_of_a_speed(void)
{
    must_post(velocity(2.0));
    run(100);
    must_post((struct drive_command){.kind = DRIVE_COMMAND_DISABLE});
    run(3);
    must_post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE});
    run(100);
    TEST_ASSERT_EQUAL(DRIVE_OPERATION_ENABLED, signals().state);
    TEST_ASSERT_FALSE(signals().reference_moving);
    must_post(move_to(0.1));
    run_to_rest();
    the_reference_is_at(0.1);
}

/* Its plan comes after the period it was made for: refused by the interrupt, it is made again. */
static void test_a_background_that_is_late_plans_further_ahead(void)
{
    must_post(velocity(2.0));
    run(100);
    must_post(velocity(-2.0));
    drive_background(&drive);
    TEST_ASSERT_NOT_NULL(drive.planner.offered);
    drive.commands.preemption.at_period -= LEAD_PERIODS; /* as if so much time had passed */
    run(2);
    TEST_ASSERT_EQUAL_UINT32(2u * LEAD_PERIODS, drive.planner.lead_periods);
    run(250);
    the_speed_is(-2.0);
    nothing_jerked();
}

/* In motion: offers a plan whose period has gone by before it comes; the interrupt refuses it. */
static void be_late(void)
{
    drive_background(&drive);
    TEST_ASSERT_NOT_NULL(drive.planner.offered);
    drive.commands.preemption.at_period = drive.supervision.period - 1u;
    run(2);
}

static void test_the_lead_grows_to_50_ms_and_is_the_nominal_one_again_after_a_plan_in_time(void)
{
    must_post(velocity(2.0));
    run(250);
    must_post(velocity(-2.0));
    for (int k = 0; k < 8; k++) {
        be_late();
    }
    TEST_ASSERT_EQUAL_UINT32(500, drive.planner.lead_periods);
    run(502);
    TEST_ASSERT_EQUAL_UINT32(LEAD_PERIODS, drive.planner.lead_periods);
    run(250);
    the_speed_is(-2.0);
    nothing_jerked();
}

static void test_a_drive_enabled_anew_plans_with_the_nominal_lead(void)
{
    must_post(velocity(2.0));
    run(250);
    must_post(velocity(-2.0));
    be_late();
    be_late();
    TEST_ASSERT_EQUAL_UINT32(4u * LEAD_PERIODS, drive.planner.lead_periods);
    must_post((struct drive_command){.kind = DRIVE_COMMAND_DISABLE});
    run(3);
    must_post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE});
    run(3);
    TEST_ASSERT_EQUAL_UINT32(LEAD_PERIODS, drive.planner.lead_periods);
}

/* ---- retarget ---- */

static void test_a_new_target_in_mid_move_is_reached_without_a_kink(void)
{
    must_post(move_to(0.08));
    run(150);
    must_post(retarget(-0.05));
    must_post(move_to(0.02)); /* waits for rest, as ever */
    run_to_rest();
    the_reference_is_at(-0.05);
    run(20);
    run_to_rest();
    the_reference_is_at(0.02);
    TEST_ASSERT_TRUE(largest_jerk <= 60000.0);
}

static void test_a_new_target_ends_a_speed_and_a_sine(void)
{
    must_post(velocity(-2.0));
    run(120);
    must_post(retarget(0.04));
    run_to_rest();
    the_reference_is_at(0.04);
    nothing_jerked();
    must_post(sine(0.0, 0.05));
    run(1033);
    must_post(retarget(-0.04));
    run_to_rest();
    the_reference_is_at(-0.04);
    nothing_jerked_but_the_sine();
    TEST_ASSERT_EQUAL_UINT32(0, signals().reference_underruns);
}

/* ---- sine ---- */

static void test_a_sine_swings_about_where_the_reference_rests_and_ends_there(void)
{
    double highest = 0.0;

    must_post(move_to(0.1));
    must_post(sine(5.0, 0.05)); /* waits for rest */
    run(530);
    for (int k = 0; k < 2500; k++) {
        run(1);
        highest = signals().theta_ref_rad > highest ? signals().theta_ref_rad : highest;
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.12, highest);
    TEST_ASSERT_FALSE(signals().reference_moving);
    the_reference_is_at(0.1);
    TEST_ASSERT_EQUAL_UINT32(0, signals().reference_underruns);
    nothing_jerked_but_the_sine();
    must_post(move_to(0.0));
    run_to_rest();
    the_reference_is_at(0.0);
}

static void test_a_sine_stops_without_a_kink(void)
{
    must_post(sine(0.0, 0.05));
    run(3333);
    TEST_ASSERT_TRUE(signals().reference_moving);
    stop_now();
    run_to_rest();
    the_speed_is(0.0);
    nothing_jerked_but_the_sine();
    TEST_ASSERT_EQUAL_UINT32(0, signals().reference_underruns);
}

static void test_a_sine_that_is_not_supplied_comes_to_rest_and_counts_an_underrun(void)
{
    must_post(sine(0.0, 0.05));
    run(1000);
    background_every = UINT32_MAX;
    run(1000);
    TEST_ASSERT_FALSE(signals().reference_moving);
    nothing_jerked_but_the_sine();
    background_every = 1;
    run(1);
    TEST_ASSERT_EQUAL_UINT32(1, signals().reference_underruns);
}

/* ---- set-points ---- */

/* From rest to rest in thirty set-points. */
static double wanted(int i)
{
    const double s = i < 0 ? 0.0 : i > 30 ? 1.0 : (double)i / 30.0;

    return 0.02 * s * s * s * (10.0 + s * (6.0 * s - 15.0));
}

static void test_set_points_are_reached_two_intervals_and_the_lead_after_they_came(void)
{
    for (int i = 1; i <= 34; i++) {
        must_post(set_point(wanted(i)));
        run(2);
        if (i > 3) { /* the one of 30 periods before: 2 x 10 and 10, and it is S(k+1) */
            the_reference_is_at(wanted(i - 3));
        }
        run(8);
    }
    run(50);
    TEST_ASSERT_FALSE(signals().reference_moving);
    the_reference_is_at(0.02);
    TEST_ASSERT_EQUAL_UINT32(0, signals().reference_underruns);
    must_post(move_to(0.0));
    run_to_rest();
    the_reference_is_at(0.0);
}

static void test_set_points_that_run_dry_come_to_rest_and_count_an_underrun(void)
{
    for (int i = 1; i <= 15; i++) {
        must_post(set_point(wanted(i)));
        run(10);
    }
    run(20);
    largest_jerk = 0.0; /* the set-points' own, which end here */
    run_to_rest();
    TEST_ASSERT_EQUAL_UINT32(1, signals().reference_underruns);
    the_speed_is(0.0);
    nothing_jerked();
}

static void test_too_many_set_points_are_refused(void)
{
    for (int i = 1; i <= 15; i++) {
        must_post(set_point(wanted(i)));
    }
    must_refuse(set_point(wanted(16)), "15 set-points are waiting already");
}

/* The set-point of a plan on offer is still needed: the plan is made anew if it is refused. */
static void test_set_points_posted_while_the_first_plan_is_on_offer_overwrite_none(void)
{
    must_post(set_point(wanted(1)));
    must_post(set_point(wanted(2)));
    drive_background(&drive);
    TEST_ASSERT_NOT_NULL(drive.planner.offered);
    for (int i = 3; i <= 15; i++) {
        must_post(set_point(wanted(i)));
    }
    must_refuse(set_point(wanted(16)), "15 set-points are waiting already");
    command_queue_withdraw_preemption(&drive.commands); /* what a refusal leaves */
    drive_background(&drive);
    must_refuse(set_point(wanted(16)), "15 set-points are waiting already");
    run(2u * LEAD_PERIODS + 2u); /* it has begun: there is room again */
    must_post(set_point(wanted(16)));
    for (int i = 17; i <= 34; i++) {
        run(10);
        must_post(set_point(wanted(i)));
    }
    run_to_rest();
    the_reference_is_at(0.02);
    TEST_ASSERT_EQUAL_UINT32(0, signals().reference_underruns);
}

static void test_a_stop_ends_the_stream_of_set_points(void)
{
    for (int i = 1; i <= 10; i++) {
        must_post(set_point(wanted(i)));
        run(10);
    }
    stop_now();
    run_to_rest();
    TEST_ASSERT_EQUAL_UINT32(0, signals().reference_underruns);
    must_post(move_to(0.0));
    run_to_rest();
    the_reference_is_at(0.0);
}

/* ---- refusals ---- */

static void test_what_is_out_of_range_is_refused_with_its_bound(void)
{
    struct drive_command command = velocity(1000.0);

    must_refuse(command, "speed 1000 rad/s: must be at most");
    command = velocity(1.0);
    command.acceleration_rad_s2 = 1e6;
    must_refuse(command, "acceleration 1e+06 rad/s^2: must be at most");
    command = velocity(1.0);
    command.jerk_rad_s3 = 0.0;
    must_refuse(command, "jerk 0 rad/s^3: must be at least");
    command = retarget(1.0);
    command.speed_rad_s = 0.0;
    must_refuse(command, "speed 0 rad/s: must be at least");
    command = sine(1.0, 0.1);
    must_refuse(command, "ramp 0.1 s: must be at most 0.025 s");
    command = sine(1.25, 0.0);
    must_refuse(command, "cycles: must be a whole number or a half");
    command = sine(1.0, 0.0);
    command.frequency_Hz = 600.0;
    must_refuse(command, "frequency 600 Hz: must be at most 500 Hz");
    command.frequency_Hz = 20.0;
    command.amplitude_rad = 2.0;
    must_refuse(command, "of the sine");
    command = set_point(0.0);
    command.interval_s = 1e-4;
    must_refuse(command, "interval");
    must_refuse(set_point(1.0), "set-point refused: the speed");
    run(100);
    TEST_ASSERT_FALSE(signals().reference_moving);
}

/* What is taken at its bound, and what is beyond it by this share of it not. */
static void holds_to(struct drive_command *command, double *quantity, double bound, double beyond,
                     const char *refusal)
{
    const double before = *quantity;
    struct drive_command stop = {.kind = DRIVE_COMMAND_STOP};

    *quantity = bound * (1.0 + beyond);
    must_refuse(*command, refusal);
    *quantity = bound * (1.0 - 1e-3 * beyond);
    TEST_ASSERT_TRUE_MESSAGE(post(*command), error);
    *quantity = before;
    must_post(stop);
    run(2500);
    TEST_ASSERT_FALSE(signals().reference_moving);
}

static const double more = 1e-4, less = -1e-4;

static void test_speeds_are_taken_up_to_their_bounds(void)
{
    const double acceleration = 3.0 * 0.157 / 15.62e-5;
    const double slowest = 2.0 * 131.74 / (1073741824.0 * 1e-4);
    struct drive_command command = velocity(1.0);

    holds_to(&command, &command.acceleration_rad_s2, acceleration, more,
             "acceleration 3015.666 rad/s^2: must be at most 3015.365");
    command = retarget(1.0);
    holds_to(&command, &command.acceleration_rad_s2, acceleration, more, "limit of the drive");
    command.jerk_rad_s3 = 1e9;
    holds_to(&command, &command.acceleration_rad_s2, slowest, 0.01 * less - 0.05,
             "must be at least");
    command = velocity(1.0);
    holds_to(&command, &command.jerk_rad_s3, acceleration_rad_s2 / (131072.0 * 1e-4), less,
             "2^17 control periods to the acceleration");
    command = retarget(1.0);
    for (double sign = -1.0; sign < 2.0; sign += 2.0) {
        command.position_rad = sign * 1e9 * TWO_PI / 50.0;
        must_refuse(command, "2^30 periods to go");
        command.position_rad *= 1.0001;
        must_refuse(command, "range of positions");
    }
    command.position_rad = 1e7;
    holds_to(&command, &command.speed_rad_s, 1e7 / (1073741824.0 * 1e-4), less,
             "2^30 periods to go");
    command.speed_rad_s = -1.0;
    must_refuse(command, "speed -1 rad/s: must be at least");
    command.position_rad = 0.0;
    command.speed_rad_s = 0.0;
    must_refuse(command, "speed 0 rad/s: must be at least 1e-09 rad/s");
}

static void test_sines_are_taken_up_to_their_bounds(void)
{
    const double acceleration = 3.0 * 0.157 / 15.62e-5;
    struct drive_command command = sine(0.0, 0.0);

    holds_to(&command, &command.amplitude_rad, 1e-6, less, "range of amplitudes");
    holds_to(&command, &command.amplitude_rad, -1e-6, less, "range of amplitudes");
    command.frequency_Hz = 1.0;
    holds_to(&command, &command.amplitude_rad, 131.7 / TWO_PI, 0.01, "where the back-EMF");
    command.frequency_Hz = 100.0;
    holds_to(&command, &command.amplitude_rad, acceleration / pow(TWO_PI * 100.0, 2.0), more,
             "acceleration of the sine");
    command.amplitude_rad = 1e-5;
    holds_to(&command, &command.frequency_Hz, 500.0, more, "20 control periods to a cycle");
    holds_to(&command, &command.frequency_Hz, 1e-3, less, "must be at least 0.001 Hz");
    command.frequency_Hz = 500.0;
    command.cycles = 1e9 + 1.0;
    must_refuse(command, "range of cycles");
    command.cycles = -1.0;
    must_refuse(command, "range of cycles");
    command.cycles = 4.0;
    holds_to(&command, &command.ramp_s, 0.5 * 4.0 / 500.0, more, "half of the cycles");
    command.cycles = 0.0;
    holds_to(&command, &command.ramp_s, 1073741824.0 * 1e-4, more, "2^30 control periods");
    command.ramp_s = -1e-3;
    must_refuse(command, "ramp");
}

static void test_set_points_are_taken_up_to_their_bounds(void)
{
    struct drive_command command = set_point(0.0);

    holds_to(&command, &command.interval_s, 2.5e-4, less, "3 to 2^16 control periods");
    holds_to(&command, &command.interval_s, 65536.0 * 1e-4, more, "3 to 2^16 control periods");
    command.interval_s = 1.04e-3;
    must_post(command);
    TEST_ASSERT_EQUAL_UINT32(10, drive.planner.set_points.interval_periods);
}

/* Where it ends is known, whatever was in motion before: a move may wait for it. */
static void test_behind_a_new_target_a_move_may_wait(void)
{
    must_post(velocity(2.0));
    run(300);
    must_refuse(move_to(0.2), "the reference follows a sine, set-points or a speed");
    must_post(retarget(0.1));
    must_post(move_to(0.2));
    run_to_rest();
    run(20);
    run_to_rest();
    the_reference_is_at(0.2);
    TEST_ASSERT_EQUAL_UINT32(0, drive.commands.dropped);
}

/* Of a stop, half a second at most. */
static uint32_t periods_to_rest(void)
{
    uint32_t periods = 0;

    while (periods < 5000u && (drive.planner.stop_due || signals().reference_moving)) {
        run(1);
        periods++;
    }
    return periods;
}

/* Its own jerk is harder than a tenth of a second's. */
static void test_a_fast_sine_stops_as_softly_as_it_swings(void)
{
    struct drive_command command = sine(0.0, 0.0);
    const double w = TWO_PI * 20.0;
    uint32_t periods;

    must_post(command);
    run(3 + LEAD_PERIODS);
    stop_now();
    periods = periods_to_rest();
    /* speed over acceleration, acceleration over jerk */
    TEST_ASSERT_UINT32_WITHIN(60, (uint32_t)(2.0 / w / 1e-4), periods);
}

/* A tenth of a second from its peak speed, and as long again for the jerk. */
static void test_a_slow_sine_stops_sooner_than_it_swings(void)
{
    struct drive_command command = sine(0.0, 0.0);
    uint32_t periods;

    command.frequency_Hz = 0.5;
    must_post(command);
    run(3 + LEAD_PERIODS); /* at its peak speed */
    the_speed_is(0.02 * TWO_PI * 0.5);
    stop_now();
    periods = periods_to_rest();
    TEST_ASSERT_UINT32_WITHIN(10, 2000 + LEAD_PERIODS, periods);
}

/* ---- a drive that starts where its encoder shows the rotor ---- */

static void test_with_a_known_encoder_zero_motion_is_refused_until_the_drive_is_ready(void)
{
    static const char refusal[] = "the drive is being enabled, wait until it is ready";
    const double rotor_rad = 6.283185307179586 * 1000.0 / 16384.0;
    struct hal_facts facts = bench_facts;
    struct hal hal = fake_hal;

    facts.encoder_counts_per_turn = 16384;
    hal.facts = &facts;
    samples.encoder_count = 1000;
    settings.feedback = DRIVE_FEEDBACK_ENCODER;
    settings.encoder_zero_known = true;
    settings.calibrate_offsets = true;
    settings.hold_on_enable = true;
    TEST_ASSERT_TRUE_MESSAGE(drive_init(&drive, &hal, &settings, error), error);
    must_post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE});
    must_refuse(move_to(0.1), refusal);
    must_refuse(set_point(0.0), refusal);
    run(1);
    must_refuse(move_to(0.1), refusal);
    must_refuse((struct drive_command){.kind = DRIVE_COMMAND_STOP}, refusal);
    while (signals().state != DRIVE_OPERATION_ENABLED) {
        must_refuse(retarget(0.1), refusal);
        run(1);
        TEST_ASSERT_TRUE(drive.supervision.period < 10000u);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, rotor_rad, signals().theta_ref_rad);
    must_post(move_to(rotor_rad + 0.1));
    run_to_rest();
    the_reference_is_at(rotor_rad + 0.1);

    must_post((struct drive_command){.kind = DRIVE_COMMAND_DISABLE});
    must_post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE});
    must_refuse(move_to(0.1), refusal); /* the state is still that before the disable */
}

/* 131.7 rad/s: 0.92 of 24 V, over Km and what friction and a default ramp take. */
static void test_no_motion_is_taken_that_the_back_emf_forbids(void)
{
    static const char reason[] =
        "must be at most 131.7 rad/s, where the back-EMF takes up the supply";
    struct drive_command fast_retarget = retarget(100.0);
    struct drive_command fast_move = move_to(100.0);
    struct drive_command fast_sine = sine(10.0, 0.1);
    char error[DRIVE_ERROR_TEXT];

    fast_retarget.speed_rad_s = 141.0;
    fast_move.duration_s = 1.0;
    fast_move.ramp_s = 0.29; /* cruises at 140.8 rad/s */
    fast_sine.amplitude_rad = 141.0 / 6.2831853;
    fast_sine.frequency_Hz = 1.0;
    const struct drive_command beyond[] = {velocity(-141.0), fast_retarget, fast_move, fast_sine};

    for (size_t i = 0; i < sizeof beyond / sizeof beyond[0]; i++) {
        TEST_ASSERT_FALSE(drive_command(&drive, &beyond[i], error));
        TEST_ASSERT_TRUE_MESSAGE(strstr(error, reason) != NULL ||
                                     strstr(error, "must be at least -131.7 rad/s") != NULL,
                                 error);
    }
    must_post(velocity(131.0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_no_motion_is_taken_that_the_back_emf_forbids);
    RUN_TEST(test_a_speed_begins_in_the_period_it_is_addressed_to);
    RUN_TEST(test_reversed_in_mid_change_and_stopped_without_a_kink);
    RUN_TEST(test_after_a_stop_of_a_speed_moves_start_where_it_came_to_rest);
    RUN_TEST(test_a_stop_flushes_a_speed_that_has_not_begun);
    RUN_TEST(test_disabling_and_enabling_leaves_nothing_of_a_speed);
    RUN_TEST(test_a_background_that_is_late_plans_further_ahead);
    RUN_TEST(test_the_lead_grows_to_50_ms_and_is_the_nominal_one_again_after_a_plan_in_time);
    RUN_TEST(test_a_drive_enabled_anew_plans_with_the_nominal_lead);
    RUN_TEST(test_a_new_target_in_mid_move_is_reached_without_a_kink);
    RUN_TEST(test_a_new_target_ends_a_speed_and_a_sine);
    RUN_TEST(test_a_sine_swings_about_where_the_reference_rests_and_ends_there);
    RUN_TEST(test_a_sine_stops_without_a_kink);
    RUN_TEST(test_a_sine_that_is_not_supplied_comes_to_rest_and_counts_an_underrun);
    RUN_TEST(test_set_points_are_reached_two_intervals_and_the_lead_after_they_came);
    RUN_TEST(test_set_points_that_run_dry_come_to_rest_and_count_an_underrun);
    RUN_TEST(test_too_many_set_points_are_refused);
    RUN_TEST(test_set_points_posted_while_the_first_plan_is_on_offer_overwrite_none);
    RUN_TEST(test_a_stop_ends_the_stream_of_set_points);
    RUN_TEST(test_what_is_out_of_range_is_refused_with_its_bound);
    RUN_TEST(test_speeds_are_taken_up_to_their_bounds);
    RUN_TEST(test_sines_are_taken_up_to_their_bounds);
    RUN_TEST(test_set_points_are_taken_up_to_their_bounds);
    RUN_TEST(test_behind_a_new_target_a_move_may_wait);
    RUN_TEST(test_a_fast_sine_stops_as_softly_as_it_swings);
    RUN_TEST(test_a_slow_sine_stops_sooner_than_it_swings);
    RUN_TEST(test_with_a_known_encoder_zero_motion_is_refused_until_the_drive_is_ready);
    return UNITY_END();
}
