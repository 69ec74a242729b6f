/* Settings on the console: how a flashed board is set. */
#include <stdlib.h>

#include "firmware/application/settings_record.h"
#include "firmware/drive/drive_hash.h"
#include "tests/unit/console_bench.h"
#include "tests/unit/num_assert.h"

static struct hal_facts facts;
static struct hal board;
static struct drive *const drive = &bench.application.drive;
static char error[DRIVE_ERROR_TEXT];

static void start(void)
{
    TEST_ASSERT_TRUE_MESSAGE(application_init(&bench.application, &board, &bench_params, error),
                             error);
    (void)bench_ask("state");
    (void)bench_heard();
}

void setUp(void)
{
    bench_power_up();
    facts = bench_stored_facts();
    board = bench_board(&facts);
    start();
}

void tearDown(void)
{
}

static void answers(const char *line, const char *answer)
{
    TEST_ASSERT_EQUAL_STRING(answer, bench_ask(line));
}

static void begins(const char *line, const char *answer)
{
    const char *const heard = bench_ask(line);

    TEST_ASSERT_EQUAL_STRING_LEN(answer, heard, strlen(answer));
}

static void test_get_says_value_unit_range_default_and_what_it_is_for(void)
{
    answers("get hold_ramp_s", "ok get hold_ramp_s=0.01 s; 0.001...1; default 0.01; at enable; "
                               "time for the hold current to ramp "
                               "in; out, 1.25 of it without an encoder\n");
    answers(
        "get current_limit_A",
        "ok get current_limit_A=3 A; 0.03...6; default 3; in motion; of the current reference\n");
    answers("get observer",
            "ok get observer=model; model, high-gain; default model; at enable; on the encoder\n");
    answers("get feed_forward", "ok get feed_forward=true; true or false; default true; at enable; "
                                "reference speed and acceleration into the law\n");
    answers("get rotor_teeth", "ok get rotor_teeth=50; 1...1000; at enable; N, pole pairs: "
                               "electrical turns per turn\n");
}

static void test_what_follows_is_said_with_what_follows(void)
{
    const char *const answer = bench_ask("get hold_current_A");

    TEST_ASSERT_NOT_NULL(strstr(answer, "hold_current_A=3(follows) A; 0.03...3; default follows"));
    TEST_ASSERT_NOT_NULL(strstr(answer, "; bears 0.471 N m, heats the winding by 3.33 W; at"));
    TEST_ASSERT_NOT_NULL(strstr(bench_ask("get law_gains.2"), "law_gains.2=(not given); "));
}

static void test_a_begin_lists_those_that_begin_so(void)
{
    answers("get hold_*",
            "ok get hold_on_enable=true hold_at_rest=true hold_on_enable_s=0.15 "
            "hold_current_A=3(follows) hold_ramp_s=0.01 hold_delay_s=0.0108166892(follows) "
            "hold_bandwidth_rad_s=200(follows)\n");

    const char *const all = bench_ask("get *");
    const char *const more = strstr(all, " and ");
    int elements = 0;
    int shown = 0;

    for (size_t i = 0; setting_number(i) != NULL; i++) {
        elements += (int)setting_number(i)->count;
    }
    for (const char *c = all; c < more; c++) {
        shown += *c == '=' ? 1 : 0;
    }
    TEST_ASSERT_NOT_NULL(more);
    TEST_ASSERT_EQUAL_INT(elements - shown, atoi(more + 5));
    TEST_ASSERT_NOT_NULL(strstr(more, " more: give a longer begin\n"));
}

static void periods_of_enabling(void)
{
    bench_periods(10000);
    TEST_ASSERT_EQUAL_INT(DRIVE_OPERATION_ENABLED, drive->supervision.state);
    (void)bench_heard();
}

/* Which the motor's absence does not disturb. */
static void choose_quick_start(void)
{
    (void)bench_ask("set calibrate_offsets false");
    (void)bench_ask("set hold_on_enable false");
    (void)bench_ask("set synchronism_policy off");
}

static void enable(void)
{
    begins("enable", "ok enable at=");
    bench_periods(20);
    TEST_ASSERT_EQUAL_INT(DRIVE_OPERATION_ENABLED, drive->supervision.state);
    (void)bench_heard();
}

static void test_what_is_set_is_in_force_once_stored_and_started_again(void)
{
    answers("set hold_current_A 1.2", "ok set hold_current_A=1.2; bears 0.188 N m, heats the "
                                      "winding by 0.533 W; acts at the next enable\n");
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 3.0, drive->settings.hold_current_A);
    answers("set detent_torque_Nm.6 -0.01",
            "ok set detent_torque_Nm.6=-0.01; acts at the next enable\n");
    answers("store", "ok store\n");
    start();
    TEST_ASSERT_EQUAL_INT(APPLICATION_SETTINGS_STORED, bench.application.settings_from);
    TEST_ASSERT_TRUE(drive->settings.hold_current_A == 1.2);
    TEST_ASSERT_NOT_NULL(strstr(bench_ask("get idle_current_A"), "; bears 0.188 N m, heats "));
    TEST_ASSERT_TRUE(drive->settings.detent_torque_Nm[5] == -0.01);
    start();
    answers("defaults", "ok defaults\n");
    answers("store", "ok store\n");
    start();
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 3.0, drive->settings.hold_current_A);
}

/* Of the next 400 periods, and of the gains. */
static uint64_t hash_from_here(void)
{
    uint64_t hash = bench.application.gains_hash;

    for (int i = 0; i < 400; i++) {
        bench.period++;
        const struct hal_outputs *outputs =
            application_control_interrupt(&bench.application, &bench.samples);

        application_background(&bench.application);
        hash = drive_hash_add(hash, drive_hash_row(drive, outputs));
    }
    return hash;
}

static const char *const set_ups[][4] = {
    {"set hold_current_A 1.2", "set initial_angle_rad 0.5"},
    {"set law pid", "set resistance_ohm 0.5", "set hold_at_rest false"},
    {"set law csmc", "set standstill_pulses false"},
    {"set rotor_teeth 100", "set law foc", "set voltage_source commanded"},
    {"set encoder_counts_per_turn 4000", "set feedback encoder", "set encoder_zero_known true"},
    {"set estimator steady-state-ekf", "set feed_forward false"},
};

/* However it has come to its settings: what the design before has left shows nowhere. */
static void test_an_enable_puts_in_force_what_was_set(void)
{
    uint64_t after_store = 0;

    for (size_t i = 0; i < sizeof set_ups / sizeof set_ups[0]; i++) {
        for (int started_again = 0; started_again < 2; started_again++) {
            setUp();
            choose_quick_start();
            for (size_t line = 0; line < 4 && set_ups[i][line] != NULL; line++) {
                begins(set_ups[i][line], "ok set ");
            }
            if (started_again != 0) {
                answers("store", "ok store\n");
                bench.period = UINT32_MAX;
                start();
                enable();
                TEST_ASSERT_TRUE(hash_from_here() == after_store);
            } else {
                enable();
                after_store = hash_from_here();
            }
        }
    }
}

static void test_a_drive_that_has_moved_is_designed_anew_as_well(void)
{
    choose_quick_start();
    enable();
    begins("move 1", "ok move ");
    bench_periods(300);
    begins("disable", "ok disable ");
    bench_periods(12);
    begins("set law stmms-plus", "ok set ");
    enable();
    TEST_ASSERT_EQUAL_INT(POSITION_LAW_STMMS_PLUS, drive->params.position_law);
    TEST_ASSERT_TRUE(drive->reference.now.position.turns == 0);
    begins("move 0.1", "ok move ");
}

static void test_a_set_up_that_the_drive_refuses_leaves_the_one_before(void)
{
    choose_quick_start();
    enable();
    begins("disable", "ok disable ");
    bench_periods(12);
    const uint64_t gains = bench.application.gains_hash;

    begins("set law_bandwidth_rad_s 5000", "ok set ");
    for (int again = 0; again < 2; again++) {
        const char *const answer = bench_ask("enable");

        TEST_ASSERT_EQUAL_MEMORY("error: ", answer, 7);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(answer, "; what was set is not in force\n"), answer);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(answer, "must be at most"), answer);
        TEST_ASSERT_TRUE(bench.application.gains_hash == gains);
        TEST_ASSERT_TRUE(drive_hash_gains(&drive->params) == gains);
        TEST_ASSERT_DOUBLE_WITHIN(0.0, 300.0, drive->settings.law_bandwidth_rad_s);
    }
    bench_periods(20);
    TEST_ASSERT_EQUAL_INT(DRIVE_SWITCH_ON_DISABLED, drive->supervision.state);
    begins("get law_bandwidth_rad_s", "ok get law_bandwidth_rad_s=5000 ");
    begins("set law_bandwidth_rad_s default", "ok set ");
    enable();
}

static void test_an_encoder_that_there_is_not_is_refused_at_the_enable(void)
{
    begins("set feedback encoder", "ok set ");
    begins("enable", "error: feedback = encoder, but none is known");
    begins("set encoder_counts_per_turn 4000", "ok set ");
    begins("enable", "ok enable ");
    TEST_ASSERT_EQUAL_UINT32(4000, drive->board->facts->encoder_counts_per_turn);
}

/* They come in the midst of it, keep the bridge off, and count; the watchdog is fed on the way. */
static void test_control_interrupts_go_on_while_the_drive_is_designed(void)
{
    choose_quick_start();
    enable();
    begins("disable", "ok disable ");
    bench_periods(12);
    begins("set hold_current_A 1.2", "ok set ");
    (void)bench_heard();
    bench.periods_between = 50;
    bench.watchdog_fed = 0;
    bench.bridge_was_on = false;
    bench_type("enable\n");
    application_background(&bench.application);
    bench.periods_between = 0;
    TEST_ASSERT_FALSE(bench.bridge_was_on);
    TEST_ASSERT_EQUAL_INT(5, bench.watchdog_fed); /* settings, estimator in four parts */
    TEST_ASSERT_EQUAL_UINT32(bench.period, drive->supervision.period);
    bench_periods(9); /* ten behind the design */
    TEST_ASSERT_EQUAL_INT(DRIVE_SWITCH_ON_DISABLED, drive->supervision.state);
    bench_periods(1);
    TEST_ASSERT_EQUAL_INT(DRIVE_OPERATION_ENABLED, drive->supervision.state);
    TEST_ASSERT_EQUAL_UINT32(bench.period, drive->supervision.state_since);
    TEST_ASSERT_TRUE(drive->settings.hold_current_A == 1.2);
}

static void test_an_enable_acts_in_its_period_if_the_design_is_done_by_then(void)
{
    choose_quick_start();
    bench_periods(3);
    (void)bench_heard();
    answers("enable", "ok enable at=12\n"); /* the design took no time */
    setUp();
    choose_quick_start();
    bench_periods(3);
    bench.periods_between = 100;
    begins("enable at=5000", "ok enable at=5000\n");
}

static void test_what_was_learned_survives_a_design(void)
{
    const struct learned_parameters learned = {{0.01, -0.02, 0.003, 0.0, -0.001, 0.002}};
    struct learned_parameters found;

    choose_quick_start();
    begins("set encoder_counts_per_turn 4000", "ok set ");
    begins("set feedback encoder", "ok set ");
    enable();
    drive_put_learned(drive, &learned);
    begins("disable", "ok disable ");
    bench_periods(12);
    for (int refused = 0; refused < 2; refused++) {
        begins(refused != 0 ? "set law_bandwidth_rad_s 9000" : "set resistance_ohm 0.4", "ok set ");
        begins("enable", refused != 0 ? "error: " : "ok enable ");
        TEST_ASSERT_TRUE(drive_learned(drive, &found));
        for (int i = 0; i < DRIVE_DETENT_COEFFICIENTS; i++) {
            TEST_ASSERT_DOUBLE_WITHIN(2e-6, learned.detent_torque_Nm[i], found.detent_torque_Nm[i]);
        }
        (void)bench_ask("disable");
        bench_periods(12);
    }
}

static void test_store_keeps_what_was_learned_by_a_drive_that_learns(void)
{
    const struct learned_parameters learned = {{0.01, -0.02, 0.003, 0.0, -0.001, 0.002}};
    struct learned_parameters found;

    answers("store", "ok store\n");
    TEST_ASSERT_FALSE(parameter_store_read(&board, &found));
    choose_quick_start();
    begins("set encoder_counts_per_turn 4000", "ok set ");
    begins("set feedback encoder", "ok set ");
    enable();
    drive_put_learned(drive, &learned);
    answers("store", "ok store\n");
    TEST_ASSERT_TRUE(parameter_store_read(&board, &found));
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, -0.02, found.detent_torque_Nm[1]);
    start();
    TEST_ASSERT_TRUE(drive_learned(drive, &found));
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, -0.02, found.detent_torque_Nm[1]);
}

static void has_torque_constant_change(double expected)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, expected, num_to_double(drive->torque_constant.change));
}

static void test_store_keeps_the_torque_constant_that_motion_has_shown(void)
{
    torque_constant_put(drive, NUM(-0.08));
    begins("set hold_ramp_s 0.02", "ok set "); /* and designed anew it is not forgotten */
    choose_quick_start();
    enable();
    has_torque_constant_change(-0.08);
    begins("disable", "ok disable ");
    bench_periods(12);
    answers("store", "ok store\n");
    bench.period = UINT32_MAX;
    start();
    has_torque_constant_change(-0.08);
    TEST_ASSERT_TRUE(drive->base.speed_rad_s >
                     1.08 * per_unit_base(&bench_params, facts.control_period_s).speed_rad_s);
}

/* The defaults do, and another motor; and what is given counts. */
static void test_what_was_learned_of_the_torque_constant_is_forgotten(void)
{
    static const char *const lines[] = {"defaults", "set torque_constant_Nm_A 0.15",
                                        "set resistance_ohm 0.4",
                                        "set initial_torque_constant_change 0"};

    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        setUp();
        torque_constant_put(drive, NUM(0.1));
        answers("store", "ok store\n");
        begins(lines[i], "ok ");
        has_torque_constant_change(0.0);
        answers("store", "ok store\n");
        bench.period = UINT32_MAX;
        start();
        has_torque_constant_change(0.0);
    }
    begins("set initial_torque_constant_change 0.05", "ok set ");
    has_torque_constant_change(0.05);
    begins("set initial_torque_constant_change 0.21", "error: ");
    has_torque_constant_change(0.05);
}

/* A drive that has learned 0.01 Nm and kept it, has 0.02 Nm now, and a ramp that was set. */
static void learn_and_set(void)
{
    const struct learned_parameters before = {{0.01}};
    const struct learned_parameters after = {{0.02}};

    setUp();
    choose_quick_start();
    begins("set encoder_counts_per_turn 4000", "ok set ");
    begins("set feedback encoder", "ok set ");
    enable();
    drive_put_learned(drive, &before);
    answers("store", "ok store\n");
    drive_put_learned(drive, &after);
    begins("disable", "ok disable ");
    bench_periods(12);
    begins("set hold_ramp_s 0.02", "ok set ");
}

static bool about(double value, double expected)
{
    return fabs(value - expected) < 2e-6;
}

/* Each of the two records is the one before or the new one, and the drive starts with it. */
static void test_store_survives_a_loss_of_power_at_any_step(void)
{
    static const size_t bytes[] = {0, 1, 20, 39, 40, 60, 300, 823, 824};
    enum { ALL = 824, LEARNED = 40 }; /* in whole words */

    for (size_t i = 0; i < sizeof bytes / sizeof bytes[0]; i++) {
        struct learned_parameters found;

        learn_and_set();
        bench.bytes_until_power_fails = bytes[i];
        answers("store", "ok store\n"); /* nobody hears it */
        TEST_ASSERT_EQUAL_INT(0, (int)bench.bytes_until_power_fails);
        bench.bytes_until_power_fails = SIZE_MAX;
        bench.period = UINT32_MAX;
        start();
        TEST_ASSERT_EQUAL_INT(APPLICATION_SETTINGS_STORED, bench.application.settings_from);
        TEST_ASSERT_TRUE(drive->settings.hold_ramp_s == (bytes[i] < ALL ? 0.01 : 0.02));
        TEST_ASSERT_TRUE(drive_learned(drive, &found));
        TEST_ASSERT_TRUE(about(found.detent_torque_Nm[0], bytes[i] < LEARNED - 4 ? 0.01 : 0.02));
        answers("store", "ok store\n");
    }
}

static void test_most_settings_are_refused_while_the_drive_is_not_disabled(void)
{
    choose_quick_start();
    enable();
    const struct drive_settings before = bench.application.chosen;

    answers("set hold_ramp_s 0.02", "error: this is set while the drive is disabled\n");
    answers("set resistance_ohm 0.4", "error: this is set while the drive is disabled\n");
    answers("defaults", "error: this is set while the drive is disabled\n");
    TEST_ASSERT_EQUAL_MEMORY(&before, &bench.application.chosen, sizeof before);
    begins("disable", "ok disable ");
    answers("set hold_ramp_s 0.02", "ok set hold_ramp_s=0.02; acts at the next enable\n");
    begins("enable", "error: enable refused: settings have changed, wait until the bridge is off");
    bench_periods(12);
    begins("enable at=9000", "ok enable at=9000\n");
    answers("set hold_ramp_s 0.03", "error: this is set while the drive is disabled\n");
}

static void test_a_drive_in_fault_takes_settings(void)
{
    choose_quick_start();
    enable();
    bench.samples.current_a = 4000;
    bench_period();
    (void)bench_heard();
    application_background(&bench.application);
    answers("set hold_ramp_s 0.02", "ok set hold_ramp_s=0.02; acts at the next enable\n");
    begins("enable", "error: enable refused: fault overcurrent");
    TEST_ASSERT_TRUE(drive->settings.hold_ramp_s == 0.01);
    bench.samples.current_a = 2048;
    begins("disable", "ok disable ");
    begins("enable", "ok enable ");
    TEST_ASSERT_TRUE(drive->settings.hold_ramp_s == 0.02);
    bench_periods(12);
    TEST_ASSERT_EQUAL_INT(DRIVE_OPERATION_ENABLED, drive->supervision.state);
}

static void test_what_changes_in_motion_acts_at_once(void)
{
    (void)bench_ask("set hold_on_enable false");
    begins("enable", "ok enable ");
    bench_periods(20);
    begins("set current_limit_A 2", "error: the drive is being enabled, wait until it is ready\n");
    periods_of_enabling();
    answers("set current_limit_A 2", "ok set current_limit_A=2; acts at once\n");
    TEST_ASSERT_TRUE(drive->settings.current_limit_A == 2.0);
    answers("set current_limit_A 7", "error: current_limit_A 7 A: must be at most 6 A, the range "
                                     "of this setting\n");
    begins("set overcurrent_trip_A 6.1", "error: overcurrent_trip_A 6.1 A: must be at most ");
    TEST_ASSERT_TRUE(drive->settings.current_limit_A == 2.0);
}

static void test_what_is_not_stored_is_gone_with_the_power(void)
{
    (void)bench_ask("set hold_ramp_s 0.02");
    start();
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.010, drive->settings.hold_ramp_s);
}

/* One image serves every motor; its currents' shares are then of the new one. */
static void test_a_motor_is_set_like_anything_else(void)
{
    (void)bench_ask("set rated_current_A 2");
    (void)bench_ask("set torque_constant_Nm_A 0.2");
    answers("set current_limit_A 4.5", "error: current_limit_A 4.5 A: must be at most 4 A, the "
                                       "range of this setting\n");
    (void)bench_ask("set current_limit_A default");
    answers("store", "ok store\n");
    start();
    TEST_ASSERT_TRUE(drive->settings.motor.torque_constant_Nm_A == 0.2);
    TEST_ASSERT_TRUE(drive->settings.current_limit_A == 2.0);
}

static void test_a_store_that_is_worn_out_in_places_says_so(void)
{
    (void)bench_ask("set hold_current_A 0.7");
    bench.worn = true;
    answers("store", "ok store; where it was to go the store is worn out\n");
    bench.worn = false;
    start();
    TEST_ASSERT_TRUE(drive->settings.hold_current_A == 0.7);
}

static void test_feedback_brings_its_law_and_an_encoder_its_counts(void)
{
    (void)bench_ask("set feedback encoder");
    (void)bench_ask("set encoder_counts_per_turn 4000");
    answers("store", "ok store\n");
    start();
    TEST_ASSERT_EQUAL_INT(POSITION_LAW_FEEDBACK_LINEARISATION, drive->settings.law);
    TEST_ASSERT_EQUAL_UINT32(4000, bench.application.facts.encoder_counts_per_turn);
}

/* By their places they would be another law's. */
static void test_another_law_drops_the_gains_of_the_one_before(void)
{
    (void)bench_ask("set law_gains.1 5");
    (void)bench_ask("set law state-feedback");
    TEST_ASSERT_NOT_NULL(strstr(bench_ask("get law_gains.1"), "law_gains.1=5; "));
    (void)bench_ask("set law pid");
    TEST_ASSERT_NOT_NULL(strstr(bench_ask("get law_gains.1"), "law_gains.1=(not given); "));
}

static void test_a_refused_set_changes_nothing(void)
{
    static const char *const lines[][2] = {
        {"set hold_current_A 3.1",
         "error: hold_current_A 3.1 A: must be at most 3 A, the range of this setting\n"},
        {"set hold_current_A much",
         "error: \"much\": expected a value of hold_current_A; 0.03...3\n"},
        {"set law pdi", "error: \"pdi\": expected a value of law; state-feedback, pid, "
                        "feedback-linearisation, microstepping, stmms, stmms-plus, foc, csmc, "
                        "csmc-equivalent, csmc-servo, smc\n"},
        {"set feed_forward 1", "error: \"1\": expected a value of feed_forward; true or false\n"},
        {"set rotor_teeth 50.5", "error: \"50.5\": expected a value of rotor_teeth; 1...1000\n"},
        {"set rotor_teeth default",
         "error: \"default\": expected a value of rotor_teeth; 1...1000\n"},
        {"set hold_current 1",
         "error: \"hold_current\": expected a setting; get * lists them, an array's with .1, .2, "
         "...\n"},
        {"set detent_torque_Nm.7 0",
         "error: \"detent_torque_Nm.7\": expected a setting; get * lists them, an array's with "
         ".1, .2, ...\n"},
        {"set hold_current_A", "error: set: expected a name and a value\n"},
        {"set hold_current_A 1 2", "error: \"2\": expected a name and a value\n"},
        {"get", "error: get: expected a name, or the begin of one and *\n"},
        {"get speedy*", "error: \"speedy*\": expected a setting; get * lists them, an array's with "
                        ".1, .2, ...\n"},
    };
    const struct drive_settings before = bench.application.chosen;

    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        answers(lines[i][0], lines[i][1]);
        TEST_ASSERT_EQUAL_MEMORY(&before, &bench.application.chosen, sizeof before);
    }
}

static void test_settings_that_do_not_go_together_are_not_stored(void)
{
    (void)bench_ask("set detent_learning true");
    answers("store", "error: detent_learning: needs an encoder and its model observer\n");
    facts.parameter_word_bytes = 0;
    start();
    answers("store", "error: the board has no parameter store, or refused to write\n");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_get_says_value_unit_range_default_and_what_it_is_for);
    RUN_TEST(test_what_follows_is_said_with_what_follows);
    RUN_TEST(test_a_begin_lists_those_that_begin_so);
    RUN_TEST(test_what_is_set_is_in_force_once_stored_and_started_again);
    RUN_TEST(test_an_enable_puts_in_force_what_was_set);
    RUN_TEST(test_a_drive_that_has_moved_is_designed_anew_as_well);
    RUN_TEST(test_a_set_up_that_the_drive_refuses_leaves_the_one_before);
    RUN_TEST(test_an_encoder_that_there_is_not_is_refused_at_the_enable);
    RUN_TEST(test_control_interrupts_go_on_while_the_drive_is_designed);
    RUN_TEST(test_an_enable_acts_in_its_period_if_the_design_is_done_by_then);
    RUN_TEST(test_what_was_learned_survives_a_design);
    RUN_TEST(test_store_keeps_what_was_learned_by_a_drive_that_learns);
    RUN_TEST(test_store_keeps_the_torque_constant_that_motion_has_shown);
    RUN_TEST(test_what_was_learned_of_the_torque_constant_is_forgotten);
    RUN_TEST(test_store_survives_a_loss_of_power_at_any_step);
    RUN_TEST(test_most_settings_are_refused_while_the_drive_is_not_disabled);
    RUN_TEST(test_a_drive_in_fault_takes_settings);
    RUN_TEST(test_what_changes_in_motion_acts_at_once);
    RUN_TEST(test_what_is_not_stored_is_gone_with_the_power);
    RUN_TEST(test_a_motor_is_set_like_anything_else);
    RUN_TEST(test_a_store_that_is_worn_out_in_places_says_so);
    RUN_TEST(test_feedback_brings_its_law_and_an_encoder_its_counts);
    RUN_TEST(test_another_law_drops_the_gains_of_the_one_before);
    RUN_TEST(test_a_refused_set_changes_nothing);
    RUN_TEST(test_settings_that_do_not_go_together_are_not_stored);
    return UNITY_END();
}
