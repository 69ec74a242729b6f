#include "firmware/application/application.h"

#include <string.h>
#include <unity.h>

#include "firmware/application/settings_record.h"
#include "firmware/drive/drive_hash.h"
#include "tests/unit/console_bench.h"

static char error[DRIVE_ERROR_TEXT];
static struct hal_facts facts;
static struct hal board;

void setUp(void)
{
    bench_power_up();
    facts = bench_stored_facts();
    board = bench_board(&facts);
    error[0] = '\0';
}

void tearDown(void)
{
}

static bool start(void)
{
    return application_init(&bench.application, &board, &bench_params, error);
}

static void store(const struct drive_settings *settings, uint32_t encoder_counts_per_turn)
{
    struct drive_settings stored = *settings;

    stored.encoder_counts_per_turn = (int32_t)encoder_counts_per_turn;

    TEST_ASSERT_TRUE(settings_record_write(&board, &stored));
}

static void test_without_stored_settings_the_defaults_of_the_motor_apply(void)
{
    TEST_ASSERT_TRUE(start());
    TEST_ASSERT_EQUAL_INT(APPLICATION_SETTINGS_DEFAULT, bench.application.settings_from);
    TEST_ASSERT_TRUE(bench.application.drive.settings.motor.inertia_kgm2 ==
                     bench_params.inertia_kgm2);
    TEST_ASSERT_EQUAL_INT(POSITION_LAW_STATE_FEEDBACK, bench.application.drive.settings.law);
    TEST_ASSERT_TRUE(bench.application.gains_hash ==
                     drive_hash_gains(&bench.application.drive.params));
}

static void test_stored_settings_for_an_encoder_that_is_not_there_say_what_to_do(void)
{
    struct drive_settings settings;

    drive_settings_default(&settings, &bench_params);
    drive_settings_select_feedback(&settings, DRIVE_FEEDBACK_ENCODER);
    store(&settings, 0);
    TEST_ASSERT_TRUE_MESSAGE(start(), error);
    TEST_ASSERT_EQUAL_INT(APPLICATION_SETTINGS_DEFAULT, bench.application.settings_from);
    TEST_ASSERT_EQUAL_STRING("feedback = encoder, but none is known: set "
                             "encoder_counts_per_turn, or feedback = sensorless",
                             bench.application.stored_refusal);
}

static void test_stored_settings_apply_with_their_encoder(void)
{
    struct drive_settings settings;

    drive_settings_default(&settings, &bench_params);
    drive_settings_select_feedback(&settings, DRIVE_FEEDBACK_ENCODER);
    settings.hold_on_enable_s = 0.2;
    store(&settings, 16384);
    TEST_ASSERT_TRUE_MESSAGE(start(), error);
    TEST_ASSERT_EQUAL_INT(APPLICATION_SETTINGS_STORED, bench.application.settings_from);
    TEST_ASSERT_TRUE(bench.application.drive.settings.hold_on_enable_s == 0.2);
    TEST_ASSERT_EQUAL_UINT32(16384, bench.application.drive.board->facts->encoder_counts_per_turn);
    TEST_ASSERT_EQUAL_UINT32(0, facts.encoder_counts_per_turn); /* the board's own is left alone */
}

static void test_stored_settings_that_are_refused_are_announced_and_the_defaults_apply(void)
{
    struct drive_settings settings;

    drive_settings_default(&settings, &bench_params);
    settings.hold_on_enable_s = -1.0;
    store(&settings, 99);
    TEST_ASSERT_TRUE(start());
    TEST_ASSERT_EQUAL_INT(APPLICATION_SETTINGS_DEFAULT, bench.application.settings_from);
    TEST_ASSERT_TRUE(bench.application.drive.settings.hold_on_enable_s > 0.0);
    TEST_ASSERT_EQUAL_UINT32(0, bench.application.facts.encoder_counts_per_turn);
    application_background(&bench.application);
    application_background(&bench.application);
    TEST_ASSERT_NOT_NULL(strstr(bench_heard(), "\nwarning: the stored settings are not in force: "
                                               "hold_on_enable_s -1 s: must be at least 0.01 s"));
    bench.written_count = 0;
    application_background(&bench.application);
    application_background(&bench.application);
    TEST_ASSERT_NULL_MESSAGE(strstr(bench_heard(), "stored settings"), "once is enough");
}

static void test_a_motor_that_is_refused_stops_the_start(void)
{
    struct motor_params impossible = bench_params;

    impossible.inertia_kgm2 = 0.0;
    TEST_ASSERT_FALSE(application_init(&bench.application, &board, &impossible, error));
    TEST_ASSERT_NOT_NULL(strstr(error, "inertia_kgm2"));
}

static void test_the_watchdog_is_fed_only_while_control_interrupts_come(void)
{
    TEST_ASSERT_TRUE(start());
    application_background(&bench.application);
    TEST_ASSERT_EQUAL_INT(0, bench.watchdog_fed);
    bench_periods(3);
    TEST_ASSERT_EQUAL_INT(3, bench.watchdog_fed);
    application_background(&bench.application);
    application_background(&bench.application);
    TEST_ASSERT_EQUAL_INT(3, bench.watchdog_fed);
}

static void test_the_outputs_are_those_of_the_drive(void)
{
    const struct drive_settings settings = bench_quick_settings();

    TEST_ASSERT_TRUE(bench_start(&settings));
    TEST_ASSERT_FALSE(bench.application.outputs.bridge_on);
    (void)bench_ask("enable at=12");
    bench_periods(14);
    TEST_ASSERT_TRUE(bench.application.outputs.bridge_on);
}

/* New settings are designed first: behind them only an enable whose period has come is put off. */
static void test_an_enable_with_new_settings_acts_in_its_period_if_that_is_still_to_come(void)
{
    for (uint32_t ahead = 0; ahead < 2; ahead++) {
        const struct drive_settings settings = bench_quick_settings();
        struct drive_command enable = {.kind = DRIVE_COMMAND_ENABLE};

        bench_power_up();
        TEST_ASSERT_TRUE(bench_start(&settings));
        bench_periods(3);
        bench.application.awaits_enable = true;
        enable.at_period = bench.period + ahead;
        TEST_ASSERT_TRUE_MESSAGE(
            application_command(&bench.application, &enable, bench.period, error), error);
        TEST_ASSERT_EQUAL_UINT32(ahead == 0u
                                     ? bench.period + application_typed_delay(&bench.application)
                                     : bench.period + 1u,
                                 enable.at_period);
    }
}

static void test_cycles_of_the_interrupt_are_counted(void)
{
    struct application *application = &bench.application;

    TEST_ASSERT_TRUE(start());
    application_background(application); /* the start */
    control_cycles_count(&application->cycles, 1107);
    control_cycles_count(&application->cycles, 1108);
    TEST_ASSERT_EQUAL_STRING("ok cycles periods=2 mean=1107.5 most=1108 budget=15300\n",
                             bench_ask("cycles reset"));
    control_cycles_count(&application->cycles, 1105);
    TEST_ASSERT_EQUAL_STRING("ok cycles periods=1 mean=1105 most=1105 budget=15300\n",
                             bench_ask("cycles"));
}

/* The sum wraps in 25 s at 170 MHz; nobody asks for it meanwhile. */
static void test_cycles_are_gathered_before_their_sum_wraps(void)
{
    struct application *application = &bench.application;

    TEST_ASSERT_TRUE(start());
    for (int part = 0; part < 3; part++) {
        application->cycles.sum += 0xf0000000u;
        application_background(application);
    }
    TEST_ASSERT_TRUE(application->cycle_statistics.sum == 3u * UINT64_C(0xf0000000));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_without_stored_settings_the_defaults_of_the_motor_apply);
    RUN_TEST(test_stored_settings_apply_with_their_encoder);
    RUN_TEST(test_stored_settings_for_an_encoder_that_is_not_there_say_what_to_do);
    RUN_TEST(test_stored_settings_that_are_refused_are_announced_and_the_defaults_apply);
    RUN_TEST(test_a_motor_that_is_refused_stops_the_start);
    RUN_TEST(test_the_watchdog_is_fed_only_while_control_interrupts_come);
    RUN_TEST(test_the_outputs_are_those_of_the_drive);
    RUN_TEST(test_an_enable_with_new_settings_acts_in_its_period_if_that_is_still_to_come);
    RUN_TEST(test_cycles_of_the_interrupt_are_counted);
    RUN_TEST(test_cycles_are_gathered_before_their_sum_wraps);
    return UNITY_END();
}
