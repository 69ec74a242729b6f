/* Capture: what the drive has shown in each period, around a trigger, from memory. */
#include <math.h>

#include <unity.h>

#include "firmware/interface/dictionary.h"
#include "tests/unit/link_bench.h"

enum { WORDS = 600, PERIODS = 4000, TURN = 65536 };

static uint32_t memory[WORDS + 1];
static struct drive_signals shown[PERIODS]; /* by period, modulo */

void setUp(void)
{
    link_bench_start();
    memory[WORDS] = 0xdeadbeef;
    link_put_memory(&bench_link, memory, WORDS);
    link_bench_open();
    (void)link_bench_say("t00020101", 1);
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_HEX32(0xdeadbeef, memory[WORDS]);
}

static struct link_objects *objects(void)
{
    return &bench_link.objects;
}

/* A period, and what the drive shows of it. */
static void period(void)
{
    bench_period();
    (void)bench_heard();
    drive_signals_read(&bench.application.drive,
                       &shown[bench.application.drive.supervision.period % PERIODS]);
}

static void periods(int count)
{
    for (int i = 0; i < count; i++) {
        period();
    }
}

static void command(enum drive_command_kind kind, double position_rad)
{
    struct drive_command command = {.kind = kind, .position_rad = position_rad};
    char refusal[DRIVE_ERROR_TEXT];

    command.duration_s = 0.05;
    command.ramp_s = 0.02;
    command.at_period = bench.application.drive.supervision.period + 10u;
    TEST_ASSERT_TRUE_MESSAGE(
        application_command(&bench.application, &command, command.at_period - 10u, refusal),
        refusal);
    periods(20);
}

static enum capture_state state(void)
{
    return capture_state_of(&bench_link.capture);
}

/* Arms what the objects say. */
static void arm(void)
{
    TEST_ASSERT_EQUAL_STRING("6000240100000000", link_bench_sdo("2F00240101000000"));
}

static void assert_shown(void)
{
    static const enum drive_signal signals[] = {SIGNAL_theta_ref_rad, SIGNAL_omega_ref_rad_s,
                                                SIGNAL_reference_moving, SIGNAL_state};

    for (uint32_t i = 0; i < bench_link.capture.samples; i++) {
        const struct drive_signals *then = &shown[capture_period(&bench_link.capture, i) % PERIODS];

        for (uint32_t n = 0; n < 4; n++) {
            TEST_ASSERT_TRUE(capture_value(&bench.application, i, n) ==
                             signal_get(then, signal_at(signals[n])));
        }
    }
}

static void choose_signals(void)
{
    objects()->capture_1 = 0x2313; /* reference, two words */
    objects()->capture_2 = 0x2314;
    objects()->capture_3 = 0x2302; /* moving */
    objects()->capture_4 = 0x2300;
}

static void test_a_captured_move_is_what_the_drive_has_shown(void)
{
    choose_signals();
    objects()->capture_trigger = 0x2302;
    objects()->capture_level = 0.5;
    objects()->capture_before = 20;
    objects()->capture_samples = 100;
    objects()->capture_divider = 3;
    command(DRIVE_COMMAND_ENABLE, 0.0);
    arm();
    periods(40);
    TEST_ASSERT_EQUAL(CAPTURE_FILLS, state());
    periods(100);
    TEST_ASSERT_EQUAL(CAPTURE_WAITS, state());
    TEST_ASSERT_TRUE(bench.follows);
    command(DRIVE_COMMAND_MOVE_TRAPEZOID, 1.0);
    periods(100);
    TEST_ASSERT_EQUAL(CAPTURE_RECORDS, state());
    periods(200);
    TEST_ASSERT_EQUAL(CAPTURE_DONE, state());
    TEST_ASSERT_FALSE(bench.follows);
    assert_shown();
    TEST_ASSERT_TRUE(capture_value(&bench.application, 19, 2) == 0.0);
    TEST_ASSERT_TRUE(capture_value(&bench.application, 20, 2) == 1.0);
    TEST_ASSERT_TRUE(capture_value(&bench.application, 99, 0) > 0.1);
}

/* Nor one that is above already, from the first sample on. */
static void test_what_does_not_cross_the_level_does_not_trigger(void)
{
    choose_signals();
    objects()->capture_trigger = 0x2300;
    objects()->capture_samples = 10;
    command(DRIVE_COMMAND_ENABLE, 0.0);
    arm();
    periods(200);
    TEST_ASSERT_EQUAL(CAPTURE_WAITS, state());
    command(DRIVE_COMMAND_DISABLE, 0.0);
    command(DRIVE_COMMAND_ENABLE, 0.0);
    periods(200);
    TEST_ASSERT_EQUAL(CAPTURE_DONE, state());
    assert_shown();
}

/* A level beyond all numbers that a count may be; a smaller one is crossed by the motion. */
static void test_a_level_beyond_a_count_is_not_crossed(void)
{
    static const double levels[] = {1e300, (double)INFINITY, 4294967296.0};

    command(DRIVE_COMMAND_ENABLE, 0.0);
    for (size_t i = 0; i < 3; i++) {
        choose_signals();
        objects()->capture_trigger = 0x2302;
        objects()->capture_samples = 10;
        objects()->capture_level = levels[i];
        arm();
        command(DRIVE_COMMAND_MOVE_TRAPEZOID, (double)(i + 1u));
        periods(1000);
        TEST_ASSERT_EQUAL(CAPTURE_WAITS, state());
    }
}

static void test_without_a_trigger_it_begins_at_once_and_takes_all_memory(void)
{
    choose_signals();
    arm();
    const uint32_t room = WORDS / bench_link.capture.record_words;

    periods((int)room + 10);
    TEST_ASSERT_EQUAL(CAPTURE_DONE, state());
    TEST_ASSERT_EQUAL(room, bench_link.capture.samples);
    assert_shown();
}

/* A position that falls below a level, on an axis whose zero has been moved. */
static void test_positions_are_those_of_the_axis(void)
{
    choose_signals();
    command(DRIVE_COMMAND_ENABLE, 0.0);
    command(DRIVE_COMMAND_SET_POSITION, 100.0);
    objects()->capture_trigger = 0x2313;
    objects()->capture_level = 99.5;
    objects()->capture_edge = -1;
    objects()->capture_before = 1;
    objects()->capture_samples = 100;
    arm();
    command(DRIVE_COMMAND_MOVE_TRAPEZOID, 99.0);
    periods(600);
    TEST_ASSERT_EQUAL(CAPTURE_DONE, state());
    assert_shown();
    TEST_ASSERT_TRUE(capture_value(&bench.application, 0, 0) >= 99.5);
    TEST_ASSERT_TRUE(capture_value(&bench.application, 1, 0) < 99.5);
}

static void assert_not_armed(void)
{
    TEST_ASSERT_EQUAL_STRING("8000240122000008", link_bench_sdo("2F00240101000000"));
}

static void test_what_cannot_be_captured_is_refused(void)
{
    assert_not_armed(); /* no signal */
    choose_signals();
    objects()->capture_5 = 0x2999;
    assert_not_armed();
    objects()->capture_5 = 0;
    objects()->capture_trigger = 0x2999;
    assert_not_armed();
    objects()->capture_trigger = 0;
    objects()->capture_samples = WORDS / 5 + 1;
    assert_not_armed();
    objects()->capture_samples = 10;
    objects()->capture_before = 10;
    assert_not_armed();
    TEST_ASSERT_EQUAL_STRING("8000240230000906", link_bench_sdo("2B00240200000000")); /* divider */
    TEST_ASSERT_EQUAL_STRING("8000240130000906", link_bench_sdo("2F00240102000000"));
    TEST_ASSERT_EQUAL_STRING("8002240024000008", link_bench_sdo("4002240000000000")); /* none yet */
    link_put_memory(&bench_link, NULL, 0);
    objects()->capture_before = 0;
    assert_not_armed();
}

/* The reference of ten samples at rest, 80 bytes, and what the console says of it. */
static void test_an_edge_is_up_or_down(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x2400, 5, 1, 0xff));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x2400, 5, 1, 1));
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(0x2400, 5, 1, 5));
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(0x2400, 5, 1, 0));
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(0x2400, 2, 2, 0));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x2400, 2, 2, 0x100));
}

static void test_it_is_uploaded_and_shown(void)
{
    objects()->capture_1 = 0x2301; /* period */
    objects()->capture_samples = 10;
    arm();
    periods(20);
    TEST_ASSERT_EQUAL_STRING("4F00240104000000", link_bench_sdo("4000240100000000"));
    TEST_ASSERT_EQUAL_STRING("430024080A000000", link_bench_sdo("4000240800000000"));
    TEST_ASSERT_EQUAL_STRING("4102240050000000", link_bench_sdo("4002240000000000"));
    for (uint32_t i = 0; i < 11; i++) { /* 80 bytes in segments of 7 */
        TEST_ASSERT_EQUAL(0, bench_link.sdo.done % 7u);
        (void)link_bench_sdo(i % 2u == 0u ? "6000000000000000" : "7000000000000000");
    }
    TEST_ASSERT_EQUAL(77, bench_link.sdo.done);
    (void)link_bench_sdo("7000000000000000");
    TEST_ASSERT_EQUAL(80, bench_link.sdo.done);
    (void)link_bench_say("C", 1);
    TEST_ASSERT_EQUAL_STRING("ok capture samples=10\n", bench_ask("capture"));
    TEST_ASSERT_EQUAL_STRING("ok capture samples=10\n", bench_ask("capture 10"));
    char expected[80];
    const uint32_t fifth = capture_period(&bench_link.capture, 4);

    snprintf(expected, sizeof expected, "ok capture period=%u period=%u\n", (unsigned)fifth,
             (unsigned)fifth);
    TEST_ASSERT_EQUAL_STRING(expected, bench_ask("capture 4"));
}

static void test_what_is_armed_can_be_ended(void)
{
    choose_signals();
    objects()->capture_trigger = 0x2302;
    objects()->capture_level = 0.5;
    arm();
    periods(20);
    TEST_ASSERT_TRUE(bench.follows);
    TEST_ASSERT_EQUAL_STRING("6000240100000000", link_bench_sdo("2F00240100000000"));
    TEST_ASSERT_FALSE(bench.follows);
    TEST_ASSERT_EQUAL(CAPTURE_IDLE, state());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_captured_move_is_what_the_drive_has_shown);
    RUN_TEST(test_what_does_not_cross_the_level_does_not_trigger);
    RUN_TEST(test_a_level_beyond_a_count_is_not_crossed);
    RUN_TEST(test_without_a_trigger_it_begins_at_once_and_takes_all_memory);
    RUN_TEST(test_positions_are_those_of_the_axis);
    RUN_TEST(test_what_cannot_be_captured_is_refused);
    RUN_TEST(test_an_edge_is_up_or_down);
    RUN_TEST(test_it_is_uploaded_and_shown);
    RUN_TEST(test_what_is_armed_can_be_ended);
    return UNITY_END();
}
