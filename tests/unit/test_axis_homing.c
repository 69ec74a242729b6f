/* Homing on a hard stop, of a drive that is shown where its rotor is and what bears on it; and on
   the index of its encoder, which the test turns. */
#include "firmware/link/axis_homing.h"
#include "firmware/link/axis_motion.h"
#include "tests/unit/link_bench.h"

enum { TURN = 65536, REACHED = 0x0400, ATTAINED = 0x1000, FAILED = 0x2000, ALL = 0x3400 };

static const double unit_rad = TWO_PI / TURN;

static double load_Nm, rotor_rad;

void setUp(void)
{
    struct drive_settings settings = bench_quick_settings();

    settings.resistance_adaptation = false; /* no current flows */
    link_bench_start_drive(&settings);
    link_bench_open();
    (void)link_bench_say("t00020101", 1);
    load_Nm = 0.0;
    rotor_rad = 0.0;
}

void tearDown(void)
{
}

static void put(unsigned index, unsigned sub, unsigned bytes, uint32_t value)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(index, sub, bytes, value));
}

static uint32_t status(void)
{
    return link_bench_get(0x6041, 0) & ALL;
}

static const struct axis_homing *homing(void)
{
    return &bench_link.axis.motion.homing;
}

/* Where the stop is taken to be, of the axis. */
static double place_rad(void)
{
    return homing()->began_rad + (double)(homing()->way * homing()->place *
                                          axis_homing_full_step_rad(&bench.application));
}

/* Where the motor's zero is, of the axis. */
static double zero_rad(void)
{
    struct drive_signals now;

    drive_signals_read(&bench.application.drive, &now);
    return now.motor_zero_rad;
}

static double rated_Nm(void)
{
    const struct motor_params *motor = &bench.application.drive.settings.motor;

    return motor->rated_current_A * motor->torque_constant_Nm_A;
}

static double full_step_rad(void)
{
    return TWO_PI / 4.0 / bench.application.drive.settings.motor.rotor_teeth;
}

static void enable(int method)
{
    put(0x6060, 0, 1, 6);
    put(0x6098, 0, 1, (uint32_t)method & 0xffu);
    put(0x6040, 0, 2, 0x06);
    bench_periods(20);
    put(0x6040, 0, 2, 0x0f);
    bench_periods(20);
    TEST_ASSERT_EQUAL_HEX32(REACHED, status());
}

static void begin(int method)
{
    enable(method);
    put(0x6040, 0, 2, 0x1f);
    bench_periods(30);
}

/* A period in which the link is shown a rotor at `rotor_rad` that bears `load_Nm`. */
static void period(bool follows)
{
    struct drive *drive = &bench.application.drive;
    struct cia402 *axis = &bench_link.axis;

    if (drive->supervision.asked_for != 0u) { /* to catch it */
        drive->estimator.estimate.next.position = position_minus(
            position_from_rad(rotor_rad, drive->settings.motor.rotor_teeth), drive->axis.offset);
    }
    (void)bench_interrupt();
    drive_signals_read(&bench.application.drive, &axis->signals);
    axis->signals_in = bench.application.drive.supervision.period;
    rotor_rad = follows ? axis->signals.theta_ref_rad : rotor_rad;
    axis->signals.theta_est_rad = rotor_rad;
    axis->signals.load_torque_est_Nm = load_Nm;
    application_background(&bench.application);
}

/* The rotor stands, or follows, for so many milliseconds. */
static void look(int times)
{
    for (int i = 0; i < 10 * times; i++) {
        period(false);
    }
}

static void follow(int times)
{
    for (int i = 0; i < 10 * times; i++) {
        period(true);
    }
}

/* Bears a share of the torque that is a stop's, in that direction. */
static void bear(double way, double share)
{
    load_Nm = way * share * 0.7 * rated_Nm();
}

/* ---- statements ---- */

static void test_it_goes_at_the_homing_speed_down_and_up(void)
{
    put(0x6099, 1, 4, TURN / 8);
    begin(-1);
    follow(30);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -TWO_PI / 8, link_bench_speed_rad_s());
    TEST_ASSERT_EQUAL_HEX32(0, status());
    put(0x6040, 0, 2, 0x0f);
    look(100);
    TEST_ASSERT_EQUAL_HEX32(REACHED, status()); /* interrupted */
    put(0x6098, 0, 1, 0xfe);
    put(0x6040, 0, 2, 0x1f);
    follow(60);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, TWO_PI / 8, link_bench_speed_rad_s());
}

static double motion_current_A(void)
{
    struct drive *drive = &bench.application.drive;

    return num_to_double(drive->hold.motion_current) * drive->base.current_A;
}

/* It would hold the rotor where a wrong estimate has it, with the torque of a stop. */
static void test_it_looks_for_a_stop_without_a_d_current(void)
{
    struct drive_settings settings = link_bench_settings(DRIVE_FEEDBACK_SENSORLESS);
    const struct hal board = bench_board(&bench_facts);

    settings.motion_current_A = 0.8;
    link_bench_start_with(&board, &settings);
    link_bench_open();
    (void)link_bench_say("t00020101", 1);
    begin(-1);
    follow(10);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, motion_current_A());
    bear(-1.0, 1.1);
    look(100);
    TEST_ASSERT_NOT_EQUAL(HOMING_SEEKS_STOP, homing()->phase);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, motion_current_A()); /* it will come again */
    put(0x6040, 0, 2, 0x00);                                  /* whatever ends it */
    look(20);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.8, motion_current_A());
}

static void test_a_polarity_turns_it_round(void)
{
    put(0x607e, 0, 1, 0x80);
    begin(-1);
    follow(30);
    TEST_ASSERT_TRUE(link_bench_speed_rad_s() > 0.5);
}

/* A period of a rotor that follows up to a stop, which bears so much more of the torque as the
   reference has gone on. */
static void strike(double way, double stop_rad)
{
    const double beyond_rad = way * (link_bench_reference_rad() - stop_rad);

    rotor_rad = beyond_rad > 0.0 ? stop_rad : link_bench_reference_rad();
    bear(way, beyond_rad > 0.0 ? 1.1 : 0.0);
    period(false);
}

static void strike_until(double way, double stop_rad, enum homing_phase phase)
{
    for (int i = 0; i < 200000 && homing()->phase != (uint8_t)phase; i++) {
        strike(way, stop_rad);
    }
    TEST_ASSERT_EQUAL(phase, homing()->phase);
}

static void finds_a_stop(int method, double way, uint32_t polarity)
{
    put(0x607e, 0, 1, polarity);
    put(0x607c, 0, 4, 1000);
    begin(method);
    const double stop_rad = way * 10.0 * full_step_rad();

    strike_until(way, stop_rad, HOMING_CATCHES);
    TEST_ASSERT_EQUAL(1, homing()->touches);
    TEST_ASSERT_EQUAL_HEX32(0, status());
    strike_until(way, stop_rad, HOMING_SEEKS_STOP);
    strike_until(way, stop_rad, HOMING_BACKS_OFF);
    TEST_ASSERT_EQUAL(2, homing()->touches);
    TEST_ASSERT_EQUAL(0, homing()->failures);
    strike_until(way, stop_rad, HOMING_ENDED);
    strike(way, stop_rad);
    look(2);
    const double offset_rad = (polarity != 0u ? -1000.0 : 1000.0) * unit_rad;

    TEST_ASSERT_EQUAL_HEX32(REACHED | ATTAINED, status());
    TEST_ASSERT_DOUBLE_WITHIN(0.2 * full_step_rad(), offset_rad - way * full_step_rad(),
                              link_bench_reference_rad());
    TEST_ASSERT_DOUBLE_WITHIN(0.2 * full_step_rad(), stop_rad, offset_rad - zero_rad());
}

static void test_a_stop_above_is_where_the_offset_says(void)
{
    finds_a_stop(-2, 1.0, 0);
}

static void test_a_stop_below_is_where_the_offset_says(void)
{
    finds_a_stop(-1, -1.0, 0);
}

static void test_a_stop_of_an_axis_that_is_turned_round(void)
{
    finds_a_stop(-1, 1.0, 0x80);
}

static void test_a_load_below_the_torque_is_no_stop(void)
{
    begin(-2);
    follow(50);
    bear(1.0, 0.97);
    look(30); /* stands, too */
    TEST_ASSERT_EQUAL(HOMING_SEEKS_STOP, homing()->phase);
}

static void test_a_load_along_the_motion_is_no_stop(void)
{
    begin(-2);
    follow(50);
    bear(-1.0, 1.3);
    look(30);
    TEST_ASSERT_EQUAL(HOMING_SEEKS_STOP, homing()->phase);
}

static void test_one_look_is_no_stop(void)
{
    put(0x6099, 1, 4, 2 * TURN); /* more than the quarter of a step in a millisecond */
    begin(-2);
    follow(50);
    for (int i = 0; i < 20; i++) {
        bear(1.0, 1.2);
        look(1);
        bear(1.0, 0.5);
        look(1);
    }
    TEST_ASSERT_EQUAL(HOMING_SEEKS_STOP, homing()->phase);
}

/* Slowly, and most of the way. */
static void test_a_load_that_the_rotor_carries_along_is_no_stop(void)
{
    put(0x6099, 1, 4, (uint32_t)(2.0 * full_step_rad() / unit_rad)); /* a step in half a second */
    begin(-2);
    follow(2500);
    bear(1.0, 1.2);
    const double began_rad = rotor_rad;

    for (int i = 0; i < 400 && homing()->phase == HOMING_SEEKS_STOP; i++) {
        rotor_rad = began_rad + 0.7 * (link_bench_reference_rad() - began_rad);
        look(1);
    }
    TEST_ASSERT_EQUAL(HOMING_CATCHES, homing()->phase);
    TEST_ASSERT_EQUAL(1, homing()->failures);
}

static void test_a_stop_before_the_reference_has_led_is_none(void)
{
    put(0x6099, 1, 4, (uint32_t)(2.0 * full_step_rad() / unit_rad));
    begin(-2);
    follow(2500);
    bear(1.0, 1.2);
    look(100); /* a fifth of a step */
    TEST_ASSERT_EQUAL(HOMING_SEEKS_STOP, homing()->phase);
    look(50);
    TEST_ASSERT_EQUAL(HOMING_CATCHES, homing()->phase);
    TEST_ASSERT_EQUAL(1, homing()->touches);
}

/* Getting under way, a rotor bears what a stop does. */
static void test_a_stop_within_an_electrical_turn_is_none(void)
{
    put(0x6099, 1, 4, (uint32_t)(2.0 * full_step_rad() / unit_rad));
    begin(-2);
    bear(1.0, 1.2);
    look(1900);
    TEST_ASSERT_EQUAL(HOMING_SEEKS_STOP, homing()->phase);
    for (int i = 0; i < 400 && homing()->phase == HOMING_SEEKS_STOP; i++) {
        look(1);
    }
    TEST_ASSERT_EQUAL(HOMING_CATCHES, homing()->phase); /* it has not come from anywhere */
    TEST_ASSERT_EQUAL(0, homing()->touches);
    TEST_ASSERT_EQUAL(1, homing()->failures);
}

/* Under three quarters of the torque and more. */
static void give_way(void)
{
    follow(50);
    bear(1.0, 0.9);
    look(3);
    rotor_rad += 0.3 * full_step_rad();
    look(1);
    load_Nm = 0.0;
}

static void test_what_gives_way_is_no_stop(void)
{
    begin(-2);
    give_way();
    TEST_ASSERT_EQUAL(HOMING_CATCHES, homing()->phase);
    TEST_ASSERT_EQUAL(1, homing()->failures);
    TEST_ASSERT_EQUAL(0, homing()->touches);
}

static void test_what_gives_way_eight_times_is_an_error(void)
{
    begin(-2);
    for (int failures = 1; failures <= 8; failures++) {
        give_way();
        TEST_ASSERT_EQUAL(HOMING_CATCHES, homing()->phase);
        TEST_ASSERT_EQUAL(failures, homing()->failures);
        for (int i = 0; i < 10000 && homing()->phase > HOMING_SEEKS_STOP; i++) {
            follow(1);
        }
        TEST_ASSERT_EQUAL(failures < 8 ? HOMING_SEEKS_STOP : HOMING_ENDED, homing()->phase);
    }
    look(10);
    TEST_ASSERT_EQUAL_HEX32(REACHED | FAILED, status());
    TEST_ASSERT_EQUAL(DRIVE_OPERATION_ENABLED, bench.application.drive.supervision.state);
}

static void lose(enum drive_synchronism shown)
{
    bench.application.drive.synchronism.due += 1u << 30; /* the monitor's next look */
    bench.application.drive.synchronism.shown = shown;
}

static void test_a_rotor_out_of_step_is_caught_and_comes_again(void)
{
    begin(-2);
    follow(50);
    lose(DRIVE_SYNCHRONISM_LOST);
    const double lost_rad = link_bench_reference_rad();

    follow(2);
    TEST_ASSERT_EQUAL(HOMING_CATCHES, homing()->phase);
    TEST_ASSERT_EQUAL(1, homing()->failures);
    TEST_ASSERT_TRUE(bench.application.drive.hold.active);
    TEST_ASSERT_EQUAL(DRIVE_SYNCHRONISM_SURE, bench.application.drive.synchronism.shown);
    TEST_ASSERT_EQUAL(DRIVE_POSITION_UNCERTAIN, bench.application.drive.axis.reference);
    TEST_ASSERT_EQUAL_HEX32(0, status());
    for (int i = 0; i < 10000 && homing()->phase != HOMING_SEEKS_STOP; i++) {
        follow(1);
    }
    TEST_ASSERT_EQUAL(DRIVE_OPERATION_ENABLED, bench.application.drive.supervision.state);
    TEST_ASSERT_TRUE(link_bench_reference_rad() < lost_rad - 7.0 * full_step_rad());
    follow(100);
    TEST_ASSERT_TRUE(link_bench_speed_rad_s() > 0.0);
}

/* A hold that leads it has seen nothing of it for two turns. */
static void test_a_rotor_that_a_hold_has_left_is_caught(void)
{
    begin(-2);
    follow(50);
    bench.application.drive.lead_watch.unseen = 2;
    cia402_look(&bench.application);
    TEST_ASSERT_EQUAL(HOMING_CATCHES, homing()->phase);
}

static void test_a_place_of_a_doubtful_rotor_is_none(void)
{
    begin(-2);
    follow(50);
    lose(DRIVE_SYNCHRONISM_DOUBTFUL);
    follow(5);
    TEST_ASSERT_EQUAL(HOMING_SEEKS_STOP, homing()->phase);
    bear(1.0, 1.2);
    look(30);
    TEST_ASSERT_EQUAL(HOMING_CATCHES, homing()->phase);
    TEST_ASSERT_EQUAL(0, homing()->touches);
}

/* A stop that is struck leaves doubt. */
static void test_what_is_doubtful_at_the_stop_alone_is_found(void)
{
    begin(-2);
    follow(50);
    bear(1.0, 0.8);
    look(2);
    lose(DRIVE_SYNCHRONISM_DOUBTFUL);
    bear(1.0, 1.2);
    look(30);
    TEST_ASSERT_EQUAL(1, homing()->touches);
}

static void test_a_stop_that_is_elsewhere_the_second_time_is_sought_again(void)
{
    const double stop_rad = 10.0 * full_step_rad();

    begin(-2);
    strike_until(1.0, stop_rad, HOMING_CATCHES);
    strike_until(1.0, stop_rad, HOMING_SEEKS_STOP);
    strike_until(1.0, stop_rad - 0.3 * full_step_rad(), HOMING_CATCHES);
    TEST_ASSERT_EQUAL(1, homing()->touches);
    TEST_ASSERT_EQUAL(1, homing()->failures);
    const float last = homing()->place;

    strike_until(1.0, stop_rad, HOMING_SEEKS_STOP);
    strike_until(1.0, stop_rad - 0.25 * full_step_rad(), HOMING_CATCHES);
    TEST_ASSERT_EQUAL(2, homing()->touches);
    TEST_ASSERT_TRUE(homing()->furthest > last + 0.02f);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.5f * (last + homing()->furthest), homing()->place);
}

/* Pressed against a stop it induces nothing. */
static void test_an_estimate_that_drifts_at_the_stop_moves_it_nowhere(void)
{
    begin(-2);
    follow(50);
    const double stop_rad = rotor_rad;

    for (int i = 0; i < 100 && homing()->phase == HOMING_SEEKS_STOP; i++) {
        bear(1.0, i < 5 ? 0.6 : 1.2);
        look(1);
        rotor_rad -= 0.02 * full_step_rad();
    }
    TEST_ASSERT_EQUAL(1, homing()->touches);
    TEST_ASSERT_DOUBLE_WITHIN(1e-2 * full_step_rad(), stop_rad, place_rad());
}

static void test_the_travel_ends_it(void)
{
    put(0x2403, 2, 4, TURN / 8);
    put(0x6099, 1, 4, TURN);
    begin(-1);
    follow(80);
    TEST_ASSERT_EQUAL(HOMING_SEEKS_STOP, homing()->phase);
    follow(100);
    look(400);
    TEST_ASSERT_EQUAL_HEX32(REACHED | FAILED, status());
    TEST_ASSERT_DOUBLE_WITHIN(0.1, -TWO_PI / 8, link_bench_reference_rad());
}

static void test_the_torque_is_in_thousandths_of_the_rated_one(void)
{
    put(0x2403, 1, 2, 350);
    begin(-2);
    follow(50);
    bear(1.0, 0.55);
    look(30);
    TEST_ASSERT_EQUAL(1, homing()->touches);
}

static void test_a_halt_interrupts_it(void)
{
    begin(-2);
    follow(50);
    put(0x6040, 0, 2, 0x11f);
    look(100);
    TEST_ASSERT_EQUAL(HOMING_ENDED, homing()->phase);
    TEST_ASSERT_EQUAL_HEX32(REACHED, status());
    TEST_ASSERT_TRUE(axis_motion_rests(&bench.application));
}

static void test_a_law_that_follows_nothing_refuses_it(void)
{
    bench.application.drive.settings.law = POSITION_LAW_MICROSTEPPING;
    begin(-2);
    TEST_ASSERT_EQUAL_HEX32(REACHED | FAILED, status());
    TEST_ASSERT_EQUAL_DOUBLE(0.0, link_bench_speed_rad_s());
}

static void test_an_observer_of_counts_alone_refuses_it(void)
{
    bench.application.drive.settings.feedback = DRIVE_FEEDBACK_ENCODER;
    bench.application.drive.settings.observer = DRIVE_OBSERVER_HIGH_GAIN;
    begin(-2);
    TEST_ASSERT_EQUAL_HEX32(REACHED | FAILED, status());
}

static void test_a_rotor_that_is_lost_as_it_leaves_the_stop_comes_again(void)
{
    const double stop_rad = 10.0 * full_step_rad();

    begin(-2);
    strike_until(1.0, stop_rad, HOMING_CATCHES);
    strike_until(1.0, stop_rad, HOMING_SEEKS_STOP);
    strike_until(1.0, stop_rad, HOMING_BACKS_OFF);
    lose(DRIVE_SYNCHRONISM_LOST);
    strike_until(1.0, stop_rad, HOMING_CATCHES);
    TEST_ASSERT_EQUAL(1, homing()->touches);
    strike_until(1.0, stop_rad, HOMING_SEEKS_STOP);
    strike_until(1.0, stop_rad, HOMING_CATCHES);
    strike_until(1.0, stop_rad, HOMING_ENDED);
    look(2);
    TEST_ASSERT_EQUAL_HEX32(REACHED | ATTAINED, status());
}

static void test_what_one_approach_has_found_outlasts_one_that_fails(void)
{
    const double stop_rad = 10.0 * full_step_rad();

    begin(-2);
    strike_until(1.0, stop_rad, HOMING_CATCHES);
    strike_until(1.0, stop_rad, HOMING_SEEKS_STOP);
    lose(DRIVE_SYNCHRONISM_LOST);
    strike_until(1.0, stop_rad, HOMING_CATCHES);
    TEST_ASSERT_EQUAL(1, homing()->failures);
    strike_until(1.0, stop_rad, HOMING_SEEKS_STOP);
    strike_until(1.0, stop_rad, HOMING_BACKS_OFF);
    TEST_ASSERT_EQUAL(2, homing()->touches);
    TEST_ASSERT_EQUAL(1, homing()->failures);
}

/* Where the detent torque is nil, of the motor and not of the axis. */
static void test_it_comes_again_from_a_full_step(void)
{
    const double stop_rad = 10.4 * full_step_rad();

    begin(-2);
    strike_until(1.0, stop_rad, HOMING_CATCHES);
    strike_until(1.0, stop_rad, HOMING_SEEKS_STOP);

    const double begins_rad = homing()->began_rad + (double)homing()->from * full_step_rad();
    const double away = (begins_rad - zero_rad()) / full_step_rad();

    TEST_ASSERT_DOUBLE_WITHIN(0.01, round(away), away);
    TEST_ASSERT_TRUE(away < 4.0);
}

/* Greatest speed of the reference on the way back from a stop, and the periods up to it. */
static double back_off(int *periods)
{
    const double stop_rad = 10.0 * full_step_rad();
    double most = 0.0;

    begin(-2);
    strike_until(1.0, stop_rad, HOMING_BACKS_OFF);
    for (int n = 1; homing()->phase == HOMING_BACKS_OFF; n++) {
        strike(1.0, stop_rad);
        if (-link_bench_speed_rad_s() > most) {
            most = -link_bench_speed_rad_s();
            *periods = n;
        }
    }
    return most;
}

/* A tenth of a second, a quarter more with its jerk phases. */
static void test_it_comes_back_from_the_stop_as_slowly_as_a_hold_leads_a_rotor(void)
{
    const struct drive *drive = &bench.application.drive;
    const double creep_rad_s =
        num_to_double(drive->params.reference.creep_speed) * drive->base.speed_rad_s;
    int periods = 0;

    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * creep_rad_s, 0.5 * creep_rad_s, back_off(&periods));
    TEST_ASSERT_INT_WITHIN(30, 1250, periods);
    setUp();
    put(0x6099, 2, 4, (uint32_t)(0.25 * creep_rad_s / unit_rad));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * creep_rad_s, 0.25 * creep_rad_s, back_off(&periods));
}

/* Nor is it to be led back: it does not go on for ever. */
static void test_a_rotor_that_is_lost_all_the_time_ends_it(void)
{
    begin(-2);
    follow(50);
    for (int i = 0; i < 20000 && homing()->phase != HOMING_ENDED; i++) {
        lose(DRIVE_SYNCHRONISM_LOST);
        follow(1);
    }
    TEST_ASSERT_EQUAL(9, homing()->failures);
    look(10);
    TEST_ASSERT_EQUAL_HEX32(REACHED | FAILED, status());
}

static void test_what_cannot_be_is_refused(void)
{
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(0x6098, 0, 1, 32));
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(0x6098, 0, 1, 36));
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(0x6098, 0, 1, 0xfd));
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(0x6099, 1, 4, 0));
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(0x6099, 2, 4, 0));
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(0x609a, 0, 4, 0));
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(0x2403, 1, 2, 0));
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(0x2403, 2, 4, 0));
}

/* ---- on the index ---- */

enum { COUNTS = 4000, INDEX_COUNTS = 3 };

static const double count_rad = TWO_PI / COUNTS;

/* The index is high from lower_rad on, for so many counts. */
static struct {
    double lower_rad, rotor_rad; /* of the motor */
    bool awaited, rising, passed;
    int32_t count;
} encoder;

static bool index_of_board(void *context, enum hal_index ask, int32_t *count)
{
    (void)context;
    if (ask != HAL_INDEX_PASSED) {
        encoder.awaited = true;
        encoder.rising = ask == HAL_INDEX_RISES;
        encoder.passed = false;
    }
    const bool passed = encoder.passed;

    *count = encoder.count;
    encoder.passed = false;
    return passed;
}

static void start_with_encoder(double rotor_rad, double lower_rad, bool has_index)
{
    const struct drive_settings settings = link_bench_settings(DRIVE_FEEDBACK_ENCODER);
    struct hal_facts *facts = link_bench_encoder_facts(COUNTS);
    struct hal board = bench_board(facts);

    facts->has_encoder_index = has_index;
    board.encoder_index = index_of_board;
    memset(&encoder, 0, sizeof encoder);
    encoder.lower_rad = lower_rad;
    encoder.rotor_rad = rotor_rad;
    bench.samples.encoder_count = (int32_t)floor(rotor_rad / count_rad);
    link_bench_start_with(&board, &settings);
    link_bench_open();
    (void)link_bench_say("t00020101", 1);
    put(0x6099, 1, 4, TURN / 2); /* a winding without a voltage denies a faster one */
    put(0x6099, 2, 4, TURN / 2);
}

/* What a timer's capture does on the way to an angle. */
static void turn_to(double rotor_rad)
{
    for (int end = 0; end < 2; end++) {
        const double edge_rad = encoder.lower_rad + end * INDEX_COUNTS * count_rad;
        const double before = floor((encoder.rotor_rad - edge_rad) / TWO_PI);
        const double now = floor((rotor_rad - edge_rad) / TWO_PI);
        const bool rises = (now > before) == (end == 0);

        if (now != before && encoder.awaited && rises == encoder.rising) {
            encoder.passed = true;
            encoder.count =
                (int32_t)floor((edge_rad + TWO_PI * fmax(before, now)) / count_rad + 1e-6);
        }
    }
    encoder.rotor_rad = rotor_rad;
    bench.samples.encoder_count = (int32_t)floor(rotor_rad / count_rad);
}

/* The rotor follows, and trembles; the currents are those that the drive expects. */
static void turn(int ms)
{
    for (int i = 0; i < 10 * ms; i++) {
        const double trembles_rad = bench.period / 50u % 2u == 0u ? 0.6 * count_rad : 0.0;

        link_bench_expected_currents();
        turn_to(link_bench_reference_rad() - zero_rad() + trembles_rad);
        bench_period();
    }
    TEST_ASSERT_EQUAL_STRING("none", drive_fault_name(bench.application.drive.supervision.fault));
}

static void begin_with_encoder(int method)
{
    enable(method);
    put(0x6040, 0, 2, 0x1f);
    turn(3);
}

static void turn_until_homed(void)
{
    for (int i = 0; i < 300 && status() == 0u; i++) {
        turn(10);
    }
}

/* Whether the axis is at the offset where the index begins. */
static void is_homed(int method, double start_rad, double lower_rad, uint32_t polarity)
{
    start_with_encoder(start_rad, lower_rad, true);
    put(0x607e, 0, 1, polarity);
    put(0x607c, 0, 4, 1000);
    put(0x609a, 0, 4, 4 * TURN); /* slowly enough to tremble about where it sets out */
    begin_with_encoder(method);
    turn_until_homed();
    const double offset_rad = (polarity != 0u ? -1000.0 : 1000.0) * unit_rad;
    const double off_rad = remainder(zero_rad() + lower_rad - offset_rad, TWO_PI);

    TEST_ASSERT_EQUAL_HEX32(REACHED | ATTAINED, status());
    TEST_ASSERT_DOUBLE_WITHIN(count_rad, 0.0, off_rad);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, offset_rad, link_bench_reference_rad());
    TEST_ASSERT_DOUBLE_WITHIN(1.1 * TWO_PI, start_rad, encoder.rotor_rad);
}

static void test_the_index_is_where_the_offset_says_from_below_and_above(void)
{
    for (int n = 0; n < 5; n++) {
        is_homed(34, 1.3 * n, 1.0, 0);
        is_homed(33, 1.3 * n, 1.0, 0);
    }
}

static void test_the_index_of_an_axis_that_is_turned_round(void)
{
    is_homed(33, 0.3, 1.0, 0x80);
    TEST_ASSERT_TRUE(encoder.rising);
    is_homed(34, 0.3, 1.0, 0x80);
    TEST_ASSERT_FALSE(encoder.rising);
}

static void test_an_index_at_which_the_rotor_rests_is_that_of_the_next_turn(void)
{
    is_homed(34, 1.0 + (INDEX_COUNTS - 0.3) * count_rad, 1.0, 0);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 1.0 + TWO_PI, encoder.rotor_rad);
    is_homed(33, 1.0 - 0.3 * count_rad, 1.0, 0);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 1.0 - TWO_PI, encoder.rotor_rad);
}

static void test_an_index_is_not_looked_for_before_a_full_step(void)
{
    start_with_encoder(0.0, 1.0, true);
    put(0x6099, 1, 4, (uint32_t)(10.0 * full_step_rad() / unit_rad)); /* a second */
    begin_with_encoder(34);
    for (int i = 0; i < 500 && !encoder.awaited; i++) {
        turn(1);
    }
    TEST_ASSERT_TRUE(encoder.rotor_rad > full_step_rad());
    TEST_ASSERT_TRUE(encoder.rotor_rad < 1.1 * full_step_rad());
}

static void test_an_index_that_does_not_come_in_a_turn_ends_it(void)
{
    start_with_encoder(0.0, 1e300, true);
    begin_with_encoder(33);
    turn_until_homed();
    TEST_ASSERT_EQUAL_HEX32(FAILED, status() & (ATTAINED | FAILED));
    turn(100);
    TEST_ASSERT_EQUAL_HEX32(REACHED | FAILED, status());
    TEST_ASSERT_DOUBLE_WITHIN(0.3, -1.125 * TWO_PI, encoder.rotor_rad);
}

static void test_a_halt_interrupts_the_search_for_an_index(void)
{
    start_with_encoder(0.0, 3.0, true);
    begin_with_encoder(34);
    turn(100);
    bench_type("t60182B4060001F010000\r"); /* the rotor turns on meanwhile */
    turn(100);
    TEST_ASSERT_EQUAL_HEX32(REACHED, status());
    TEST_ASSERT_TRUE(axis_motion_rests(&bench.application));
}

static void is_refused(void)
{
    begin_with_encoder(34);
    TEST_ASSERT_EQUAL_HEX32(REACHED | FAILED, status());
    TEST_ASSERT_EQUAL_DOUBLE(0.0, link_bench_speed_rad_s());
}

static void test_without_an_index_it_is_refused(void)
{
    start_with_encoder(0.0, 1.0, false);
    is_refused();
}

static void test_a_sensorless_drive_refuses_an_index(void)
{
    start_with_encoder(0.0, 1.0, true);
    bench.application.drive.settings.feedback = DRIVE_FEEDBACK_SENSORLESS;
    is_refused();
}

static void test_its_methods_are_listed_those_on_an_index_where_there_is_one(void)
{
    TEST_ASSERT_EQUAL(18, link_bench_get(0x60e3, 0));
    start_with_encoder(0.0, 1.0, false);
    TEST_ASSERT_EQUAL(18, link_bench_get(0x60e3, 0));
    start_with_encoder(0.0, 1.0, true);
    TEST_ASSERT_EQUAL(20, link_bench_get(0x60e3, 0));
    for (unsigned sub = 1; sub <= 20; sub++) {
        const uint32_t method = link_bench_get(0x60e3, sub) & 0xffu;

        TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x6098, 0, 1, method));
        TEST_ASSERT_EQUAL(sub > 18, method == 33u || method == 34u);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_it_goes_at_the_homing_speed_down_and_up);
    RUN_TEST(test_it_looks_for_a_stop_without_a_d_current);
    RUN_TEST(test_a_polarity_turns_it_round);
    RUN_TEST(test_a_stop_above_is_where_the_offset_says);
    RUN_TEST(test_a_stop_below_is_where_the_offset_says);
    RUN_TEST(test_a_stop_of_an_axis_that_is_turned_round);
    RUN_TEST(test_a_load_below_the_torque_is_no_stop);
    RUN_TEST(test_a_load_along_the_motion_is_no_stop);
    RUN_TEST(test_one_look_is_no_stop);
    RUN_TEST(test_a_load_that_the_rotor_carries_along_is_no_stop);
    RUN_TEST(test_a_stop_before_the_reference_has_led_is_none);
    RUN_TEST(test_what_gives_way_is_no_stop);
    RUN_TEST(test_a_stop_within_an_electrical_turn_is_none);
    RUN_TEST(test_what_gives_way_eight_times_is_an_error);
    RUN_TEST(test_a_rotor_out_of_step_is_caught_and_comes_again);
    RUN_TEST(test_a_rotor_that_a_hold_has_left_is_caught);
    RUN_TEST(test_a_place_of_a_doubtful_rotor_is_none);
    RUN_TEST(test_what_is_doubtful_at_the_stop_alone_is_found);
    RUN_TEST(test_a_stop_that_is_elsewhere_the_second_time_is_sought_again);
    RUN_TEST(test_an_estimate_that_drifts_at_the_stop_moves_it_nowhere);
    RUN_TEST(test_the_travel_ends_it);
    RUN_TEST(test_the_torque_is_in_thousandths_of_the_rated_one);
    RUN_TEST(test_a_halt_interrupts_it);
    RUN_TEST(test_a_law_that_follows_nothing_refuses_it);
    RUN_TEST(test_an_observer_of_counts_alone_refuses_it);
    RUN_TEST(test_a_rotor_that_is_lost_as_it_leaves_the_stop_comes_again);
    RUN_TEST(test_what_one_approach_has_found_outlasts_one_that_fails);
    RUN_TEST(test_it_comes_again_from_a_full_step);
    RUN_TEST(test_it_comes_back_from_the_stop_as_slowly_as_a_hold_leads_a_rotor);
    RUN_TEST(test_a_rotor_that_is_lost_all_the_time_ends_it);
    RUN_TEST(test_what_cannot_be_is_refused);
    RUN_TEST(test_the_index_is_where_the_offset_says_from_below_and_above);
    RUN_TEST(test_the_index_of_an_axis_that_is_turned_round);
    RUN_TEST(test_an_index_at_which_the_rotor_rests_is_that_of_the_next_turn);
    RUN_TEST(test_an_index_is_not_looked_for_before_a_full_step);
    RUN_TEST(test_an_index_that_does_not_come_in_a_turn_ends_it);
    RUN_TEST(test_a_halt_interrupts_the_search_for_an_index);
    RUN_TEST(test_without_an_index_it_is_refused);
    RUN_TEST(test_a_sensorless_drive_refuses_an_index);
    RUN_TEST(test_its_methods_are_listed_those_on_an_index_where_there_is_one);
    return UNITY_END();
}
