#include "firmware/application/console.h"

#include <stdio.h>
#include <string.h>
#include <unity.h>

#include "tests/unit/console_bench.h"

static struct drive *drive;

void setUp(void)
{
    const struct drive_settings settings = bench_quick_settings();

    bench_power_up();
    TEST_ASSERT_TRUE(bench_start(&settings));
    drive = &bench.application.drive;
}

void tearDown(void)
{
}

static void assert_begins(const char *text, const char *begin)
{
    if (strncmp(text, begin, strlen(begin)) != 0) {
        TEST_FAIL_MESSAGE(text);
    }
}

static void answers(const char *line, const char *begin)
{
    assert_begins(bench_ask(line), begin);
}

static void enable(void)
{
    bench_periods(2);
    answers("enable", "ok enable at=1");
    bench_periods(15);
    TEST_ASSERT_EQUAL_INT(DRIVE_OPERATION_ENABLED, drive->supervision.state);
    (void)bench_heard();
}

static void test_it_announces_the_firmware_and_why_it_started(void)
{
    application_background(&bench.application);
    const char *heard = bench_heard();

    assert_begins(heard, "version, ");
    TEST_ASSERT_NOT_NULL(strstr(heard, " on bench; settings: given resistance_ohm=0.37 "));
    TEST_ASSERT_NOT_NULL(strstr(heard, "rotor_teeth=50"));
    TEST_ASSERT_NOT_NULL(strstr(heard,
                                "law=state-feedback feedback=sensorless "
                                "blind_below_rad_s=0.0276174 hold_torque_Nm=0.471 "
                                "hold_load_step_Nm=0.341287 hold_heat_W=3.33 brake=0; started by: "
                                "crash: hard fault at 0x08001234\n"));
    application_background(&bench.application);
    TEST_ASSERT_EQUAL_STRING("", bench_heard());
}

static void test_an_answer_waits_for_room_and_the_next_line_for_the_answer(void)
{
    char all[200] = "";

    application_background(&bench.application);
    (void)bench_heard();
    bench.room = 7;
    bench_type("help stop\nhelp disable\n");
    for (int i = 0; i < 40; i++) {
        application_background(&bench.application);
        strcat(all, bench_heard());
    }
    TEST_ASSERT_EQUAL_STRING("ok stop [ at= ]: brings the reference to rest\n"
                             "ok disable [ at= ]: opens the bridge; clears a fault\n",
                             all);
}

/* Whenever the background comes to it. */
static void test_a_command_acts_ten_periods_after_its_line(void)
{
    bench_periods(3);
    bench_type("enable\n"); /* in period 2 */
    bench_periods(9);
    TEST_ASSERT_EQUAL_INT(DRIVE_SWITCH_ON_DISABLED, drive->supervision.state);
    bench_period(); /* 12 */
    TEST_ASSERT_EQUAL_INT(DRIVE_OPERATION_ENABLED, drive->supervision.state);
    TEST_ASSERT_EQUAL_UINT32(12, drive->supervision.state_since);
}

static void test_a_slow_background_changes_nothing(void)
{
    bench_periods(3);
    bench_type("enable\n");
    bench_interrupts(8);
    bench_periods(3);
    TEST_ASSERT_EQUAL_UINT32(12, drive->supervision.state_since);
}

/* Where the reference rests after a stop of a plan, `slow` periods of which went by unseen. */
static struct position rest_after_stop(int slow)
{
    setUp();
    enable();
    answers("velocity 5 acceleration_rad_s2=500 jerk_rad_s3=1e5", "ok velocity at=36\n");
    bench_periods(300); /* 316: at full speed */
    answers("stop", "ok stop at=326\n");
    bench_periods(9);
    bench_interrupts(slow);
    bench_periods(300 - slow);
    TEST_ASSERT_EQUAL_INT(DRIVE_OPERATION_ENABLED, drive->supervision.state);
    TEST_ASSERT_FALSE(reference_busy(&drive->reference));
    return drive->reference.next.position;
}

static void test_a_stop_of_a_plan_does_not_depend_on_the_background(void)
{
    const struct position prompt = rest_after_stop(0);
    const struct position slow = rest_after_stop(4);

    TEST_ASSERT_EQUAL_HEX32(prompt.fraction, slow.fraction);
    TEST_ASSERT_EQUAL_INT32(prompt.turns, slow.turns);
}

static void test_what_is_planned_acts_a_lead_later(void)
{
    enable();
    answers("velocity 1 acceleration_rad_s2=100 jerk_rad_s3=1e4", "ok velocity at=36\n");
    answers("retarget 1 speed_rad_s=1 acceleration_rad_s2=100 jerk_rad_s3=1e4",
            "ok retarget at=36\n");
    answers("stop", "ok stop at=26\n");
}

static void test_a_later_period_can_be_asked_for_and_an_earlier_one_not(void)
{
    enable();
    answers("move 0.1 at=5000", "ok move at=5000 ");
    answers("stop at=25", "error: at=25: must be at least 26, the first period");
    answers("stop at=4294967296", "error: \"4294967296\": expected a control period");
    answers("stop at=", "error: \"\": expected a control period");
}

/* 600 s of 0.1 ms; what is 2^31 periods ahead or more looks like the past. */
static void test_a_period_too_far_ahead_is_refused_with_the_range(void)
{
    static const char *const too_far[] = {"6000027", "1000000000", "2147483673", "2147483674",
                                          "4294967295"};
    char line[40];
    char refusal[120];

    enable();
    for (size_t i = 0; i < 5; i++) {
        (void)snprintf(refusal, sizeof refusal,
                       "error: at=%s: must be at least 26, the first period in which this line can "
                       "act, and at most 6000026\n",
                       too_far[i]);
        (void)snprintf(line, sizeof line, "stop at=%s", too_far[i]);
        answers(line, refusal);
        (void)snprintf(line, sizeof line, "move 1 at=%s", too_far[i]);
        answers(line, refusal);
    }
    answers("move 0.1", "ok move at=26 ");
    answers("stop at=6000026", "ok stop at=6000026\n");
    answers("move 0.2",
            "error: move refused: a stop waits for period 6000026, and where it ends is "
            "not known\n");
    answers("stop", "ok stop at=26\n");
}

/* Commands act in the order in which they came: each answer says when. */
static void test_a_line_behind_one_that_waits_answers_when_it_will_act(void)
{
    enable();
    answers("move 0.1 at=5000", "ok move at=5000 ");
    answers("move 0.2", "ok move at=5000 ");
    answers("hold at=4999", "error: at=4999: must be at least 5000, the first period");
    answers("stop", "ok stop at=26\n");
    bench_periods(20);
    answers("move 0.1", "ok move at=46 ");
    answers("disable", "ok disable at=46\n"); /* flushes what waits */
    answers("enable", "ok enable at=46\n");
}

static void test_the_zero_of_the_position_is_set_and_shown(void)
{
    enable();
    answers("set-position", "error: set-position: missing position_rad=\n");
    answers("set-position 12.5", "ok set-position at=26\n");
    answers("move 13", "ok move at=26 duration_s=0.0");
    bench_periods(2000);
    TEST_ASSERT_NOT_NULL(strstr(bench_ask("state"), " reference_rad=13 "));
    TEST_ASSERT_NOT_NULL(strstr(bench_ask("state"), " position=referenced "));
    TEST_ASSERT_NOT_NULL(strstr(bench_ask("signals"), " motor_zero_rad=12.5"));
    answers("velocity 5 acceleration_rad_s2=500 jerk_rad_s3=1e5", "ok velocity at=");
    bench_periods(100);
    answers("set-position 0",
            "error: set-position refused: the reference moves, or a command waits; "
            "stop, and wait for rest\n");
}

static void test_readiness_says_what_is_known_of_the_position(void)
{
    enable();
    answers("set-position 12.5", "ok set-position at=26\n");
    bench_periods(12);
    answers("disable", "ok disable at=38\n");
    answers("enable", "ok enable at=38\n");
    bench_periods(14);
    TEST_ASSERT_NOT_NULL(
        strstr(bench_heard(), " reference_rad=12.5 resistance_ohm=0.37 position=kept\n"));
    answers("velocity 5 acceleration_rad_s2=500 jerk_rad_s3=1e5", "ok velocity at=");
    bench_periods(100);
    answers("disable", "ok disable at=");
    bench_periods(12);
    TEST_ASSERT_NOT_NULL(strstr(bench_ask("state"), " position=uncertain "));
    answers("enable", "ok enable at=");
    bench_periods(14);
    TEST_ASSERT_NOT_NULL(strstr(bench_heard(), " position=uncertain; home the axis again\n"));
}

static void test_a_late_line_says_so(void)
{
    enable();
    bench_type("hold\n");
    bench_interrupts(20);
    application_background(&bench.application);
    TEST_ASSERT_EQUAL_STRING("ok hold at=26 late: that period had passed\n", bench_heard());
}

/* In the period in which it is read it can no longer act; the one behind is soon enough. */
static void test_a_line_is_late_from_its_own_period_on(void)
{
    enable();
    bench_type("hold\n");
    bench_interrupts(10);
    application_background(&bench.application);
    TEST_ASSERT_EQUAL_STRING("ok hold at=26 late: that period had passed\n", bench_heard());
    bench_type("hold\n");
    bench_interrupts(9);
    application_background(&bench.application);
    TEST_ASSERT_EQUAL_STRING("ok hold at=36\n", bench_heard());
}

static void test_a_move_without_times_is_one_the_motor_can_follow(void)
{
    enable();
    answers("move 10", "ok move at=26 duration_s=0.3124 ramp_s=0.0507 jerk_s=0.0126\n");
    answers("move 10", "ok move at=26 duration_s=0.02 ramp_s=0.01 jerk_s=0.0025\n");
    answers("move -0.5 duration_s=0.4", "ok move at=26 duration_s=0.4 ramp_s=0.1 jerk_s=0.025\n");
    TEST_ASSERT_TRUE(drive->planned_end.position.turns == -4);
}

static void test_every_command_reaches_the_drive(void)
{
    static const char *const lines[] = {
        "move-smooth position_rad=0x1p-3 duration_s=0.1 ramp_s=0.04 jerk_s=0.01",
        "move-trapezoid duration_s=0.1 position_rad=0 ramp_s=0.05",
        "step position_rad=1e-2",
        "hold",
        "sine amplitude_rad=0.1 frequency_Hz=1 cycles=0 ramp_s=1",
    };
    static const enum drive_command_kind kinds[] = {
        DRIVE_COMMAND_MOVE_SMOOTH, DRIVE_COMMAND_MOVE_TRAPEZOID, DRIVE_COMMAND_STEP,
        DRIVE_COMMAND_HOLD, DRIVE_COMMAND_SINE};

    enable();
    for (uint32_t i = 0; i < 5; i++) {
        const uint32_t at = drive->commands.written;

        answers(lines[i], "ok ");
        TEST_ASSERT_EQUAL_INT(kinds[i], drive->commands.entry[at % COMMAND_QUEUE_LENGTH].kind);
    }
    answers("disable", "ok disable at=26\n");
    TEST_ASSERT_TRUE(drive->commands.disable.posted);
}

static void test_set_points_are_a_stream(void)
{
    enable();
    answers("set-point 0.001 interval_s=1e-2 acceleration_rad_s2=1000 jerk_rad_s3=1e6",
            "ok set-point at=36\n");
    bench_periods(10);
    answers("set-point 0.002", "ok set-point at=46\n");
    bench_periods(18);
    TEST_ASSERT_FALSE(reference_busy(&drive->reference)); /* behind period 45, for the next one: the
                                                             second counts */
    bench_periods(1);
    TEST_ASSERT_TRUE(reference_busy(&drive->reference));
    answers("store", "error: store refused: sine and set-points cannot wait");
}

static void test_what_is_not_understood_is_refused_with_what_was_expected(void)
{
    enable();
    answers("fly", "error: \"fly\": expected a command; help lists them\n");
    answers("help fly", "error: \"fly\": expected a command");
    answers("step", "error: step: missing position_rad=\n");
    answers("step one", "error: \"one\": expected a number, as -1.5, 2e-3 or 0x1.8p+0\n");
    answers("step 1e-40", "error: \"1e-40\": expected a number within 1e-22...1e37");
    answers("step 3.14159265358979323", "error: \"3.14159265358979323\": expected a number of at "
                                        "most 15 digits");
    answers("step 1 2", "error: \"2\": expected step position_rad= [ at= ]\n");
    answers("step 1 position_rad=2", "error: position_rad: given twice\n");
    answers("step 1 speed_rad_s=2", "error: \"speed_rad_s\": expected step position_rad= [ at= ]");
    answers("enable now", "error: \"now\": expected enable [ at= ]");
    answers("store at=5000", "error: \"at\": expected store\n");
    answers("cycles all", "error: \"all\": expected cycles or cycles reset\n");
    answers("step \x01\x80", "error: \"??\": expected a number");
    answers("step 1e6 at=99", "ok step at=99\n");
    answers("move 1e9", "error: ");
}

static void test_what_the_drive_would_drop_is_refused(void)
{
    application_background(&bench.application);
    bench_periods(2);
    answers("move 1", "error: move refused: the drive is switch-on-disabled, enable it first\n");
    enable();
    bench.samples.current_a = 4000;
    bench_period();
    TEST_ASSERT_EQUAL_INT(DRIVE_FAULT, drive->supervision.state);
    (void)bench_heard();
    answers("move 1", "error: move refused: the drive is in fault, disable clears it\n");
    answers("enable", "error: enable refused: fault overcurrent: a phase current beyond 5.4 A; ");
    answers("velocity 1 acceleration_rad_s2=1 jerk_rad_s3=1", "error: velocity refused: ");
    answers("disable", "ok disable at=");
    answers("enable", "ok enable at=");
}

static void test_commands_that_a_fault_keeps_from_acting_are_reported(void)
{
    char line[60];

    enable();
    (void)snprintf(line, sizeof line, "move 1 at=%u", (unsigned)drive->supervision.period + 40u);
    answers(line, "ok move at=");
    (void)snprintf(line, sizeof line, "hold at=%u", (unsigned)drive->supervision.period + 42u);
    answers(line, "ok hold at=");
    bench.samples.current_a = 4000;
    bench_period();
    TEST_ASSERT_EQUAL_INT(DRIVE_FAULT, drive->supervision.state);
    bench_periods(20);
    (void)bench_heard();
    bench_periods(40);
    TEST_ASSERT_EQUAL_STRING(
        "warning: 1 command dropped: accepted, but not possible when the time to act came\n"
        "warning: 1 command dropped: accepted, but not possible when the time to act came\n",
        bench_heard());
    TEST_ASSERT_NOT_NULL(strstr(bench_ask("state"), " dropped=2 "));
}

static void test_a_disable_for_later_leaves_the_one_that_waits(void)
{
    enable();
    answers("disable", "ok disable at=26\n");
    answers("disable at=5000", "ok disable at=26\n");
    bench_periods(10);
    TEST_ASSERT_EQUAL_INT(DRIVE_SWITCH_ON_DISABLED, drive->supervision.state);
    TEST_ASSERT_EQUAL_UINT32(26, drive->supervision.state_since);
}

static void test_a_stop_for_later_leaves_the_one_that_waits(void)
{
    enable();
    answers("velocity 5 acceleration_rad_s2=500 jerk_rad_s3=1e5", "ok velocity at=36\n");
    bench_periods(300); /* 316 */
    answers("stop", "ok stop at=326\n");
    answers("stop at=5000", "ok stop at=326\n");
    bench_periods(300);
    TEST_ASSERT_FALSE(reference_busy(&drive->reference));
}

/* Until then the drive obeys; what is addressed behind it would be dropped. */
static void test_a_disable_for_later_counts_from_its_period_on(void)
{
    enable();
    answers("disable at=5000", "ok disable at=5000\n");
    answers("move 1", "ok move at=26 ");
    answers("enable", "ok enable at=26\n");
    TEST_ASSERT_TRUE(drive_planned_end_rad(drive) > 0.999);
    answers("hold at=4999", "ok hold at=4999\n");
    answers("hold at=5000",
            "error: hold refused: a disable acts in period 5000, enable the drive behind it\n");
}

static void trip(void)
{
    enable();
    bench.trip_latched = true;
    bench.samples.flags = HAL_FLAG_OVERCURRENT_TRIP;
    bench_period();
    bench.samples.flags = 0;
    TEST_ASSERT_EQUAL_INT(DRIVE_FAULT, drive->supervision.state);
    (void)bench_heard();
}

static void test_after_a_trip_of_the_board_disable_and_enable_may_come_in_one_go(void)
{
    for (int slow = 0; slow < 9; slow++) {
        setUp();
        trip(); /* 17 */
        bench_type("disable\nenable\nmove 1\n");
        bench_interrupts(slow);
        application_background(&bench.application);
        TEST_ASSERT_EQUAL_STRING("ok disable at=27\n", bench_heard());
        application_background(&bench.application);
        TEST_ASSERT_EQUAL_STRING("ok enable at=27\n", bench_heard());
        application_background(&bench.application);
        TEST_ASSERT_EQUAL_STRING("error: move refused: the drive is being enabled, wait until it "
                                 "is ready\n",
                                 bench_heard());
        bench_interrupts(11 - slow);
        TEST_ASSERT_EQUAL_INT(DRIVE_OPERATION_ENABLED, drive->supervision.state);
        TEST_ASSERT_EQUAL_UINT32(28, drive->supervision.state_since);
        TEST_ASSERT_TRUE(bench.bridge_enabled);
    }
}

/* Whether the background reads the line before or after the drive is ready. */
static void test_what_came_before_readiness_is_refused_however_late_it_is_read(void)
{
    for (int slow = 0; slow < 9; slow++) {
        setUp();
        bench_periods(3);
        answers("enable", "ok enable at=12\n");
        bench_periods(9); /* 11 */
        bench_type("hold\n");
        bench_interrupts(slow);
        (void)bench_heard();
        application_background(&bench.application);
        if (slow > 0) { /* readiness is announced first */
            application_background(&bench.application);
        }
        TEST_ASSERT_NOT_NULL(strstr(bench_heard(), "error: hold refused: the drive is being "
                                                   "enabled, wait until it is ready\n"));
    }
    bench_type("hold\n");
    application_background(&bench.application);
    assert_begins(bench_heard(), "ok hold at=");
}

static void test_a_fault_is_announced_with_its_reason(void)
{
    enable();
    bench.samples.bus_voltage = 100;
    bench_period();
    TEST_ASSERT_EQUAL_STRING("fault: bus-voltage: the supply is outside 0.5...1.3 of 24 V; the "
                             "bridge is open since period 17, disable clears the fault\n",
                             bench_heard());
    bench_periods(5);
    TEST_ASSERT_EQUAL_STRING("", bench_heard());
    answers("state", "ok fault fault=bus-voltage period=22 position_rad=");
    answers("signals", "ok signals state=fault fault=bus-voltage period=22 theta_est_rad=");
    TEST_ASSERT_NOT_NULL(strstr(bench_ask("signals"), " reference_moving=no holding=no "));
}

static void test_readiness_is_announced(void)
{
    bench_periods(2);
    answers("enable", "ok enable at=11\n");
    bench_periods(15);
    assert_begins(bench_heard(), "ready: period=11 reference_rad=0 ");
}

static void test_lines_may_end_and_be_corrected_as_terminals_do(void)
{
    application_background(&bench.application);
    bench_periods(3);
    answers("\r", "");
    answers("  help   stop  \r", "ok stop");
    answers("helk\bp stop", "ok stop");
    answers("help stap\x7f\x7fop", "ok stop");
}

/* All that is answered to `text` if each reading brings at most `piece` bytes. */
static void assert_hears(const char *text, size_t piece, const char *expected)
{
    char all[200] = "";

    setUp();
    application_background(&bench.application);
    (void)bench_heard();
    bench.piece = piece;
    bench_type(text);
    for (int i = 0; i < 60; i++) {
        application_background(&bench.application);
        strcat(all, bench_heard());
    }
    TEST_ASSERT_EQUAL_STRING(expected, all);
}

static void test_carriage_return_and_line_feed_end_lines_wherever_the_bytes_are_split(void)
{
    static const char *const typed[] = {
        "help stop\nhelp disable\n",       "help stop\rhelp disable\r",
        "help stop\r\nhelp disable\r\n",   "help stop\rhelp disable\n",
        "help stop\n\rhelp disable\r\n\n", "\r\r\nhelp stop\r\nhelp disable\r",
    };

    for (size_t i = 0; i < sizeof typed / sizeof typed[0]; i++) {
        for (size_t piece = 0; piece <= strlen(typed[i]); piece++) {
            assert_hears(typed[i], piece,
                         "ok stop [ at= ]: brings the reference to rest\n"
                         "ok disable [ at= ]: opens the bridge; clears a fault\n");
        }
    }
}

static void test_a_carriage_return_ends_its_line_at_once(void)
{
    bench_periods(3);
    (void)bench_heard();
    bench_type("help stop\r");
    application_background(&bench.application);
    TEST_ASSERT_EQUAL_STRING("ok stop [ at= ]: brings the reference to rest\n", bench_heard());
    bench_periods(100);
    bench_type("\nhelp disable\r");
    bench_periods(2);
    TEST_ASSERT_EQUAL_STRING("ok disable [ at= ]: opens the bridge; clears a fault\n",
                             bench_heard());
}

/* Only a line feed is stamped when it arrives. */
static void test_a_line_ended_by_carriage_return_counts_from_when_it_is_read(void)
{
    enable(); /* period 16 */
    bench_type("stop\r");
    bench_interrupts(4);
    application_background(&bench.application);
    TEST_ASSERT_EQUAL_STRING("ok stop at=30\n", bench_heard());
}

static void test_a_line_with_a_nul_byte_is_refused(void)
{
    static const char typed[] = "step 1\0junk\n\0\nhelp stop\n";

    enable();
    bench_type_bytes(typed, sizeof typed - 1u);
    bench_periods(1);
    TEST_ASSERT_EQUAL_STRING("error: the line contains a NUL byte\n", bench_heard());
    TEST_ASSERT_EQUAL_UINT32(drive->commands.written, drive->commands.read);
    bench_periods(1);
    TEST_ASSERT_EQUAL_STRING("error: the line contains a NUL byte\n", bench_heard());
    bench_periods(1);
    assert_begins(bench_heard(), "ok stop");
}

/* 50 periods of silence; a keep-alive is any line, an empty one, too. */
static void test_a_motion_stops_when_no_line_comes_for_the_command_timeout(void)
{
    struct drive_settings settings = bench_quick_settings();

    settings.command_timeout_s = 50.0 * bench_facts.control_period_s;
    TEST_ASSERT_TRUE(bench_start(&settings));
    enable();
    answers("velocity 5 acceleration_rad_s2=500 jerk_rad_s3=1e5", "ok velocity at=");
    for (int i = 0; i < 5; i++) {
        bench_periods(40);
        answers(i < 4 ? "state" : "", i < 4 ? "ok operation-enabled" : "");
    }
    bench_periods(49);
    TEST_ASSERT_EQUAL_STRING("", bench_heard());
    bench_interrupts(3); /* the background is late */
    const uint32_t heard_in = bench.application.heard_in;

    bench_periods(1);
    assert_begins(bench_heard(), "warning: stop: no line for command_timeout_s\n");
    TEST_ASSERT_EQUAL_UINT32(heard_in + 60u, drive->commands.stop.at_period);
    bench_periods(900);
    TEST_ASSERT_FALSE(drive->reference.now.moving);
    TEST_ASSERT_EQUAL_STRING("", bench_heard()); /* once */
    answers("move 0.1", "ok move at=");
    bench_periods(20);
    TEST_ASSERT_TRUE(drive->reference.now.moving);
    bench_periods(40); /* and again */
    assert_begins(bench_heard(), "warning: stop: no line for command_timeout_s\n");
}

/* Nothing to stop: nothing is said. What waits for its period is flushed like a motion. */
static void test_silence_at_rest_is_no_timeout(void)
{
    struct drive_settings settings = bench_quick_settings();

    settings.command_timeout_s = 50.0 * bench_facts.control_period_s;
    TEST_ASSERT_TRUE(bench_start(&settings));
    enable();
    bench_periods(500);
    TEST_ASSERT_EQUAL_STRING("", bench_heard());
    answers("move 0.1 at=3000", "ok move at=3000");
    bench_periods(100);
    assert_begins(bench_heard(), "warning: stop: no line for command_timeout_s\n");
    TEST_ASSERT_FALSE(command_queue_holds_any(&drive->commands));
}

static void test_long_and_damaged_lines_are_refused_as_a_whole(void)
{
    char line[400];

    bench_periods(3);
    memset(line, 'a', sizeof line);
    line[CONSOLE_LINE_BYTES + 1] = '\0';
    (void)bench_heard();
    answers(line, "error: the line is longer than 200 characters\n");
    line[CONSOLE_LINE_BYTES] = '\0';
    answers(line, "error: \"aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa...\": expected a command");
    answers("enable\x18", "error: bytes of the line were lost: it came too fast\n");
    TEST_ASSERT_EQUAL_UINT32(0, drive->commands.written);
    answers("help stop", "ok stop");
}

static void test_the_longest_answers_are_not_cut(void)
{
    static const char *const lines[] = {"help", "state", "help move", "help set-point"};

    enable();
    for (size_t i = 0; i < 4; i++) {
        const size_t length = strlen(bench_ask(lines[i]));

        TEST_ASSERT_TRUE(length > 20 && length < CONSOLE_ANSWER_BYTES - 80);
    }
}

/* Every word of it: nothing that another setting or board would change is left out. */
static void test_the_start_names_settings_board_and_what_the_hold_bears(void)
{
    char expected[500];

    (void)snprintf(expected, sizeof expected,
                   "version, %s, on bench; settings: given resistance_ohm=0.37 inductance_H=0.0009 "
                   "torque_constant_Nm_A=0.157 viscous_friction_Nms_rad=0.000307 "
                   "inertia_kgm2=0.0001562 rated_current_A=3 supply_V=24 rotor_teeth=50 "
                   "law=state-feedback feedback=sensorless blind_below_rad_s=0.0276174 "
                   "hold_torque_Nm=0.471 hold_load_step_Nm=0.341287 hold_heat_W=3.33 brake=0; "
                   "started by: crash: hard fault at 0x08001234\n",
                   STEADYSTEP_NUM == NUM_FLOAT   ? "float"
                   : STEADYSTEP_NUM == NUM_FIXED ? "fixed"
                                                 : "double");
    application_background(&bench.application);
    TEST_ASSERT_EQUAL_STRING(expected, bench_heard());
}

/* The contract of the line, once more from outside. */
static void test_every_command_says_what_it_takes(void)
{
    static const char *const usage[][2] = {
        {"help help", "help: lists commands; help <command> explains one"},
        {"help state", "state: what it does and measures"},
        {"help cycles", "cycles: cycles of the control interrupt, mean and most; cycles reset"},
        {"help move", "move position_rad= [ duration_s= ramp_s= jerk_s= at= ]: jerk-limited move;"},
        {"help signals", "signals: all signals\n"},
        {"help defaults", "defaults: all settings but the motor's to defaults\n"},
        {"help hold", "hold [ at= ]: ramps the hold current in"},
        {"help stop", "stop [ at= ]: brings the reference to rest\n"},
        {"help get", "get: a setting: value, unit, range, default; get hold* lists those"},
        {"help set", "set: set hold_current_A 1.2, or default; acts at the next enable"},
        {"help enable", "enable [ at= ]: offset calibration, then the hold"},
        {"help disable", "disable [ at= ]: opens the bridge; clears a fault"},
        {"help move-smooth",
         "move-smooth position_rad= duration_s= ramp_s= jerk_s= [ at= ]: jerk-limited"},
        {"help move-trapezoid", "move-trapezoid position_rad= duration_s= ramp_s= [ at= ]: "},
        {"help step", "step position_rad= [ at= ]: the reference jumps to a position"},
        {"help sine", "sine amplitude_rad= frequency_Hz= [ ramp_s= cycles= at= ]: about where"},
        {"help set-point", "set-point position_rad= [ interval_s= acceleration_rad_s2= "
                           "jerk_rad_s3= at= ]: the first begins a stream"},
        {"help velocity", "velocity speed_rad_s= acceleration_rad_s2= jerk_rad_s3= [ at= ]: "},
        {"help retarget",
         "retarget position_rad= speed_rad_s= acceleration_rad_s2= jerk_rad_s3= [ at= ]: "},
        {"help store", "store: keeps settings and what was learned;"},
        {"help", "help, state, cycles, signals, move, enable, disable, hold, move-trapezoid, "
                 "move-smooth, step, stop, sine, set-point, velocity, retarget, store, "
                 "set-position, torque, get, set, defaults, capture; help <command> explains "
                 "one\n"},
    };
    char expected[300];

    application_background(&bench.application);
    (void)bench_heard();
    for (size_t i = 0; i < sizeof usage / sizeof usage[0]; i++) {
        (void)snprintf(expected, sizeof expected, "ok %s", usage[i][1]);
        answers(usage[i][0], expected);
    }
}

static void test_state_and_signals_name_all_that_they_show(void)
{
    application_background(&bench.application);
    (void)bench_heard();
    TEST_ASSERT_EQUAL_STRING(
        "ok signals state=switch-on-disabled fault=none period=4294967295 theta_est_rad=0 "
        "omega_est_rad_s=0 load_torque_est_Nm=0 theta_ref_rad=0 omega_ref_rad_s=0 "
        "reference_moving=no holding=no synchronism=sure i_d_A=0 i_q_A=0 i_d_ref_A=0 i_q_ref_A=0 "
        "u_d_V=0 u_q_V=0 resistance_est_ohm=0.37 bus_V=24 phase_imbalance=0 "
        "torque_constant_change=0 inductance_change=0 current_offset_a_A=0 current_offset_b_A=0 "
        "voltage_offset_a_V=0 voltage_offset_b_V=0 reference_underruns=0 commands_dropped=0 "
        "dropped_kind=enable "
        "position_reference=assumed "
        "motor_zero_rad=0 motor_heat=0 bridge_derating=0\n",
        bench_ask("signals"));
    TEST_ASSERT_EQUAL_STRING(
        "ok switch-on-disabled fault=none period=4294967295 position_rad=0 speed_rad_s=0 "
        "load_torque_Nm=0 "
        "reference_rad=0 reference_rad_s=0 moving=no holding=no synchronism=sure i_d_A=0 i_q_A=0 "
        "resistance_ohm=0.37 bus_V=24 underruns=0 dropped=0 position=assumed law=state-feedback "
        "feedback=sensorless; version\n",
        bench_ask("state"));
}

static const char *const parameters[] = {
    "position_rad",  "duration_s",          "ramp_s",      "jerk_s",
    "amplitude_rad", "frequency_Hz",        "cycles",      "interval_s",
    "speed_rad_s",   "acceleration_rad_s2", "jerk_rad_s3", "at",
};

/* None of those that its usage does not name. */
static void test_a_command_refuses_what_it_does_not_take(void)
{
    static const char *const commands[] = {"state",     "signals",  "enable",         "disable",
                                           "hold",      "move",     "move-trapezoid", "move-smooth",
                                           "step",      "stop",     "sine",           "store",
                                           "set-point", "velocity", "retarget"};
    char usage[BENCH_STREAM];
    char line[60];
    char words[60];

    application_background(&bench.application);
    (void)bench_heard();
    for (size_t c = 0; c < sizeof commands / sizeof commands[0]; c++) {
        (void)snprintf(line, sizeof line, "help %s", commands[c]);
        (void)snprintf(usage, sizeof usage, "%s", bench_ask(line));
        *strchr(usage, ':') = '\0';
        for (size_t p = 0; p < sizeof parameters / sizeof parameters[0]; p++) {
            (void)snprintf(words, sizeof words, " %s=", parameters[p]);
            if (strstr(usage, words) == NULL) {
                (void)snprintf(line, sizeof line, "%s %s=1", commands[c], parameters[p]);
                (void)snprintf(words, sizeof words, "error: \"%s\": expected %s", parameters[p],
                               commands[c]);
                answers(line, words);
            }
        }
    }
}

static const char *announced_with(enum drive_synchronism synchronism)
{
    drive->synchronism.shown = synchronism;
    bench_periods(3);
    return bench_heard();
}

static void test_what_becomes_of_synchronism_is_announced_once_and_in_operation_only(void)
{
    application_background(&bench.application);
    (void)bench_heard();
    TEST_ASSERT_EQUAL_STRING("", announced_with(DRIVE_SYNCHRONISM_DOUBTFUL));
    drive->synchronism.shown = DRIVE_SYNCHRONISM_SURE;
    enable();
    TEST_ASSERT_EQUAL_STRING("warning: synchronism doubtful: near the end of the torque, or the "
                             "rotor beside its estimate\n",
                             announced_with(DRIVE_SYNCHRONISM_DOUBTFUL));
    TEST_ASSERT_EQUAL_STRING("", announced_with(DRIVE_SYNCHRONISM_DOUBTFUL));
    TEST_ASSERT_EQUAL_STRING("warning: stalled: the rotor does not follow, although the estimate "
                             "is sound\n",
                             announced_with(DRIVE_SYNCHRONISM_STALLED));
    TEST_ASSERT_EQUAL_STRING("synchronism: sure again\n", announced_with(DRIVE_SYNCHRONISM_SURE));
    TEST_ASSERT_EQUAL_STRING("warning: synchronism lost: the rotor is not where the estimate has "
                             "it\n",
                             announced_with(DRIVE_SYNCHRONISM_LOST));
    answers("disable", "ok disable at=");
    TEST_ASSERT_EQUAL_STRING("", announced_with(DRIVE_SYNCHRONISM_LOST));
}

static const char *announced_hot(unsigned shown)
{
    drive->thermal.shown = (uint8_t)shown;
    bench_periods(3);
    return bench_heard();
}

static void test_what_becomes_of_heat_is_announced_once(void)
{
    enable();
    TEST_ASSERT_EQUAL_STRING("warning: thermal: motor derated\n",
                             announced_hot(THERMAL_MOTOR_DERATES));
    TEST_ASSERT_EQUAL_STRING("", announced_hot(THERMAL_MOTOR_DERATES));
    TEST_ASSERT_EQUAL_STRING("warning: thermal: motor derated bridge derated\n",
                             announced_hot(THERMAL_MOTOR_DERATES | THERMAL_BRIDGE_DERATES));
    TEST_ASSERT_EQUAL_STRING("warning: thermal: no bridge sensor\n",
                             announced_hot(THERMAL_NO_SENSOR));
    TEST_ASSERT_EQUAL_STRING("thermal: all well\n", announced_hot(0));
}

static void test_a_reference_that_ran_dry_is_announced(void)
{
    enable();
    drive->planner.underruns++;
    bench_periods(3);
    TEST_ASSERT_EQUAL_STRING("warning: the reference rests: what continues it came too late\n",
                             bench_heard());
}

static void test_two_commands_dropped_at_once_are_counted_together(void)
{
    enable();
    drive->commands.dropped += 2u;
    bench_periods(3);
    TEST_ASSERT_EQUAL_STRING(
        "warning: 2 commands dropped: accepted, but not possible when the time to act came\n",
        bench_heard());
}

static void test_a_position_that_was_found_says_how_and_how_sure(void)
{
    static const char *const by[] = {" found_by=alignment confidence=2.5\n",
                                     " found_by=impulses confidence=2.5\n"};

    for (int impulses = 0; impulses < 2; impulses++) {
        setUp();
        enable();
        drive->params.enabling.detects_position = true;
        drive->enabling.detection.by_impulses = impulses == 1;
        drive->enabling.detection.asymmetry = NUM(0.5);
        drive->enabling.detection.uncertainty = NUM(0.2);
        bench.application.console.announced.state_since++;
        bench_periods(3);
        const char *heard = bench_heard();

        assert_begins(heard, "ready: period=11 reference_rad=0 resistance_ohm=0.37");
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(heard, by[impulses]), heard);
    }
}

static void test_cycles_show_mean_and_most_of_what_was_counted_beside_the_budget(void)
{
    static const char none[] = "ok cycles periods=0: none counted yet, or this board does not "
                               "count\n";
    static const char some[] = "ok cycles periods=4 mean=1250 most=1700 budget=15300\n";

    application_background(&bench.application);
    (void)bench_heard();
    TEST_ASSERT_EQUAL_STRING(none, bench_ask("cycles"));
    bench.application.cycles = (struct control_cycles){.periods = 4, .sum = 5000, .most = 1700};
    TEST_ASSERT_EQUAL_STRING(some, bench_ask("cycles"));
    TEST_ASSERT_EQUAL_STRING(some, bench_ask("cycles reset"));
    TEST_ASSERT_EQUAL_STRING(none, bench_ask("cycles"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_it_announces_the_firmware_and_why_it_started);
    RUN_TEST(test_an_answer_waits_for_room_and_the_next_line_for_the_answer);
    RUN_TEST(test_a_command_acts_ten_periods_after_its_line);
    RUN_TEST(test_a_slow_background_changes_nothing);
    RUN_TEST(test_a_stop_of_a_plan_does_not_depend_on_the_background);
    RUN_TEST(test_what_is_planned_acts_a_lead_later);
    RUN_TEST(test_a_later_period_can_be_asked_for_and_an_earlier_one_not);
    RUN_TEST(test_a_late_line_says_so);
    RUN_TEST(test_a_line_is_late_from_its_own_period_on);
    RUN_TEST(test_what_becomes_of_heat_is_announced_once);
    RUN_TEST(test_a_move_without_times_is_one_the_motor_can_follow);
    RUN_TEST(test_a_period_too_far_ahead_is_refused_with_the_range);
    RUN_TEST(test_a_line_behind_one_that_waits_answers_when_it_will_act);
    RUN_TEST(test_the_zero_of_the_position_is_set_and_shown);
    RUN_TEST(test_readiness_says_what_is_known_of_the_position);
    RUN_TEST(test_every_command_reaches_the_drive);
    RUN_TEST(test_set_points_are_a_stream);
    RUN_TEST(test_what_is_not_understood_is_refused_with_what_was_expected);
    RUN_TEST(test_what_the_drive_would_drop_is_refused);
    RUN_TEST(test_commands_that_a_fault_keeps_from_acting_are_reported);
    RUN_TEST(test_a_disable_for_later_leaves_the_one_that_waits);
    RUN_TEST(test_a_stop_for_later_leaves_the_one_that_waits);
    RUN_TEST(test_a_disable_for_later_counts_from_its_period_on);
    RUN_TEST(test_after_a_trip_of_the_board_disable_and_enable_may_come_in_one_go);
    RUN_TEST(test_what_came_before_readiness_is_refused_however_late_it_is_read);
    RUN_TEST(test_a_fault_is_announced_with_its_reason);
    RUN_TEST(test_readiness_is_announced);
    RUN_TEST(test_lines_may_end_and_be_corrected_as_terminals_do);
    RUN_TEST(test_carriage_return_and_line_feed_end_lines_wherever_the_bytes_are_split);
    RUN_TEST(test_a_carriage_return_ends_its_line_at_once);
    RUN_TEST(test_a_line_ended_by_carriage_return_counts_from_when_it_is_read);
    RUN_TEST(test_a_line_with_a_nul_byte_is_refused);
    RUN_TEST(test_a_motion_stops_when_no_line_comes_for_the_command_timeout);
    RUN_TEST(test_silence_at_rest_is_no_timeout);
    RUN_TEST(test_long_and_damaged_lines_are_refused_as_a_whole);
    RUN_TEST(test_the_longest_answers_are_not_cut);
    RUN_TEST(test_the_start_names_settings_board_and_what_the_hold_bears);
    RUN_TEST(test_every_command_says_what_it_takes);
    RUN_TEST(test_a_command_refuses_what_it_does_not_take);
    RUN_TEST(test_state_and_signals_name_all_that_they_show);
    RUN_TEST(test_what_becomes_of_synchronism_is_announced_once_and_in_operation_only);
    RUN_TEST(test_a_reference_that_ran_dry_is_announced);
    RUN_TEST(test_two_commands_dropped_at_once_are_counted_together);
    RUN_TEST(test_a_position_that_was_found_says_how_and_how_sure);
    RUN_TEST(test_cycles_show_mean_and_most_of_what_was_counted_beside_the_budget);
    return UNITY_END();
}
