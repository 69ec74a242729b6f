/* The node: its channel, its states, what it says by itself, and whom it hears. */
#include "tests/unit/link_bench.h"

#include "firmware/interface/dictionary.h"

enum { START = 1, STOP = 2, PRE_OPERATIONAL = 0x80, RESET_NODE = 0x81, RESET_COMMUNICATION = 0x82 };

void setUp(void)
{
    link_bench_start();
    link_bench_open();
}

void tearDown(void)
{
}

static bool is_off(void)
{
    return bench.application.drive.supervision.state == DRIVE_SWITCH_ON_DISABLED;
}

/* In profile velocity, at a turn in a second. */
static void enable(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x6060, 0, 1, 3));
    for (unsigned word = 6; word < 16u; word += word == 7u ? 8u : 1u) {
        TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x6040, 0, 2, word));
        bench_periods(20);
    }
    TEST_ASSERT_EQUAL_HEX32(0x27, link_bench_get(0x6041, 0) & 0x6fu);
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x60ff, 0, 4, 65536));
    bench_periods(1000);
}

/* ---- the channel ---- */

/* What an earlier client has left open is opened anew. */
static void test_a_channel_that_opens_is_reset_whatever_it_was(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1017, 0, 2, 500));
    TEST_ASSERT_EQUAL_STRING("\a", link_bench_say("t60184018C", 2));
    TEST_ASSERT_EQUAL_STRING("\rt701100\r", link_bench_say("O", 2));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(0x1017, 0));
    TEST_ASSERT_EQUAL_STRING("\rt701100\r", link_bench_say("L", 2));
    TEST_ASSERT_EQUAL_STRING("\a", link_bench_say("t1230", 2)); /* listens only */
    TEST_ASSERT_EQUAL_STRING("\rt701100\r", link_bench_say("O", 2));
    TEST_ASSERT_EQUAL_STRING("z\r", link_bench_say("t1230", 2));
    TEST_ASSERT_EQUAL_STRING("V1010\r", link_bench_say("V", 2));
    TEST_ASSERT_EQUAL_STRING("N0001\r", link_bench_say("N", 2));
    TEST_ASSERT_EQUAL_STRING("F00\r", link_bench_say("F", 2));
    TEST_ASSERT_EQUAL_STRING("\a", link_bench_say("t12", 2));
    TEST_ASSERT_EQUAL_STRING("", link_bench_say("", 2));
    (void)link_bench_say("C", 2);
    TEST_ASSERT_EQUAL_STRING("\a", link_bench_say("t1230", 2));
    TEST_ASSERT_EQUAL_STRING("\rt701100\r", link_bench_say("L", 2));
    TEST_ASSERT_EQUAL_STRING("\a", link_bench_say("t60184000100000000000", 2));
}

static void test_a_line_that_is_too_long_means_nothing_and_line_feeds_are_left_out(void)
{
    TEST_ASSERT_EQUAL_STRING("\a",
                             link_bench_say("t6018400010000000000000000000000000000000000000", 2));
    link_bench_heard("t58184300100092010400\r", link_bench_say("t60184000\n100000000000", 2));
}

/* The console goes on with what happens from then on. */
static void test_what_has_happened_while_it_was_open_is_not_announced_behind_it(void)
{
    struct drive *drive = &bench.application.drive;

    (void)link_bench_put(0x2200, 0, 1, 1); /* enable */
    bench_periods(20);
    drive->planner.underruns++;
    drive->commands.dropped += 2u;
    drive->synchronism.shown = DRIVE_SYNCHRONISM_DOUBTFUL;
    bench.application.unheard = true;
    TEST_ASSERT_EQUAL_STRING("\r", link_bench_say("C", 50));
    drive->planner.underruns++;
    bench_periods(3);
    TEST_ASSERT_EQUAL_STRING("warning: the reference rests: what continues it came too late\n",
                             bench_heard());
}

/* So that none of them waits longer than a line of the console would. */
static void test_a_pass_takes_a_frame(void)
{
    (void)bench_heard();
    bench_type("t1230\rt1240\rt1250\r");
    for (int i = 0; i < 3; i++) {
        bench_period();
        TEST_ASSERT_EQUAL_STRING("z\r", bench_heard());
    }
    bench_period();
    TEST_ASSERT_EQUAL_STRING("", bench_heard());
}

/* ---- states ---- */

static void test_nmt_is_two_bytes_for_this_node_or_all(void)
{
    (void)link_bench_nmt(START, 2);
    TEST_ASSERT_EQUAL(LINK_OPERATIONAL, bench_link.nmt);
    (void)link_bench_say("t00010201", 2);
    (void)link_bench_say("t000102", 2);
    (void)link_bench_say("t0003020100", 2);
    (void)link_bench_say("t00020203", 2);
    (void)link_bench_nmt(3, 2);
    TEST_ASSERT_EQUAL(LINK_OPERATIONAL, bench_link.nmt);
    (void)link_bench_say("t00020200", 2);
    TEST_ASSERT_EQUAL(LINK_STOPPED, bench_link.nmt);
    (void)link_bench_nmt(PRE_OPERATIONAL, 2);
    TEST_ASSERT_EQUAL(LINK_PRE_OPERATIONAL, bench_link.nmt);
    TEST_ASSERT_EQUAL_HEX32(0x00040192, link_bench_get(0x1000, 0));
}

static void test_a_reset_of_the_node_stops_and_switches_off_and_one_of_communication_stops(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1010, 1, 4, 0x65766173));
    enable();
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1017, 0, 2, 500));
    link_bench_heard("t701100\r", link_bench_nmt(RESET_COMMUNICATION, 20));
    TEST_ASSERT_FALSE(is_off());
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(0x1017, 0));
    TEST_ASSERT_EQUAL_HEX32(0x23, link_bench_get(0x6041, 0) & 0x6fu); /* is enabled already */
    bench_periods(8000);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, link_bench_speed_rad_s());
    TEST_ASSERT_EQUAL_HEX32(0x23, link_bench_get(0x6041, 0) & 0x6fu);
    enable();
    (void)link_bench_nmt(START, 2);
    bench.application.chosen.current_limit_A *= 0.5; /* not stored */
    const double chosen_A = bench.application.chosen.current_limit_A;

    (void)link_bench_nmt(RESET_NODE, 20);
    TEST_ASSERT_FALSE(is_off()); /* brakes */
    TEST_ASSERT_EQUAL_HEX32(0x07, link_bench_get(0x6041, 0) & 0x6fu);
    link_bench_heard("t701100\r", link_bench_say("", 8000));
    TEST_ASSERT_EQUAL(LINK_PRE_OPERATIONAL, bench_link.nmt);
    TEST_ASSERT_EQUAL_DOUBLE(2.0 * chosen_A, bench.application.chosen.current_limit_A);
    TEST_ASSERT_TRUE(is_off());
    TEST_ASSERT_EQUAL_HEX32(0x40, link_bench_get(0x6041, 0) & 0x6fu);
}

static void test_heartbeats_come_at_their_interval(void)
{
    TEST_ASSERT_EQUAL_INT(0, link_bench_count("t7011", link_bench_say("", 1000)));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1017, 0, 2, 20));
    (void)link_bench_say("", 250);
    TEST_ASSERT_EQUAL_INT(10, link_bench_count("t70117F\r", link_bench_say("", 2000)));
}

/* ---- errors ---- */

static void fail(enum drive_fault fault)
{
    bench.application.drive.supervision.state = DRIVE_FAULT;
    bench.application.drive.supervision.fault = fault;
}

static void recover(void)
{
    bench.application.drive.supervision.state = DRIVE_SWITCH_ON_DISABLED;
    bench.application.drive.supervision.fault = DRIVE_FAULT_NONE;
}

static void test_every_fault_is_an_emergency_with_its_code_its_kind_and_its_place(void)
{
    static const uint8_t kinds[16] = {[2] = 0x03, [3] = 0x05, [4] = 0x09, [5] = 0x21,
                                      [6] = 0x21, [7] = 0x21, [8] = 0x21, [15] = 0x81};

    for (int i = 1; i < (int)DRIVE_FAULTS; i++) {
        const unsigned code = fault_at((enum drive_fault)i)->code;
        char expected[40];

        snprintf(expected, sizeof expected, "t0818%02X%02X%02X%02X00000000\r", code & 255u,
                 code >> 8, (unsigned)kinds[code >> 12], (unsigned)i);
        fail((enum drive_fault)i);
        const char *heard = link_bench_say("", 30);

        TEST_ASSERT_EQUAL_STRING(expected, heard);
        TEST_ASSERT_EQUAL_HEX32(kinds[code >> 12], link_bench_get(0x1001, 0));
        TEST_ASSERT_EQUAL_HEX32(code | (uint32_t)i << 16, link_bench_get(0x1003, 1));
        TEST_ASSERT_EQUAL_HEX32(code, link_bench_get(0x603f, 0));
        recover();
        TEST_ASSERT_EQUAL_STRING("t08180000000000000000\r", link_bench_say("", 30));
        TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(0x1001, 0));
    }
}

static void test_the_last_four_errors_are_kept_until_they_are_deleted(void)
{
    for (int i = 1; i <= 5; i++) {
        fail((enum drive_fault)i);
        (void)link_bench_say("", 30);
        TEST_ASSERT_EQUAL_HEX32(i < 4 ? i : 4, link_bench_get(0x1003, 0));
    }
    for (unsigned sub = 1; sub <= 4u; sub++) {
        const unsigned place = 6u - sub;

        TEST_ASSERT_EQUAL_HEX32(fault_at((enum drive_fault)place)->code | (uint32_t)place << 16,
                                link_bench_get(0x1003, sub));
    }
    TEST_ASSERT_EQUAL_HEX32(OBJECT_OUT_OF_RANGE, link_bench_put(0x1003, 0, 1, 1));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1003, 0, 1, 0));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(0x1003, 0));
    TEST_ASSERT_EQUAL_STRING("8003100124000008", link_bench_sdo("4003100100000000"));
}

/* ---- who commands ---- */

static void beat(unsigned node, int periods)
{
    char line[16];

    snprintf(line, sizeof line, "t%03X105", 0x700u + node);
    (void)link_bench_say(line, periods);
}

/* 20 ms without one, looked at once in a millisecond. */
static void test_a_heartbeat_that_was_heard_must_come_again_in_time(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1016, 1, 4, 0x00050014));
    enable(); /* none has come: none is missed */
    beat(6, 400);
    TEST_ASSERT_FALSE(bench_link.other_errors);
    (void)link_bench_say("t7050", 400); /* a heartbeat has a state */
    TEST_ASSERT_FALSE(bench_link.other_errors);
    beat(5, 195);
    TEST_ASSERT_FALSE(bench_link.other_errors);
    beat(5, 195);
    TEST_ASSERT_FALSE(bench_link.other_errors);
    link_bench_heard("t08183081110000000000\r", link_bench_say("", 20));
    TEST_ASSERT_TRUE(bench_link.other_errors);
    TEST_ASSERT_EQUAL_HEX32(0x11, link_bench_get(0x1001, 0));
    TEST_ASSERT_EQUAL_HEX32(0x8130, link_bench_get(0x1003, 1));
    bench_periods(4000);
    TEST_ASSERT_TRUE(is_off());
    TEST_ASSERT_EQUAL_INT(0, link_bench_count("t081", link_bench_say("", 1000))); /* said once */
    beat(5, 10);
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(0x1001, 0));
}

/* Nothing moves that would have to be stopped. */
static void test_a_drive_that_is_only_switched_on_is_off_at_once_when_nobody_is_heard(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1016, 1, 4, 0x00050014));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x6040, 0, 2, 6));
    bench_periods(20);
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x6040, 0, 2, 7));
    bench_periods(20);
    TEST_ASSERT_EQUAL_HEX32(0x23, link_bench_get(0x6041, 0) & 0x6fu);
    beat(5, 190);
    TEST_ASSERT_FALSE(is_off());
    bench_periods(40);
    TEST_ASSERT_TRUE(is_off());
    TEST_ASSERT_EQUAL_HEX32(0x40, link_bench_get(0x6041, 0) & 0x6fu);
}

/* Wherever in the millisecond it came. */
static void test_a_heartbeat_has_all_of_its_time(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1016, 1, 4, 0x00050014));
    for (int phase = 0; phase < 10; phase++) {
        beat(5, 1);
        TEST_ASSERT_FALSE(bench_link.other_errors);
        while (!bench_link.other_errors) {
            bench_period();
        }
        const uint32_t since_us = bench_link.now_us - bench_link.heard_us;

        TEST_ASSERT_TRUE(since_us > 20000u && since_us <= 21000u);
        bench_periods(10 + (phase + 1) % 10);
    }
}

static void test_heartbeats_are_watched_only_with_a_time(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1016, 1, 4, 0x00050000));
    enable();
    beat(5, 1000);
    TEST_ASSERT_FALSE(bench_link.heard);
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1016, 1, 4, 0x00050014));
    beat(5, 10);
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1016, 1, 4, 0));
    bench_periods(1000);
    TEST_ASSERT_FALSE(bench_link.other_errors);
}

/* Of a period, in microseconds: late by fewer control periods, and by as many. */
static void sync_may_be_late(uint32_t period_us, int less, int late)
{
    const int period = (int)(period_us / 100u);

    link_bench_start();
    link_bench_open();
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1006, 0, 4, period_us));
    enable();
    (void)link_bench_say("t0800", 1000); /* not operational */
    TEST_ASSERT_FALSE(bench_link.other_errors);
    (void)link_bench_nmt(START, 2);
    for (int i = 0; i < 20; i++) {
        (void)link_bench_say("t0800", period + less);
    }
    TEST_ASSERT_FALSE(bench_link.other_errors);
    link_bench_heard("t08180081110000000000\r", link_bench_say("t0800", period + late));
    bench_periods(4000);
    TEST_ASSERT_TRUE(is_off());
}

static void test_sync_may_be_late_by_half_of_its_period_and_by_5_ms(void)
{
    sync_may_be_late(20000, 98, 115);
    sync_may_be_late(2000, 48, 65);
}

/* It has its own identifier, that of another node's, or is not sent at all. */
static void test_emergencies_have_the_identifier_of_1014h(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1014, 0, 4, 0x81));
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(0x1014, 0, 4, 0x82));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1014, 0, 4, 0x80000081));
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(0x1014, 0, 4, 0x601));
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(0x1014, 0, 4, 0x20000082));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1016, 1, 4, 0x00050014));
    TEST_ASSERT_EQUAL_INT(0, link_bench_count("t081", link_bench_say("t705105", 300)));
    TEST_ASSERT_EQUAL_HEX32(0x8130, link_bench_get(0x1003, 1)); /* kept all the same */
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1014, 0, 4, 0x82));
    TEST_ASSERT_EQUAL_INT(
        2, link_bench_count("t082", link_bench_say("t705105", 300))); /* back, lost */
}

/* None counts while the node is not operational: the first one behind is the one that begins. */
static void test_sync_is_missed_from_the_first_one_of_an_operational_node_on(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1006, 0, 4, 4000));
    enable();
    (void)link_bench_nmt(START, 2);
    (void)link_bench_say("t0800", 30);
    (void)link_bench_nmt(PRE_OPERATIONAL, 2);
    for (int i = 0; i < 20; i++) {
        (void)link_bench_say("t0800", 40);
    }
    (void)link_bench_nmt(START, 30);
    TEST_ASSERT_FALSE(bench_link.other_errors);
    link_bench_heard("t08180081110000000000\r", link_bench_say("t0800", 110));
}

static void test_a_sync_that_is_not_watched_may_stay_away(void)
{
    enable();
    (void)link_bench_nmt(START, 2);
    (void)link_bench_say("t0800", 2000);
    TEST_ASSERT_FALSE(bench_link.other_errors);
    (void)link_bench_say("C", 2);
    bench_periods(8000);
    TEST_ASSERT_FALSE(is_off()); /* nobody was to be heard */
}

static void test_a_channel_that_closes_ends_what_sync_has_driven(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1006, 0, 4, 4000));
    enable();
    (void)link_bench_nmt(START, 2);
    (void)link_bench_say("t0800", 2);
    (void)link_bench_say("C", 2);
    bench_periods(8000);
    TEST_ASSERT_TRUE(is_off());
}

static void test_a_frame_that_does_not_fit_is_lost_whole(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1017, 0, 2, 1));
    (void)bench_heard();
    bench.room = 0;
    bench_periods(2000);
    bench.room = BENCH_STREAM;
    const char *heard = link_bench_say("", 1);
    const size_t length = strlen(heard);

    TEST_ASSERT_EQUAL_size_t(0, length % strlen("t70117F\r"));
    TEST_ASSERT_EQUAL_size_t(length / strlen("t70117F\r"), link_bench_count("t70117F\r", heard));
    TEST_ASSERT_TRUE(length > strlen("t70117F\r"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_channel_that_opens_is_reset_whatever_it_was);
    RUN_TEST(test_a_line_that_is_too_long_means_nothing_and_line_feeds_are_left_out);
    RUN_TEST(test_what_has_happened_while_it_was_open_is_not_announced_behind_it);
    RUN_TEST(test_a_pass_takes_a_frame);
    RUN_TEST(test_nmt_is_two_bytes_for_this_node_or_all);
    RUN_TEST(test_a_reset_of_the_node_stops_and_switches_off_and_one_of_communication_stops);
    RUN_TEST(test_heartbeats_come_at_their_interval);
    RUN_TEST(test_every_fault_is_an_emergency_with_its_code_its_kind_and_its_place);
    RUN_TEST(test_the_last_four_errors_are_kept_until_they_are_deleted);
    RUN_TEST(test_a_heartbeat_that_was_heard_must_come_again_in_time);
    RUN_TEST(test_a_drive_that_is_only_switched_on_is_off_at_once_when_nobody_is_heard);
    RUN_TEST(test_a_heartbeat_has_all_of_its_time);
    RUN_TEST(test_heartbeats_are_watched_only_with_a_time);
    RUN_TEST(test_sync_may_be_late_by_half_of_its_period_and_by_5_ms);
    RUN_TEST(test_emergencies_have_the_identifier_of_1014h);
    RUN_TEST(test_sync_is_missed_from_the_first_one_of_an_operational_node_on);
    RUN_TEST(test_a_sync_that_is_not_watched_may_stay_away);
    RUN_TEST(test_a_channel_that_closes_ends_what_sync_has_driven);
    RUN_TEST(test_a_frame_that_does_not_fit_is_lost_whole);
    return UNITY_END();
}
