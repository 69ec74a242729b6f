/* Settings on the console: what a flashed board is told. */
#include "firmware/application/settings_record.h"
#include "tests/unit/console_bench.h"
#include "tests/unit/num_assert.h"

static struct hal_facts facts;
static struct hal board;
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

static void test_get_says_value_unit_range_default_and_what_it_is_for(void)
{
    answers("get hold_ramp_s",
            "ok get hold_ramp_s=0.01 s; 0.001...1; default 0.01; time for the hold current to ramp "
            "in or out\n");
    answers("get current_limit_A",
            "ok get current_limit_A=3 A; 0.03...6; default 3; of the current reference\n");
    answers("get observer",
            "ok get observer=model; model, high-gain; default model; on the encoder\n");
    answers("get feed_forward", "ok get feed_forward=true; true or false; default true; reference "
                                "speed and acceleration into the law\n");
    answers("get rotor_teeth", "ok get rotor_teeth=50; 1...1000; N, pole pairs: electrical turns "
                               "per turn\n");
}

static void test_what_follows_is_said_with_what_follows(void)
{
    const char *const answer = bench_ask("get hold_current_A");

    TEST_ASSERT_NOT_NULL(
        strstr(answer, "hold_current_A=1.5(follows) A; 0.03...3; default follows"));
    TEST_ASSERT_NOT_NULL(strstr(bench_ask("get law_gains.2"), "law_gains.2=(not given); "));
}

static void test_a_begin_lists_those_that_begin_so(void)
{
    answers("get hold_*",
            "ok get hold_on_enable=true hold_at_rest=true hold_on_enable_s=0.15 "
            "hold_current_A=1.5(follows) hold_ramp_s=0.01 hold_delay_s=0.015(follows) "
            "hold_bandwidth_rad_s=200(follows)\n");
    TEST_ASSERT_NOT_NULL(strstr(bench_ask("get *"), " more: give a longer begin\n"));
}

static void test_what_is_set_is_in_force_once_stored_and_started_again(void)
{
    answers("set hold_current_A 1.2",
            "ok set hold_current_A=1.2; acts once it is stored and the board starts again\n");
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.5, bench.application.drive.settings.hold_current_A);
    answers("set detent_torque_Nm.6 -0.01",
            "ok set detent_torque_Nm.6=-0.01; acts once it is stored and the board starts again\n");
    answers("store", "ok store\n");
    start();
    TEST_ASSERT_EQUAL_INT(APPLICATION_SETTINGS_STORED, bench.application.settings_from);
    TEST_ASSERT_TRUE(bench.application.drive.settings.hold_current_A == 1.2);
    TEST_ASSERT_TRUE(bench.application.drive.settings.detent_torque_Nm[5] == -0.01);
    start();
    answers("defaults", "ok defaults\n");
    answers("store", "ok store\n");
    start();
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.5, bench.application.drive.settings.hold_current_A);
}

static void test_what_is_not_stored_is_gone_with_the_power(void)
{
    (void)bench_ask("set hold_ramp_s 0.02");
    start();
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.010, bench.application.drive.settings.hold_ramp_s);
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
    TEST_ASSERT_TRUE(bench.application.drive.settings.motor.torque_constant_Nm_A == 0.2);
    TEST_ASSERT_TRUE(bench.application.drive.settings.current_limit_A == 2.0);
}

static void test_feedback_brings_its_law_and_an_encoder_its_counts(void)
{
    (void)bench_ask("set feedback encoder");
    (void)bench_ask("set encoder_counts_per_turn 4000");
    answers("store", "ok store\n");
    start();
    TEST_ASSERT_EQUAL_INT(POSITION_LAW_FEEDBACK_LINEARISATION,
                          bench.application.drive.settings.law);
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
    RUN_TEST(test_what_is_not_stored_is_gone_with_the_power);
    RUN_TEST(test_a_motor_is_set_like_anything_else);
    RUN_TEST(test_feedback_brings_its_law_and_an_encoder_its_counts);
    RUN_TEST(test_another_law_drops_the_gains_of_the_one_before);
    RUN_TEST(test_a_refused_set_changes_nothing);
    RUN_TEST(test_settings_that_do_not_go_together_are_not_stored);
    return UNITY_END();
}
