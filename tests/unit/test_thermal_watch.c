/* What heat does to the current limit of a drive, whose interrupt is played: period, state, codes.
 */
#include "firmware/drive/thermal_watch.h"

#include <math.h>
#include <unity.h>

#include "firmware/drive/settings_in_motion.h"
#include "tests/unit/fake_board.h"
#include "tests/unit/num_assert.h"
#include "tests/unit/servo_frequency.h"

#define RATED_A 3.0
#define TAU_S   2.0
#define CODES   4096u

static struct drive drive;
static struct hal board;
static struct hal_facts facts;
static struct drive_settings settings;
static uint16_t bridge_code;

static uint16_t bridge_temperature(void *context)
{
    (void)context;
    return bridge_code;
}

static void watchdog_feed(void *context)
{
    (void)context;
}

static void start(void)
{
    char error[DRIVE_ERROR_TEXT] = "";

    TEST_ASSERT_TRUE_MESSAGE(drive_init(&drive, &board, &settings, error), error);
    drive.measurement.current_a = drive.measurement.current_b = drive.params.measurement.current;
    drive.supervision.period = 0;
    drive.supervision.state = DRIVE_OPERATION_ENABLED;
}

void setUp(void)
{
    facts = bench_facts;
    facts.encoder_counts_per_turn = 4000;
    facts.bridge_ntc_beta_K = 3435.0;
    board = fake_hal;
    board.facts = &facts;
    board.bridge_temperature = bridge_temperature;
    board.watchdog_feed = watchdog_feed;
    bridge_code = CODES / 2u;
    drive_settings_default(&settings, &bench_params);
    settings.current_limit_A = 1.5 * RATED_A;
    settings.motor_time_constant_s = TAU_S;
    start();
}

void tearDown(void)
{
}

static uint16_t code_of(double current_A)
{
    return (uint16_t)(2048.5 + current_A / facts.current_A_per_code);
}

/* A period with these currents; true: a fault is asked for. */
static bool period(double a_A, double b_A)
{
    drive.supervision.period++;
    drive.current_codes.a = code_of(a_A);
    drive.current_codes.b = code_of(b_A);
    thermal_watch_background(&drive);
    return drive.supervision.asked_for != DRIVE_FAULT_NONE;
}

static void pass(double time_s, double a_A, double b_A)
{
    for (int n = (int)(time_s / PERIOD_S + 0.5); n > 0; n--) {
        (void)period(a_A, b_A);
    }
}

static double limit_A(num_t limit)
{
    return num_to_double(limit) * drive.base.current_A;
}

static double law_limit_A(void)
{
    return limit_A(*position_law_current_limit(drive.params.position_law, &drive.params.law));
}

/* Until derating is said; less than 60 s. */
static double seconds_until_shown(double a_A, double b_A)
{
    int n = 0;

    while ((drive.thermal.shown & THERMAL_MOTOR_DERATES) == 0 && n < 600000) {
        (void)period(a_A, b_A);
        n++;
    }
    return n * PERIOD_S;
}

static void test_an_overload_of_one_phase_is_derated_when_its_winding_is_as_hot_as_rated(void)
{
    static const double overloads[] = {1.1, 1.3, 1.4, 1.5, 1.7};

    settings.motor_time_constant_s = 5.0;
    for (int i = 0; i < 5; i++) {
        const double k2 = overloads[i] * overloads[i];
        const double rated_s = 5.0 * log(k2 / (k2 - 1.0));
        const double derated_s = 5.0 * log(k2 / (k2 - 1.0225));

        start();
        const double shown_s = seconds_until_shown(0.0, -overloads[i] * RATED_A);

        TEST_ASSERT_DOUBLE_WITHIN(0.01 * derated_s + 0.03, derated_s, shown_s);
        TEST_ASSERT_TRUE(i == 0 || fabs(shown_s - rated_s) < 0.05 * rated_s);
    }
}

static void test_rated_current_of_both_phases_is_never_derated(void)
{
    pass(20.0 * TAU_S, 1.009 * RATED_A, -1.009 * RATED_A);
    TEST_ASSERT_EQUAL_UINT8(0, drive.thermal.shown);
    TEST_ASSERT_EQUAL_INT(DRIVE_FAULT_NONE, drive.supervision.asked_for);
    TEST_ASSERT_TRUE(law_limit_A() > 1.4999 * RATED_A);
    TEST_ASSERT_TRUE(drive.settings.current_limit_A == settings.current_limit_A);
}

/* Among them those whose peaks come back with the looks, 8 periods, or a whole part of them. */
static void test_a_turning_current_is_seen_as_it_is_at_any_speed(void)
{
    static const double per_period[] = {1.0 / 1024, 1.0 / 64, 1.0 / 32, 1.0 / 16, 0.0618,
                                        1.0 / 8,    3.0 / 16, 0.191,    1.0 / 5,  0.25 - 1e-5};

    for (int i = 0; i < 10; i++) {
        setUp();
        for (int n = 0; n < (int)(5.0 * TAU_S / PERIOD_S); n++) {
            const double angle = TWO_PI * per_period[i] * n + 0.4;

            (void)period(1.3 * RATED_A * cos(angle), 1.3 * RATED_A * sin(angle));
        }
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * 0.845, 0.845, num_to_double(drive.thermal.heat));
    }
}

static void test_the_limit_falls_in_small_steps_to_the_rated_current(void)
{
    double before_A = law_limit_A();

    for (int n = 0; n < (int)(6.0 * TAU_S / PERIOD_S); n++) {
        TEST_ASSERT_FALSE(period(0.0, law_limit_A()));
        TEST_ASSERT_TRUE(law_limit_A() > before_A - 0.21 * RATED_A / 2.0);
        before_A = law_limit_A();
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.05 * RATED_A, 1.03 * RATED_A, before_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, before_A, drive.settings.current_limit_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.99 * before_A,
                              limit_A(drive.synchronism.params.full_current));
}

/* Beside a hold current as large as rated. */
static void test_the_hold_keeps_its_current_and_loses_what_is_beside_it(void)
{
    const num_t held = drive.params.hold.current;

    TEST_ASSERT_DOUBLE_WITHIN(1e-3, RATED_A, limit_A(held));
    pass(8.0 * TAU_S, 1.06 * RATED_A, 0.0);
    TEST_ASSERT_EQUAL_UINT8(64, drive.thermal.motor_derated);
    TEST_ASSERT_TRUE(drive.params.hold.current == held);
    TEST_ASSERT_TRUE(limit_A(drive.params.hold.current_limit) < 0.03 * RATED_A);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * RATED_A, 1.008 * RATED_A, law_limit_A());
}

static void test_where_the_current_does_not_fall_the_bridge_opens(void)
{
    const double k2 = 1.5 * 1.5;
    const double expected_s = TAU_S * log(k2 / (k2 - 1.15));
    int n = 0;

    while (!period(1.5 * RATED_A, 0.0) && n < 600000) {
        n++;
    }
    TEST_ASSERT_EQUAL_INT(DRIVE_FAULT_MOTOR_OVERHEATED, drive.supervision.asked_for);
    TEST_ASSERT_DOUBLE_WITHIN(0.03 * expected_s, expected_s, n * PERIOD_S);
}

static void test_heat_outlasts_disable_and_new_settings_and_falls_meanwhile(void)
{
    char error[DRIVE_ERROR_TEXT];

    pass(0.5 * TAU_S, 1.5 * RATED_A, 0.0);
    const double begin = num_to_double(drive.thermal.heat);

    drive.supervision.state = DRIVE_SWITCH_ON_DISABLED;
    settings.current_limit_A = RATED_A;
    TEST_ASSERT_TRUE(drive_design(&drive, &settings, error));
    pass(0.5 * TAU_S, 1.5 * RATED_A, 0.0); /* what the codes were when the bridge opened */
    TEST_ASSERT_DOUBLE_WITHIN(0.03, begin * exp(-0.5), num_to_double(drive.thermal.heat));
}

static void test_cooled_it_has_the_limit_that_was_set(void)
{
    pass(1.0 * TAU_S, 1.4 * RATED_A, 0.0);
    TEST_ASSERT_TRUE(law_limit_A() < 1.3 * RATED_A);
    pass(1.0 * TAU_S, 0.0, 0.0);
    TEST_ASSERT_EQUAL_UINT8(0, drive.thermal.shown);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1.5 * RATED_A, law_limit_A());
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1.5 * RATED_A, limit_A(drive.params.hold.current_limit));
    TEST_ASSERT_TRUE(drive.settings.current_limit_A == settings.current_limit_A);
}

static void test_what_is_set_in_motion_is_derated_too(void)
{
    struct drive_settings wanted = settings;
    char error[DRIVE_ERROR_TEXT];

    pass(8.0 * TAU_S, 1.06 * RATED_A, 0.0);
    wanted.current_limit_A = 1.2 * RATED_A;
    TEST_ASSERT_TRUE(settings_in_motion_change(&drive, &wanted, error));
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * RATED_A, 1.003 * RATED_A, law_limit_A());
    pass(2.0 * TAU_S, 0.0, 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1.2 * RATED_A, law_limit_A());
}

static void test_a_time_constant_of_zero_watches_no_motor(void)
{
    settings.motor_time_constant_s = 0.0;
    start();
    pass(3.0, 1.7 * RATED_A, 1.7 * RATED_A);
    TEST_ASSERT_EQUAL_INT(DRIVE_FAULT_NONE, drive.supervision.asked_for);
    TEST_ASSERT_EQUAL_UINT8(0, drive.thermal.shown);
}

/* Of every law the limit that its design would give it, but for what it brakes with. */
static void test_every_law_is_derated(void)
{
    for (int law = 0; law < POSITION_LAW_COUNT; law++) {
        setUp();
        drive_settings_select_feedback(&settings, DRIVE_FEEDBACK_ENCODER);
        drive_settings_select_law(&settings, (enum position_law)law);
        give_servo_frequency(&settings, 100.0);
        settings.current_limit_A = 1.5 * RATED_A;
        start();
        if (law == POSITION_LAW_MICROSTEPPING) {
            TEST_ASSERT_NULL(position_law_current_limit((enum position_law)law, &drive.params.law));
            continue;
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1.5 * RATED_A, law_limit_A());
        pass(8.0 * TAU_S, 1.06 * RATED_A, 0.0);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * RATED_A, 1.008 * RATED_A, law_limit_A());
    }
}

static void heat_bridge(num_real bridge_C)
{
    bridge_code = (uint16_t)bridge_temperature_code(bridge_C, (num_real)3435.0, CODES);
    pass(0.06, 0.0, 0.0);
}

static void test_a_hot_bridge_takes_the_limit_evenly_and_opens_at_its_end(void)
{
    heat_bridge((num_real)79.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1.5 * RATED_A, law_limit_A());
    heat_bridge((num_real)90.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.12 * RATED_A, 0.75 * RATED_A, law_limit_A());
    TEST_ASSERT_DOUBLE_WITHIN(0.12 * RATED_A, 0.75 * RATED_A,
                              limit_A(drive.params.hold.current_limit));
    TEST_ASSERT_EQUAL_UINT8(THERMAL_BRIDGE_DERATES, drive.thermal.shown);
    heat_bridge((num_real)99.0);
    TEST_ASSERT_EQUAL_INT(DRIVE_FAULT_NONE, drive.supervision.asked_for);
    heat_bridge((num_real)100.5);
    TEST_ASSERT_EQUAL_INT(DRIVE_FAULT_BRIDGE_OVERHEATED, drive.supervision.asked_for);
    heat_bridge((num_real)60.0);
    TEST_ASSERT_EQUAL_UINT8(0, drive.thermal.shown);
}

static void test_a_limit_set_in_motion_is_derated_by_a_hot_bridge_alone(void)
{
    struct drive_settings wanted = settings;
    char error[DRIVE_ERROR_TEXT];

    heat_bridge((num_real)90.0);
    TEST_ASSERT_EQUAL_UINT8(0, drive.thermal.motor_derated);
    const double left_A = law_limit_A();

    wanted.current_limit_A = 1.2 * RATED_A;
    TEST_ASSERT_TRUE(settings_in_motion_change(&drive, &wanted, error));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * RATED_A, 0.8 * left_A, law_limit_A());
    TEST_ASSERT_TRUE(limit_A(drive.params.hold.current_limit) < 1.0 * RATED_A);
}

/* That begins where the bridge is open: there is no derating. */
static void test_a_derating_that_begins_too_late_leaves_the_fault_where_it_is(void)
{
    settings.bridge_derate_C = 120.0;
    start();
    heat_bridge((num_real)99.0);
    TEST_ASSERT_EQUAL_INT(DRIVE_FAULT_NONE, drive.supervision.asked_for);
    heat_bridge((num_real)101.0);
    TEST_ASSERT_EQUAL_INT(DRIVE_FAULT_BRIDGE_OVERHEATED, drive.supervision.asked_for);
}

static void test_a_sensor_that_is_broken_is_said_and_takes_nothing(void)
{
    static const uint16_t broken[] = {0, 4095};

    for (int i = 0; i < 2; i++) {
        bridge_code = broken[i];
        pass(0.06, 0.0, 0.0);
        TEST_ASSERT_EQUAL_UINT8(THERMAL_NO_SENSOR, drive.thermal.shown);
        TEST_ASSERT_EQUAL_INT(DRIVE_FAULT_NONE, drive.supervision.asked_for);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1.5 * RATED_A, law_limit_A());
    }
    heat_bridge((num_real)40.0);
    TEST_ASSERT_EQUAL_UINT8(0, drive.thermal.shown);
}

static void test_a_board_without_sensor_is_not_asked_and_watches_the_motor_all_the_same(void)
{
    facts.bridge_ntc_beta_K = 0.0;
    board.bridge_temperature = NULL;
    start();
    TEST_ASSERT_TRUE(seconds_until_shown(1.5 * RATED_A, 0.0) < 1.3 * TAU_S);
}

static void test_a_bridge_that_is_watched_no_more_gives_back_what_it_took(void)
{
    char error[DRIVE_ERROR_TEXT];

    heat_bridge((num_real)90.0);
    TEST_ASSERT_TRUE(law_limit_A() < 1.0 * RATED_A);
    settings.bridge_fault_C = 0.0;
    drive.supervision.state = DRIVE_SWITCH_ON_DISABLED;
    TEST_ASSERT_TRUE_MESSAGE(drive_design(&drive, &settings, error), error);
    drive.supervision.state = DRIVE_OPERATION_ENABLED;
    pass(0.06, 0.0, 0.0);
    TEST_ASSERT_EQUAL_UINT8(0, drive.thermal.bridge_derated);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1.5 * RATED_A, law_limit_A());
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1.5 * RATED_A, limit_A(drive.params.hold.current_limit));
}

static void test_a_motor_that_is_warm_begins_there(void)
{
    settings.cold_resistance_ohm = bench_params.resistance_ohm / (1.0 + 0.00393 * 60.0);
    start();
    winding_set_resistance(
        &drive.estimator.estimate.winding, &drive.params.model,
        num_from_double(bench_params.resistance_ohm / drive.base.resistance_ohm));
    pass(0.06, 0.0, 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 0.75, num_to_double(drive.thermal.heat));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_an_overload_of_one_phase_is_derated_when_its_winding_is_as_hot_as_rated);
    RUN_TEST(test_rated_current_of_both_phases_is_never_derated);
    RUN_TEST(test_a_turning_current_is_seen_as_it_is_at_any_speed);
    RUN_TEST(test_the_limit_falls_in_small_steps_to_the_rated_current);
    RUN_TEST(test_the_hold_keeps_its_current_and_loses_what_is_beside_it);
    RUN_TEST(test_where_the_current_does_not_fall_the_bridge_opens);
    RUN_TEST(test_heat_outlasts_disable_and_new_settings_and_falls_meanwhile);
    RUN_TEST(test_cooled_it_has_the_limit_that_was_set);
    RUN_TEST(test_what_is_set_in_motion_is_derated_too);
    RUN_TEST(test_a_time_constant_of_zero_watches_no_motor);
    RUN_TEST(test_every_law_is_derated);
    RUN_TEST(test_a_hot_bridge_takes_the_limit_evenly_and_opens_at_its_end);
    RUN_TEST(test_a_limit_set_in_motion_is_derated_by_a_hot_bridge_alone);
    RUN_TEST(test_a_derating_that_begins_too_late_leaves_the_fault_where_it_is);
    RUN_TEST(test_a_sensor_that_is_broken_is_said_and_takes_nothing);
    RUN_TEST(test_a_board_without_sensor_is_not_asked_and_watches_the_motor_all_the_same);
    RUN_TEST(test_a_bridge_that_is_watched_no_more_gives_back_what_it_took);
    RUN_TEST(test_a_motor_that_is_warm_begins_there);
    return UNITY_END();
}
