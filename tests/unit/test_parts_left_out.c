/* An image without these parts starts with the rest of what is stored. */
#define STEADYSTEP_WITHOUT_INDUCTANCE
#define STEADYSTEP_WITHOUT_ENCODER
#define STEADYSTEP_WITHOUT_LINK
#define STEADYSTEP_WITHOUT_MACHINE_IO
#include "firmware/interface/parts_carried.h"
#undef STEADYSTEP_WITHOUT_ENCODER /* the others of the drive are built with it */

#include "firmware/application/application.c"
#include "firmware/application/report.c"
#include "firmware/interface/settings.c"

#include <unity.h>

#include "tests/unit/console_bench.h"

static struct hal_facts facts;
static struct hal board;
static char error[DRIVE_ERROR_TEXT];
static struct drive_settings stored;

void setUp(void)
{
    bench_power_up();
    facts = bench_stored_facts();
    board = bench_board(&facts);
    drive_settings_default(&stored, &bench_params);
    stored.hold_on_enable_s = 0.2;
}

void tearDown(void)
{
}

/* What is announced first. */
static const char *start(void)
{
    TEST_ASSERT_TRUE(settings_record_write(&board, &stored));
    TEST_ASSERT_TRUE_MESSAGE(application_init(&bench.application, &board, &bench_params, error),
                             error);
    for (int n = 0; n < 4; n++) {
        application_background(&bench.application);
    }
    return bench_heard();
}

static void test_settings_of_parts_left_out_are_named_and_the_rest_is_in_force(void)
{
    stored.identify_inductance = true;
    stored.encoder_counts_per_turn = 4000;
    stored.modbus_rtu = true;
    stored.inputs_used = 3;
    TEST_ASSERT_NOT_NULL(strstr(start(), "\nwarning: stored, but not of this image: inputs_used "
                                         "encoder_counts_per_turn modbus_rtu "
                                         "identify_inductance\n"));
    TEST_ASSERT_EQUAL_INT(APPLICATION_SETTINGS_STORED, bench.application.settings_from);
    TEST_ASSERT_TRUE(bench.application.drive.settings.hold_on_enable_s == 0.2);
    TEST_ASSERT_FALSE(bench.application.drive.settings.identify_inductance);
    TEST_ASSERT_EQUAL_INT32(0, bench.application.drive.settings.encoder_counts_per_turn);
    TEST_ASSERT_EQUAL_INT32(0, bench.application.drive.settings.inputs_used);
}

static void test_what_is_as_it_is_without_the_part_is_not_named(void)
{
    stored.identify_inductance = false;
    TEST_ASSERT_NULL(strstr(start(), "warning"));
    TEST_ASSERT_EQUAL_INT(APPLICATION_SETTINGS_STORED, bench.application.settings_from);
}

static void test_a_rest_that_is_refused_is_refused_whole(void)
{
    stored.identify_inductance = true;
    stored.hold_on_enable_s = -1.0;
    TEST_ASSERT_NOT_NULL(strstr(start(), "\nwarning: the stored settings are not in force: "
                                         "hold_on_enable_s -1 s"));
    TEST_ASSERT_EQUAL_INT(APPLICATION_SETTINGS_DEFAULT, bench.application.settings_from);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_settings_of_parts_left_out_are_named_and_the_rest_is_in_force);
    RUN_TEST(test_what_is_as_it_is_without_the_part_is_not_named);
    RUN_TEST(test_a_rest_that_is_refused_is_refused_whole);
    return UNITY_END();
}
