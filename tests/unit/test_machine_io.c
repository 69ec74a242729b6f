/* Switches on wires, and what the drive does for them; on the console and on the bus. */
#include <stdlib.h>

#include "firmware/application/machine_io.h"
#include "firmware/link/axis_motion.h"
#include "tests/unit/link_bench.h"

enum { TURN = 65536, LIMITED = 0x0800, REACHED = 0x0400, FAILED = 0x2000, HOMING_BITS = 0x3400 };

enum { LIMITS = HAL_INPUT_LIMIT_MINUS | HAL_INPUT_LIMIT_PLUS };

/* Open switches are high; limits and quick stop are active high here, as of a broken wire. */
static void start(int used, double brake_s)
{
    struct drive_settings settings = bench_quick_settings();

    settings.inputs_used = used;
    settings.holding_brake_s = brake_s;
    bench_power_up();
    TEST_ASSERT_TRUE(bench_start(&settings));
    application_put_link(&bench.application, &bench_link);
    bench.inputs = HAL_INPUT_ENABLE;
    bench_periods(40);
    (void)bench_heard();
}

void setUp(void)
{
    start(HAL_INPUTS, 0.0);
}

void tearDown(void)
{
}

static const char *say(const char *line, int periods)
{
    (void)bench_heard();
    bench_type(line);
    bench_type("\n");
    bench_periods(periods);
    return bench_heard();
}

static void is_heard(const char *part, const char *heard)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(heard, part), heard);
}

static struct drive_signals now(void)
{
    struct drive_signals signals;

    drive_signals_read(&bench.application.drive, &signals);
    return signals;
}

/* Whole: the cores' library prints no doubles. */
static void go(int speed_rad_s, int periods)
{
    char line[100];

    snprintf(line, sizeof line, "velocity speed_rad_s=%d acceleration_rad_s2=200 jerk_rad_s3=20000",
             speed_rad_s);
    is_heard("ok velocity", say(line, periods));
}

static void put(unsigned index, unsigned sub, unsigned bytes, uint32_t value)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(index, sub, bytes, value));
}

static void enable_on_bus(int mode)
{
    link_bench_open();
    (void)link_bench_say("t00020101", 1);
    put(0x6060, 0, 1, (uint32_t)mode);
    put(0x6040, 0, 2, 0x06);
    bench_periods(20);
    put(0x6040, 0, 2, 0x0f);
    bench_periods(40);
    TEST_ASSERT_EQUAL_HEX32(0x27, link_bench_get(0x6041, 0) & 0x6fu);
}

/* ---- limit switches ---- */

static void moves_until_the_limit(int speed_rad_s, uint32_t limit, const char *said)
{
    is_heard("ok enable", say("enable", 40));
    go(speed_rad_s, 2000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, speed_rad_s, now().omega_ref_rad_s);
    (void)bench_heard();
    bench.inputs |= limit;
    bench_periods(30);
    TEST_ASSERT_TRUE(fabs(now().omega_ref_rad_s) < abs(speed_rad_s));
    bench_periods(2000);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, now().omega_ref_rad_s);
    is_heard(said, bench_heard());
}

static void test_a_limit_switch_stops_and_lets_back_alone(void)
{
    moves_until_the_limit(5, HAL_INPUT_LIMIT_PLUS, "warning: stop: the limit switch + is active\n");
    is_heard("error: the limit switch + is active",
             say("velocity speed_rad_s=1 acceleration_rad_s2=200 jerk_rad_s3=20000", 20));
    is_heard("error: the limit switch + is active", say("move 100", 20));
    is_heard("error: the limit switch + is active",
             say("sine amplitude_rad=0.1 frequency_Hz=1", 20));
    go(-5, 2000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -5.0, now().omega_ref_rad_s);
    bench.inputs &= ~(uint32_t)HAL_INPUT_LIMIT_PLUS;
    bench_periods(30);
    go(5, 2000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 5.0, now().omega_ref_rad_s);
}

static void test_the_other_limit_switch_stops_the_other_way(void)
{
    moves_until_the_limit(-5, HAL_INPUT_LIMIT_MINUS,
                          "warning: stop: the limit switch - is active\n");
    is_heard("error: the limit switch - is active", say("move -100", 20));
    is_heard("ok move", say("move 1", 20));
}

/* It turns round in mid-motion: towards the other one, which is active, too. */
static void test_both_limit_switches_stop_a_motion_that_turns_round(void)
{
    moves_until_the_limit(5, HAL_INPUT_LIMIT_PLUS, "limit switch +");
    go(-5, 2000);
    bench.inputs |= LIMITS;
    bench_periods(2000);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, now().omega_ref_rad_s);
    is_heard("limit switch -", bench_heard());
}

static void test_a_level_counts_when_it_lasts(void)
{
    is_heard("ok enable", say("enable", 40));
    go(5, 2000);
    bench.inputs |= LIMITS;
    bench_periods(9);
    bench.inputs &= ~(uint32_t)LIMITS;
    bench_periods(100);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 5.0, now().omega_ref_rad_s);
}

static void test_what_is_not_wired_is_not_obeyed_and_levels_have_their_polarity(void)
{
    start(0, 0.0);
    bench.inputs = LIMITS | HAL_INPUT_QUICK_STOP;
    bench_periods(40);
    is_heard("ok enable", say("enable", 40));
    go(5, 2000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 5.0, now().omega_ref_rad_s);
    start(HAL_INPUT_LIMIT_PLUS, 0.0);
    bench.application.chosen.inputs_low = HAL_INPUT_LIMIT_PLUS;
    bench_periods(40);
    is_heard("ok enable", say("enable", 40));
    is_heard("error: the limit switch +", say("move 1", 20));
    bench.inputs |= HAL_INPUT_LIMIT_PLUS;
    bench_periods(40);
    is_heard("ok move", say("move 1", 20));
}

static void test_a_limit_switch_on_the_bus_is_said_and_shown(void)
{
    enable_on_bus(3);
    put(0x60ff, 0, 4, TURN);
    bench_periods(4000);
    (void)bench_heard();
    bench.inputs |= HAL_INPUT_LIMIT_PLUS;
    bench_periods(40);
    is_heard("t08181286", bench_heard()); /* 8612h */
    bench_periods(4000);
    TEST_ASSERT_TRUE(axis_motion_rests(&bench.application));
    TEST_ASSERT_EQUAL_HEX32(LIMITED, link_bench_get(0x6041, 0) & LIMITED);
    TEST_ASSERT_EQUAL_HEX32(0x0a, link_bench_get(0x60fd, 0));
    put(0x60ff, 0, 4, (uint32_t)-TURN);
    bench_periods(4000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -TWO_PI, now().omega_ref_rad_s);
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(0x6041, 0) & LIMITED);
    put(0x60ff, 0, 4, 0);
    bench_periods(3000);
    put(0x6060, 0, 1, 1);
    bench_periods(20);
    put(0x607a, 0, 4, 1000 * TURN);
    put(0x6040, 0, 2, 0x1f);
    bench_periods(100);
    TEST_ASSERT_EQUAL_HEX32(LIMITED, link_bench_get(0x6041, 0) & LIMITED);
    TEST_ASSERT_TRUE(axis_motion_rests(&bench.application));
}

/* A cam, or contacts that bounce: who passes a limit switch is behind it. */
static void pass_limit_switch(void)
{
    bench.inputs |= HAL_INPUT_LIMIT_PLUS;
    bench_periods(60);
    is_heard("t08181286210000000000\r", bench_heard());
    TEST_ASSERT_EQUAL_HEX32(0x21, link_bench_get(0x1001, 0));
    bench.inputs &= ~(uint32_t)HAL_INPUT_LIMIT_PLUS;
    bench_periods(4000);
    is_heard("t08180000000000000000\r", bench_heard());
    TEST_ASSERT_TRUE(axis_motion_rests(&bench.application));
    TEST_ASSERT_EQUAL_HEX32(LIMITED, link_bench_get(0x6041, 0) & LIMITED);
}

static void test_a_speed_that_a_limit_switch_has_ended_does_not_come_back(void)
{
    enable_on_bus(3);
    for (int again = 0; again < 2; again++) {
        put(0x60ff, 0, 4, TURN);
        bench_periods(4000);
        pass_limit_switch();
        put(0x60ff, 0, 4, 2 * TURN); /* nor another one that way */
        bench_periods(1000);
        TEST_ASSERT_TRUE(axis_motion_rests(&bench.application));
        put(0x60ff, 0, 4, again == 0 ? 0 : (uint32_t)-TURN);
        bench_periods(4000);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, again == 0 ? 0.0 : -TWO_PI, now().omega_ref_rad_s);
        TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(0x6041, 0) & LIMITED);
    }
}

static void test_a_target_that_waits_behind_a_limit_switch_is_dropped(void)
{
    enable_on_bus(1);
    put(0x607a, 0, 4, 10 * TURN);
    put(0x6040, 0, 2, 0x1f);
    put(0x6040, 0, 2, 0x0f);
    put(0x607a, 0, 4, 20 * TURN);
    put(0x6040, 0, 2, 0x1f);
    put(0x6040, 0, 2, 0x0f);
    bench_periods(2000);
    pass_limit_switch();
    const double end_rad = now().theta_ref_rad;

    TEST_ASSERT_TRUE(end_rad < 9.0 * TWO_PI);
    put(0x607a, 0, 4, TURN); /* a new one is gone to */
    put(0x6040, 0, 2, 0x1f);
    bench_periods(20000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, TWO_PI, now().theta_ref_rad);
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(0x6041, 0) & LIMITED);
}

static void stream(int count, int32_t *target, int32_t step)
{
    for (int i = 0; i < count; i++) {
        *target += step;
        put(0x607a, 0, 4, (uint32_t)*target);
        bench_periods(37); /* and what the request takes */
    }
}

static void test_no_cyclic_target_behind_a_limit_switch_is_followed(void)
{
    int32_t target = 0;

    enable_on_bus(8);
    stream(100, &target, 200);
    TEST_ASSERT_FALSE(axis_motion_rests(&bench.application));
    pass_limit_switch();
    const double end_rad = now().theta_ref_rad;

    target = TURN;
    stream(100, &target, 200);
    TEST_ASSERT_EQUAL_DOUBLE(end_rad, now().theta_ref_rad);
    TEST_ASSERT_EQUAL_HEX32(LIMITED, link_bench_get(0x6041, 0) & LIMITED);
    target = (int32_t)(end_rad / TWO_PI * TURN);
    stream(100, &target, -200);
    TEST_ASSERT_TRUE(now().theta_ref_rad < end_rad - 0.1);
    stream(20, &target, 200);
    TEST_ASSERT_FALSE(axis_motion_rests(&bench.application));
}

/* The master falls silent, as it may when it hears of the switch. */
static void test_a_stream_that_ends_at_a_limit_switch_stays_there(void)
{
    int32_t target = 0;

    enable_on_bus(8);
    stream(100, &target, 200);
    bench.inputs |= HAL_INPUT_LIMIT_PLUS;
    bench_periods(30);
    stream(1, &target, 200); /* while it brakes */
    bench.inputs &= ~(uint32_t)HAL_INPUT_LIMIT_PLUS;
    bench_periods(4000);
    const double end_rad = now().theta_ref_rad;

    TEST_ASSERT_TRUE(end_rad > 0.9 * target / TURN * TWO_PI - 0.3);
    bench_periods(20000);
    TEST_ASSERT_EQUAL_DOUBLE(end_rad, now().theta_ref_rad);
}

/* Nor lets a halt, or another mode for a moment, go on what a switch has ended. */
static void test_a_halt_does_not_free_the_way(void)
{
    enable_on_bus(3);
    put(0x60ff, 0, 4, TURN);
    bench_periods(4000);
    pass_limit_switch();
    put(0x6040, 0, 2, 0x10f);
    bench_periods(100);
    put(0x6040, 0, 2, 0x0f);
    bench_periods(2000);
    TEST_ASSERT_TRUE(axis_motion_rests(&bench.application));

    setUp();
    enable_on_bus(1);
    put(0x607a, 0, 4, 10 * TURN);
    put(0x6040, 0, 2, 0x1f);
    bench_periods(3000);
    bench.inputs |= HAL_INPUT_LIMIT_PLUS;
    bench_periods(60);
    TEST_ASSERT_FALSE(axis_motion_rests(&bench.application));
    put(0x6040, 0, 2, 0x10f);
    bench.inputs &= ~(uint32_t)HAL_INPUT_LIMIT_PLUS;
    bench_periods(4000);
    put(0x6040, 0, 2, 0x0f);
    const double end_rad = now().theta_ref_rad;

    bench_periods(8000);
    TEST_ASSERT_EQUAL_DOUBLE(end_rad, now().theta_ref_rad);
}

static void test_a_homing_that_a_limit_switch_ends_is_an_error(void)
{
    enable_on_bus(6);
    put(0x6098, 0, 1, (uint8_t)-2);
    put(0x6040, 0, 2, 0x1f);
    bench_periods(2000);
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(0x6041, 0) & HOMING_BITS);
    pass_limit_switch();
    TEST_ASSERT_EQUAL_HEX32(REACHED | FAILED, link_bench_get(0x6041, 0) & HOMING_BITS);
}

/* ---- quick stop, enable ---- */

/* At rest nothing brakes, and the bridge is off all the same. */
static void test_what_switches_off_at_rest_is_said_on_the_bus(void)
{
    static const struct {
        uint32_t inputs;
        const char *said;
    } causes[] = {{HAL_INPUT_ENABLE | HAL_INPUT_QUICK_STOP, "t08184154210000000000\r"},
                  {0, "t08184254210000000000\r"}};

    for (size_t i = 0; i < 2; i++) {
        setUp();
        enable_on_bus(1);
        (void)bench_heard();
        bench.inputs = causes[i].inputs;
        bench_periods(4000);
        const char *heard = bench_heard();

        is_heard(causes[i].said, heard);
        TEST_ASSERT_EQUAL_INT(1, link_bench_count("t0818", heard));
        TEST_ASSERT_EQUAL(DRIVE_SWITCH_ON_DISABLED, now().state);
        bench.inputs = HAL_INPUT_ENABLE;
        bench_periods(60);
        is_heard("t08180000000000000000\r", bench_heard());
    }
}

static void test_a_quick_stop_input_stops_and_refuses_to_move(void)
{
    moves_until_the_limit(5, HAL_INPUT_QUICK_STOP,
                          "warning: stop: the quick stop input is active\n");
    is_heard("error: the quick stop input is active", say("move -1", 20));
    TEST_ASSERT_EQUAL(DRIVE_OPERATION_ENABLED, now().state);
    bench.inputs = HAL_INPUT_ENABLE;
    bench_periods(30);
    is_heard("ok move", say("move -1", 20));
}

static void test_a_quick_stop_input_on_the_bus_is_the_profile_s_quick_stop(void)
{
    enable_on_bus(3);
    put(0x60ff, 0, 4, TURN);
    bench_periods(4000);
    (void)bench_heard();
    bench.inputs |= HAL_INPUT_QUICK_STOP;
    bench_periods(40);
    is_heard("t08184154", bench_heard()); /* 5441h */
    TEST_ASSERT_EQUAL_HEX32(0x07, link_bench_get(0x6041, 0) & 0x6fu);
    bench_periods(8000);
    TEST_ASSERT_EQUAL_HEX32(0x40, link_bench_get(0x6041, 0) & 0x4fu);
    TEST_ASSERT_EQUAL_HEX32(0x10008, link_bench_get(0x60fd, 0));
    put(0x6040, 0, 2, 0x06); /* in vain while it lasts */
    bench_periods(20);
    TEST_ASSERT_EQUAL_HEX32(0x40, link_bench_get(0x6041, 0) & 0x4fu);
    bench.inputs = HAL_INPUT_ENABLE;
    bench_periods(40);
    TEST_ASSERT_EQUAL_HEX32(0x21, link_bench_get(0x6041, 0) & 0x6fu);
}

static void test_nothing_is_enabled_without_the_enable_input(void)
{
    bench.inputs = 0;
    bench_periods(40);
    is_heard("error: the enable input is not active", say("enable", 40));
    TEST_ASSERT_EQUAL(DRIVE_SWITCH_ON_DISABLED, now().state);
    bench.inputs = HAL_INPUT_ENABLE;
    bench_periods(40);
    is_heard("ok enable", say("enable", 40));
    TEST_ASSERT_EQUAL(DRIVE_OPERATION_ENABLED, now().state);
    bench.inputs = 0; /* at rest: off at once */
    bench_periods(60);
    TEST_ASSERT_EQUAL(DRIVE_SWITCH_ON_DISABLED, now().state);
}

static void test_an_enable_input_that_goes_stops_then_switches_off(void)
{
    is_heard("ok enable", say("enable", 40));
    go(5, 2000);
    bench.inputs = 0;
    bench_periods(40);
    TEST_ASSERT_EQUAL(DRIVE_OPERATION_ENABLED, now().state);
    TEST_ASSERT_TRUE(now().omega_ref_rad_s < 5.0);
    is_heard("error: the enable input is not active", say("move 1", 20));
    bench_periods(3000);
    TEST_ASSERT_EQUAL(DRIVE_SWITCH_ON_DISABLED, now().state);
}

static void test_an_enable_input_that_goes_on_the_bus_is_a_quick_stop_then_off(void)
{
    enable_on_bus(3);
    put(0x605a, 0, 2, 6); /* would stay */
    put(0x60ff, 0, 4, TURN);
    bench_periods(4000);
    (void)bench_heard();
    bench.inputs = 0;
    bench_periods(40);
    is_heard("t08184254", bench_heard()); /* 5442h */
    TEST_ASSERT_EQUAL_HEX32(0x07, link_bench_get(0x6041, 0) & 0x6fu);
    bench_periods(8000);
    TEST_ASSERT_EQUAL(DRIVE_SWITCH_ON_DISABLED, now().state);
    put(0x6040, 0, 2, 0x00);
    put(0x6040, 0, 2, 0x06);
    put(0x6040, 0, 2, 0x07);
    bench_periods(100);
    TEST_ASSERT_EQUAL(DRIVE_SWITCH_ON_DISABLED, now().state);
}

/* ---- outputs ---- */

static uint32_t outputs(void)
{
    bench_periods(12);
    return bench.outputs;
}

static void test_outputs_show_alarm_and_position(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, outputs());
    is_heard("ok enable", say("enable", 200));
    is_heard("ok step", say("step 0.016", 200));
    TEST_ASSERT_EQUAL_HEX32(HAL_OUTPUT_IN_POSITION | HAL_OUTPUT_BRAKE, outputs());
    go(5, 500);
    TEST_ASSERT_EQUAL_HEX32(HAL_OUTPUT_BRAKE, outputs());
    bench.samples.bus_voltage = 0;
    TEST_ASSERT_EQUAL_HEX32(HAL_OUTPUT_ALARM, outputs());
    bench.application.chosen.outputs_low = HAL_OUTPUTS;
    TEST_ASSERT_EQUAL_HEX32(HAL_OUTPUT_IN_POSITION | HAL_OUTPUT_BRAKE, outputs());
}

/* Without a motor its estimate is 0.016 rad off the reference that it is enabled with. */
static void test_a_rotor_off_its_reference_is_not_in_position(void)
{
    is_heard("ok enable", say("enable", 200));
    TEST_ASSERT_EQUAL_HEX32(0, outputs() & HAL_OUTPUT_IN_POSITION);
    is_heard("ok step", say("step 0.02", 200));
    TEST_ASSERT_EQUAL_HEX32(HAL_OUTPUT_IN_POSITION, outputs() & HAL_OUTPUT_IN_POSITION);
    is_heard("ok step", say("step 0.03", 200));
    TEST_ASSERT_EQUAL_HEX32(0, outputs() & HAL_OUTPUT_IN_POSITION);
}

static void test_the_brake_is_released_behind_the_current_and_engages_before_it_goes(void)
{
    start(0, 0.1);
    is_heard("ok enable", say("enable", 13)); /* enabled in the tenth period */
    TEST_ASSERT_EQUAL(DRIVE_OPERATION_ENABLED, now().state);
    for (int i = 0; i < 8; i++) { /* hold_ramp_s: 10 ms */
        TEST_ASSERT_EQUAL_HEX32(0, outputs() & HAL_OUTPUT_BRAKE);
    }
    bench_periods(20);
    TEST_ASSERT_EQUAL_HEX32(HAL_OUTPUT_BRAKE, outputs() & HAL_OUTPUT_BRAKE);
    is_heard("ok disable", say("disable", 20));
    TEST_ASSERT_EQUAL_HEX32(0, outputs() & HAL_OUTPUT_BRAKE);
    bench_periods(900);
    TEST_ASSERT_EQUAL(DRIVE_OPERATION_ENABLED, now().state);
    bench_periods(100);
    TEST_ASSERT_EQUAL(DRIVE_SWITCH_ON_DISABLED, now().state);
    TEST_ASSERT_FALSE(bench.application.io.engages);
}

static void test_the_brake_engages_on_the_bus_too(void)
{
    start(0, 0.1);
    enable_on_bus(1);
    bench_periods(200);
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(0x60fe, 1));
    put(0x6040, 0, 2, 0x06);
    bench_periods(20);
    TEST_ASSERT_EQUAL_HEX32(1, link_bench_get(0x60fe, 1) & 1u);
    TEST_ASSERT_EQUAL(DRIVE_OPERATION_ENABLED, now().state);
    put(0x6040, 0, 2, 0x0f); /* comes too early: what is going off goes off first */
    bench_periods(400);
    TEST_ASSERT_EQUAL_HEX32(1, link_bench_get(0x60fe, 1) & 1u);
    bench_periods(1500);
    TEST_ASSERT_EQUAL_HEX32(0x27, link_bench_get(0x6041, 0) & 0x6fu);
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(0x60fe, 1) & 1u);
}

static void test_a_fault_engages_the_brake_at_once(void)
{
    start(0, 1.0);
    is_heard("ok enable", say("enable", 200));
    TEST_ASSERT_EQUAL_HEX32(HAL_OUTPUT_BRAKE, outputs() & HAL_OUTPUT_BRAKE);
    bench.samples.bus_voltage = 0;
    TEST_ASSERT_EQUAL_HEX32(HAL_OUTPUT_ALARM, outputs());
}

static void test_a_board_without_inputs_has_none_to_be_used(void)
{
    struct drive_settings settings = bench_quick_settings();
    char error[DRIVE_ERROR_TEXT] = "";
    static struct hal_facts facts;

    facts = bench_stored_facts();
    struct hal board = bench_board(&facts);

    board.inputs_read = NULL;
    settings.inputs_used = 1;
    bench_power_up();
    TEST_ASSERT_FALSE(application_init_with(&bench.application, &board, &settings, error));
    is_heard("inputs_used, holding_brake_s: this board has no such pins, expected 0", error);
    settings.inputs_used = 0;
    TEST_ASSERT_TRUE(application_init_with(&bench.application, &board, &settings, error));
    is_heard("ok enable", say("enable", 200));
    TEST_ASSERT_EQUAL(DRIVE_OPERATION_ENABLED, now().state);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_limit_switch_stops_and_lets_back_alone);
    RUN_TEST(test_the_other_limit_switch_stops_the_other_way);
    RUN_TEST(test_both_limit_switches_stop_a_motion_that_turns_round);
    RUN_TEST(test_a_level_counts_when_it_lasts);
    RUN_TEST(test_what_is_not_wired_is_not_obeyed_and_levels_have_their_polarity);
    RUN_TEST(test_a_limit_switch_on_the_bus_is_said_and_shown);
    RUN_TEST(test_a_speed_that_a_limit_switch_has_ended_does_not_come_back);
    RUN_TEST(test_a_target_that_waits_behind_a_limit_switch_is_dropped);
    RUN_TEST(test_no_cyclic_target_behind_a_limit_switch_is_followed);
    RUN_TEST(test_a_stream_that_ends_at_a_limit_switch_stays_there);
    RUN_TEST(test_a_halt_does_not_free_the_way);
    RUN_TEST(test_a_homing_that_a_limit_switch_ends_is_an_error);
    RUN_TEST(test_what_switches_off_at_rest_is_said_on_the_bus);
    RUN_TEST(test_a_quick_stop_input_stops_and_refuses_to_move);
    RUN_TEST(test_a_quick_stop_input_on_the_bus_is_the_profile_s_quick_stop);
    RUN_TEST(test_nothing_is_enabled_without_the_enable_input);
    RUN_TEST(test_an_enable_input_that_goes_stops_then_switches_off);
    RUN_TEST(test_an_enable_input_that_goes_on_the_bus_is_a_quick_stop_then_off);
    RUN_TEST(test_outputs_show_alarm_and_position);
    RUN_TEST(test_a_rotor_off_its_reference_is_not_in_position);
    RUN_TEST(test_the_brake_is_released_behind_the_current_and_engages_before_it_goes);
    RUN_TEST(test_the_brake_engages_on_the_bus_too);
    RUN_TEST(test_a_fault_engages_the_brake_at_once);
    RUN_TEST(test_a_board_without_inputs_has_none_to_be_used);
    return UNITY_END();
}
