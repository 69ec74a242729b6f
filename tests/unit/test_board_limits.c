/* What a board's sensing and the supply refuse, set and state. */
#include "firmware/drive/board_limits.h"

#include <math.h>
#include <string.h>

#include <unity.h>

#include "tests/unit/bench.h"

static struct drive_settings settings;
static struct hal_facts facts;
static char error[DRIVE_ERROR_TEXT];

void setUp(void)
{
    drive_settings_default(&settings, &bench_params);
    facts = bench_facts;
    error[0] = '\0';
}

void tearDown(void)
{
}

static void with_motor(double rated_current_A, double supply_V)
{
    struct motor_params motor = bench_params;

    motor.rated_current_A = rated_current_A;
    motor.supply_V = supply_V;
    drive_settings_default(&settings, &motor);
}

static void accepted(void)
{
    TEST_ASSERT_TRUE_MESSAGE(board_limits_apply(&settings, &facts, error), error);
}

static void refused(const char *text)
{
    TEST_ASSERT_FALSE_MESSAGE(board_limits_apply(&settings, &facts, error), text);
    TEST_ASSERT_EQUAL_STRING(text, error);
}

/* 31.2 V over 4096 codes: 1.29 x 24.17 V is the last code but one. */
static void test_a_supply_whose_over_voltage_the_board_cannot_see_is_refused(void)
{
    with_motor(3.0, 24.17);
    accepted();
    with_motor(3.0, 24.19);
    refused(
        "supply_V 24.19 V: must be at most 24.17 V, over-voltage is 1.29 times as much, and the "
        "board measures up to 31.19 V");
    with_motor(3.0, 48.0);
    refused("supply_V 48 V: must be at most 24.17 V, over-voltage is 1.29 times as much, and the "
            "board measures up to 31.19 V");
}

static void test_a_rated_current_without_room_for_the_trip_is_refused(void)
{
    with_motor(4.79, 24.0);
    accepted();
    with_motor(4.8, 24.0);
    refused("rated_current_A 4.8 A: must be at most 4.795 A, 0.8 of the +-5.994 A that the board "
            "measures");
}

/* A motor of 5 A, held to less by the user. */
static void test_a_current_limit_that_is_given_counts_instead_of_the_rated_current(void)
{
    with_motor(5.0, 24.0);
    settings.current_limit_A = 4.0;
    accepted();
    settings.current_limit_A = 5.9;
    refused("current_limit_A 5.9 A: must be at most 5.874 A, 0.98 of the +-5.994 A that the board "
            "measures");
}

static void test_a_trip_that_is_not_given_follows_from_motor_and_board(void)
{
    accepted();
    TEST_ASSERT_EQUAL_DOUBLE(1.8 * 3.0, settings.overcurrent_trip_A);
    with_motor(4.0, 24.0); /* 7.2 A are beyond the board */
    accepted();
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.98 * 2046.0 * 12.0 / 4096.0, settings.overcurrent_trip_A);
}

static void test_a_trip_that_is_given_stays_or_is_refused(void)
{
    settings.overcurrent_trip_A = 5.99;
    accepted();
    TEST_ASSERT_EQUAL_DOUBLE(5.99, settings.overcurrent_trip_A);
    settings.overcurrent_trip_A = 6.0;
    refused("overcurrent_trip_A 6 A: must be at most 5.994 A, the board measures +-5.994 A");
}

/* The nearer end of the codes counts. */
static void test_a_zero_beside_the_middle_of_the_codes_takes_from_the_range(void)
{
    settings.overcurrent_trip_A = 5.0;
    facts.current_zero_code = 1700;
    refused("overcurrent_trip_A 5 A: must be at most 4.978 A, the board measures +-4.978 A");
    facts.current_zero_code = 4095 - 1700;
    refused("overcurrent_trip_A 5 A: must be at most 4.978 A, the board measures +-4.978 A");
    facts.converter_codes = 65536;
    facts.current_zero_code = 32768;
    accepted();
}

static double speed_limit(enum drive_feedback feedback)
{
    settings.feedback = feedback;
    return board_limits_speed(&settings, &bench_facts).rad_s;
}

/* 0.92 x 24 V = (0.157 + 0.37 x 0.000307 / 0.157) w. */
static void test_reference_speeds_end_where_back_emf_and_friction_take_the_supply(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 139.99, speed_limit(DRIVE_FEEDBACK_ENCODER));
    TEST_ASSERT_EQUAL_STRING("where the back-EMF takes up the supply",
                             board_limits_speed(&settings, &bench_facts).reason);
}

/* A rotor that lags for want of voltage is lost. With 1.05 A beside it:
   0.92 x 24 V = 0.37 x 1.05 + |0.1577 + j 50 x 0.9e-3 x 1.05| w. */
static void test_without_an_encoder_a_default_ramp_is_to_be_driven_there(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 131.74, speed_limit(DRIVE_FEEDBACK_SENSORLESS));
    settings.motor.inductance_H *= 4.0;
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 88.12, speed_limit(DRIVE_FEEDBACK_SENSORLESS));
}

/* 2 pi / 50 / 5 in 0.1 ms: of the 0.24 that are sampled a rotor that swings takes the rest. */
static void test_reference_speeds_end_at_a_fifth_of_an_electrical_turn_in_a_period(void)
{
    settings.motor.supply_V = 60.0;
    settings.speed_limit_rad_s = default_speed_limit_rad_s(&settings.motor);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 251.33, speed_limit(DRIVE_FEEDBACK_ENCODER));
    TEST_ASSERT_EQUAL_STRING("a fifth of an electrical turn in a period",
                             board_limits_speed(&settings, &bench_facts).reason);
    settings.speed_limit_rad_s *= 1.1;
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 251.33, speed_limit(DRIVE_FEEDBACK_ENCODER));
}

static void test_a_speed_limit_that_is_lower_or_widened_by_hand_counts_instead(void)
{
    settings.speed_limit_rad_s = 100.0;
    TEST_ASSERT_EQUAL_DOUBLE(100.0, board_limits_speed(&settings, &bench_facts).rad_s);
    TEST_ASSERT_EQUAL_STRING("limit of the drive",
                             board_limits_speed(&settings, &bench_facts).reason);
    settings.speed_limit_rad_s = 150.0;
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 131.74, board_limits_speed(&settings, &bench_facts).rad_s);
    settings.speed_limit_rad_s = 200.0;
    TEST_ASSERT_EQUAL_DOUBLE(200.0, board_limits_speed(&settings, &bench_facts).rad_s);
}

/* A bridge that has to be low for longer leaves no modulation. */
static void test_a_low_state_beyond_a_fifth_of_the_period_is_refused(void)
{
    facts.low_state_s = 20e-6;
    accepted();
    facts.low_state_s = 20.1e-6;
    refused("low_state_s 2.01e-05 s: must be at most 2e-05 s, a fifth of the control period, "
            "0.0001 s");
}

/* A code of 2.93 mA through the winding of a NEMA 11, 6.8 ohm, and its bridge. */
static void test_the_blind_speed_is_that_whose_back_emf_the_offset_covers(void)
{
    settings.motor.resistance_ohm = 6.8;
    settings.motor.torque_constant_Nm_A = 0.1;
    facts.bridge_resistance_ohm = 0.2;
    facts.current_offset_codes = 1.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 12.0 / 4096.0 * 7.0 / 0.1,
                              drive_blind_speed_rad_s(&settings, &facts));
    facts.current_offset_codes = 4.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 4.0 * 12.0 / 4096.0 * 7.0 / 0.1,
                              drive_blind_speed_rad_s(&settings, &facts));
}

static void test_with_an_encoder_no_speed_is_blind(void)
{
    drive_settings_select_feedback(&settings, DRIVE_FEEDBACK_ENCODER);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, drive_blind_speed_rad_s(&settings, &facts));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_supply_whose_over_voltage_the_board_cannot_see_is_refused);
    RUN_TEST(test_a_rated_current_without_room_for_the_trip_is_refused);
    RUN_TEST(test_a_current_limit_that_is_given_counts_instead_of_the_rated_current);
    RUN_TEST(test_a_trip_that_is_not_given_follows_from_motor_and_board);
    RUN_TEST(test_a_trip_that_is_given_stays_or_is_refused);
    RUN_TEST(test_a_zero_beside_the_middle_of_the_codes_takes_from_the_range);
    RUN_TEST(test_reference_speeds_end_where_back_emf_and_friction_take_the_supply);
    RUN_TEST(test_without_an_encoder_a_default_ramp_is_to_be_driven_there);
    RUN_TEST(test_reference_speeds_end_at_a_fifth_of_an_electrical_turn_in_a_period);
    RUN_TEST(test_a_speed_limit_that_is_lower_or_widened_by_hand_counts_instead);
    RUN_TEST(test_a_low_state_beyond_a_fifth_of_the_period_is_refused);
    RUN_TEST(test_the_blind_speed_is_that_whose_back_emf_the_offset_covers);
    RUN_TEST(test_with_an_encoder_no_speed_is_blind);
    return UNITY_END();
}
