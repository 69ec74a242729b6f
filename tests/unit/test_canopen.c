/* The node on the bus: channel, network management, SDO, PDO, emergencies. */
#include <stdlib.h>
#include <unity.h>

#include "tests/unit/link_fuzz.h"

void setUp(void)
{
    link_bench_start();
}

void tearDown(void)
{
}

static void test_an_open_channel_boots_the_node_and_silences_the_console(void)
{
    TEST_ASSERT_EQUAL_STRING("\r", link_bench_say("C", 1));
    TEST_ASSERT_EQUAL_STRING("\r", link_bench_say("S6", 1));
    TEST_ASSERT_EQUAL_STRING("\rt701100\r", link_bench_say("O", 2));
    TEST_ASSERT_EQUAL_STRING("\a", link_bench_say("state", 2));
    TEST_ASSERT_EQUAL_STRING("\r", link_bench_say("C", 2));
    link_bench_heard("ok switch-on-disabled", bench_ask("state"));
}

static void test_a_client_that_listens_is_answered_nothing(void)
{
    (void)link_bench_say("L", 1);
    TEST_ASSERT_EQUAL_STRING("\a", link_bench_say("t60184000100000000000", 2));
}

static void test_heartbeats_show_the_state_of_the_node(void)
{
    link_bench_open();
    TEST_ASSERT_EQUAL_STRING("6017100000000000", link_bench_sdo("2B1710000A000000"));
    link_bench_heard("t70117F\r", link_bench_say("t0000", 110));
    link_bench_heard("t701105\r", link_bench_say("t00020101", 110));
    link_bench_heard("t701104\r", link_bench_say("t00020200", 110));
    TEST_ASSERT_EQUAL_STRING("", link_bench_sdo("4000100000000000")); /* stopped: no SDO */
    link_bench_heard("t701100\r", link_bench_say("t00028101", 1));
    TEST_ASSERT_EQUAL_STRING("", link_bench_say("t00020102", 3) + 2); /* for another node */
}

static void test_objects_are_read_at_once_or_in_segments(void)
{
    link_bench_open();
    TEST_ASSERT_EQUAL_STRING("4300100092010400", link_bench_sdo("4000100000000000"));
    TEST_ASSERT_EQUAL_STRING("4F01100000000000", link_bench_sdo("4001100000000000"));
    TEST_ASSERT_EQUAL_STRING("4120210008000000", link_bench_sdo("4020210000000000"));
    TEST_ASSERT_EQUAL_STRING("0000000000000008", link_bench_sdo("6000000000000000"));
    TEST_ASSERT_EQUAL_STRING("1D40000000000000", link_bench_sdo("7000000000000000"));
    TEST_ASSERT_EQUAL_STRING("8020210001000405", link_bench_sdo("6000000000000000")); /* over */
    TEST_ASSERT_EQUAL_STRING("410A100007000000", link_bench_sdo("400A100000000000"));
    TEST_ASSERT_EQUAL_STRING("0176657273696F6E", link_bench_sdo("6000000000000000"));
}

static void test_what_is_not_there_is_said_by_its_abort_code(void)
{
    link_bench_open();
    TEST_ASSERT_EQUAL_STRING("8002100000000206", link_bench_sdo("4002100000000000")); /* object */
    TEST_ASSERT_EQUAL_STRING("8000100111000906", link_bench_sdo("4000100100000000")); /* sub */
    TEST_ASSERT_EQUAL_STRING("8000100002000106", link_bench_sdo("2300100001000000")); /* ro */
    TEST_ASSERT_EQUAL_STRING("8000220001000106", link_bench_sdo("4000220000000000")); /* wo */
    TEST_ASSERT_EQUAL_STRING("8017100010000706", link_bench_sdo("2317100001000000")); /* length */
    TEST_ASSERT_EQUAL_STRING("8060600030000906", link_bench_sdo("2F60600004000000")); /* range */
    TEST_ASSERT_EQUAL_STRING("8001210030000906", link_bench_sdo("2F012100FF000000")); /* no law */
    TEST_ASSERT_EQUAL_STRING("8000000001000405", link_bench_sdo("E000000000000000"));
}

/* 2.0 as a double is 4000 0000 0000 0000h. */
static void test_a_setting_is_written_in_segments(void)
{
    link_bench_open();
    TEST_ASSERT_EQUAL_STRING("6020210000000000", link_bench_sdo("2120210008000000"));
    TEST_ASSERT_EQUAL_STRING("2000000000000000", link_bench_sdo("0000000000000000"));
    TEST_ASSERT_EQUAL_STRING("3000000000000000", link_bench_sdo("1D40000000000000"));
    TEST_ASSERT_TRUE(bench.application.chosen.current_limit_A == 2.0);
    TEST_ASSERT_EQUAL_STRING("6020210000000000", link_bench_sdo("2120210008000000"));
    TEST_ASSERT_EQUAL_STRING("8020210000000305", link_bench_sdo("1000000000000000")); /* toggle */
    TEST_ASSERT_EQUAL_STRING("8020210010000706", link_bench_sdo("2120210004000000"));
}

/* 3.0 and a bit, in blocks of up to two segments; what is not acknowledged comes again. */
static void test_blocks_are_sent_acknowledged_and_checked(void)
{
    link_bench_open();
    TEST_ASSERT_EQUAL_STRING("C620210008000000", link_bench_sdo("A420210002000000"));
    TEST_ASSERT_EQUAL_STRING("z\rt58180100000000000008\rt58188240000000000000\r",
                             link_bench_say("t6018A300000000000000", 2));
    TEST_ASSERT_EQUAL_STRING("z\rt58188140000000000000\r",
                             link_bench_say("t6018A201020000000000", 2));
    TEST_ASSERT_EQUAL_STRING("D96DC10000000000", link_bench_sdo("A201020000000000"));
    TEST_ASSERT_EQUAL_STRING("z\r", link_bench_say("t6018A100000000000000", 2));
    TEST_ASSERT_EQUAL_STRING("8020210001000405", link_bench_sdo("A100000000000000")); /* over */
    TEST_ASSERT_EQUAL_STRING("8020210002000405", link_bench_sdo("A420210080000000")); /* 128 */
    TEST_ASSERT_EQUAL_STRING("8000220001000106", link_bench_sdo("A400220002000000"));
}

static void test_a_block_has_no_checksum_unless_it_is_asked_for(void)
{
    link_bench_open();
    TEST_ASSERT_EQUAL_STRING("C620210008000000", link_bench_sdo("A020210002000000"));
    (void)link_bench_say("t6018A300000000000000", 2);
    TEST_ASSERT_EQUAL_STRING("D900000000000000", link_bench_sdo("A202020000000000"));
}

static void test_more_than_was_sent_is_not_acknowledged(void)
{
    link_bench_open();
    (void)link_bench_sdo("A420210001000000");
    (void)link_bench_say("t6018A300000000000000", 2);
    TEST_ASSERT_EQUAL_STRING("8020210003000405", link_bench_sdo("A202010000000000"));
}

static void begin_block_of_two(void)
{
    TEST_ASSERT_EQUAL_STRING("A420210002000000", link_bench_sdo("C620210008000000"));
    TEST_ASSERT_EQUAL_STRING("z\r", link_bench_say("t60180100000000000000", 2));
    TEST_ASSERT_EQUAL_STRING("A202020000000000", link_bench_sdo("8240000000000000"));
}

static void test_blocks_are_received_and_checked(void)
{
    link_bench_open();
    begin_block_of_two();
    TEST_ASSERT_EQUAL_STRING("8020210004000405", link_bench_sdo("D900000000000000"));
    begin_block_of_two();
    TEST_ASSERT_EQUAL_STRING("8020210010000706", link_bench_sdo("D5C4480000000000"));
    begin_block_of_two();
    TEST_ASSERT_EQUAL_STRING("A100000000000000", link_bench_sdo("D9C4480000000000"));
    TEST_ASSERT_TRUE(bench.application.chosen.current_limit_A == 2.0);
    TEST_ASSERT_EQUAL_STRING("A420210002000000", link_bench_sdo("C420210000000000"));
    TEST_ASSERT_EQUAL_STRING("A200020000000000", link_bench_sdo("0200000000000000")); /* lost 1 */
    TEST_ASSERT_EQUAL_STRING("z\r", link_bench_say("t60188000000000000000", 2));      /* abort */
    TEST_ASSERT_EQUAL_STRING("8000100002000106", link_bench_sdo("C400100000000000"));
    TEST_ASSERT_EQUAL_STRING("8020210010000706", link_bench_sdo("C620210004000000"));
}

/* Of a client that is gone. */
static void test_a_request_ends_a_block_that_was_left(void)
{
    static const char *const requests[] = {"4000100000000000", "2B17100010000000",
                                           "C420210000000000", "A000100004000000"};

    link_bench_open();
    for (size_t i = 0; i < sizeof requests / sizeof requests[0]; i++) {
        TEST_ASSERT_EQUAL_STRING("A420210002000000", link_bench_sdo("C420210000000000"));
        TEST_ASSERT_NOT_EQUAL('8', link_bench_sdo(requests[i])[0]);
        TEST_ASSERT_EQUAL_STRING("4300100092010400", link_bench_sdo("4000100000000000"));
    }
}

static void test_a_setting_that_waits_is_refused_while_the_drive_is_ready(void)
{
    link_bench_open();
    (void)link_bench_sdo("2F00220001000000"); /* enable */
    bench_periods(10);
    TEST_ASSERT_EQUAL(DRIVE_OPERATION_ENABLED, bench.application.drive.supervision.state);
    TEST_ASSERT_EQUAL_STRING("8007210022000008", link_bench_sdo("2F07210000000000"));
}

static void test_a_fault_is_an_emergency_and_stays_in_the_list(void)
{
    link_bench_open();
    (void)link_bench_sdo("2F00220001000000");
    bench_periods(10);
    bench.samples.bus_voltage = 0;
    link_bench_heard("t0818003205040000000", link_bench_say("t0000", 30));
    TEST_ASSERT_EQUAL_STRING("4F01100005000000", link_bench_sdo("4001100000000000"));
    TEST_ASSERT_EQUAL_STRING("4303100100320400", link_bench_sdo("4003100100000000"));
    bench.samples.bus_voltage = 3151;
    link_bench_heard("t08180000000000000000",
                     link_bench_say("t60182F00220002000000", 30)); /* disable */
}

/* The first that is sent, taken off, with what stands in `entry` as its only object. */
static const char *map_one(const char *entry)
{
    char line[32];

    (void)link_bench_sdo("23001801810100C0");
    (void)link_bench_sdo("2F001A0000000000");
    snprintf(line, sizeof line, "23001A01%s", entry);
    return link_bench_sdo(line);
}

static void test_a_pdo_is_mapped_at_run_time_and_sent_when_it_changes(void)
{
    link_bench_open();
    TEST_ASSERT_EQUAL_STRING("6000180200000000", link_bench_sdo("2F001802FF000000"));
    TEST_ASSERT_EQUAL_STRING("6000180500000000", link_bench_sdo("2B00180500000000"));
    TEST_ASSERT_EQUAL_STRING("60001A0100000000", map_one("08000023")); /* 2300h, state */
    TEST_ASSERT_EQUAL_STRING("60001A0000000000", link_bench_sdo("2F001A0001000000"));
    TEST_ASSERT_EQUAL_STRING("6000180100000000", link_bench_sdo("2300180181010040"));
    link_bench_heard("t181100\r", link_bench_say("t00020101", 12));
    TEST_ASSERT_EQUAL_STRING("z\r", link_bench_say("t1230", 100));
    link_bench_heard("t181104\r", link_bench_say("t60182F00220001000000", 20)); /* enable */
    TEST_ASSERT_EQUAL_STRING("8000180130000906", link_bench_sdo("23001801FFFFFF1F"));
}

static void test_a_mapping_that_cannot_be_is_refused(void)
{
    link_bench_open();
    TEST_ASSERT_EQUAL_STRING("80001A0141000406", map_one("08006060")); /* 6060h, not sent */
    TEST_ASSERT_EQUAL_STRING("80001A0141000406", map_one("10000023")); /* of 8 bits, not 16 */
    TEST_ASSERT_EQUAL_STRING("80001A0100000206", map_one("08000250")); /* there is none */
    TEST_ASSERT_EQUAL_STRING("60001A0100000000", map_one("40002023"));
    TEST_ASSERT_EQUAL_STRING("60001A0200000000", link_bench_sdo("23001A0240002123"));
    TEST_ASSERT_EQUAL_STRING("80001A0042000406", link_bench_sdo("2F001A0002000000")); /* 128 bits */
    TEST_ASSERT_EQUAL_STRING("60001A0000000000", link_bench_sdo("2F001A0001000000"));
    TEST_ASSERT_EQUAL_STRING("80001A0122000008", link_bench_sdo("23001A0108000023")); /* in force */
}

/* Of NMT, of heartbeats, of another node's SDO: whoever sends them commands the bus. */
static void test_identifiers_that_the_bus_needs_are_not_to_be_had(void)
{
    link_bench_open();
    TEST_ASSERT_EQUAL_STRING("6000180100000000", link_bench_sdo("2300180100000080")); /* none */
    TEST_ASSERT_EQUAL_STRING("6000140100000000", link_bench_sdo("2300140100000080"));
    TEST_ASSERT_EQUAL_STRING("8000180130000906", link_bench_sdo("2300180100000040"));
    TEST_ASSERT_EQUAL_STRING("8000180130000906", link_bench_sdo("2300180101070040"));
    TEST_ASSERT_EQUAL_STRING("8000140130000906", link_bench_sdo("2300140102060000"));
    TEST_ASSERT_EQUAL_STRING("8005100030000906", link_bench_sdo("2305100080000040")); /* makes it */
    TEST_ASSERT_EQUAL_STRING("8000180130000906", link_bench_sdo("23001801900100A0")); /* 29 bits */
    TEST_ASSERT_EQUAL_STRING("8016100130000906", link_bench_sdo("2316100114008000")); /* node 128 */
    TEST_ASSERT_EQUAL_STRING("8016100130000906", link_bench_sdo("2316100114000501"));
    TEST_ASSERT_EQUAL_STRING("6016100100000000", link_bench_sdo("2316100114007F00"));
    TEST_ASSERT_EQUAL_STRING("6000180100000000", link_bench_sdo("2300180190010040"));
}

static void test_a_pdo_that_is_too_short_is_an_emergency_until_one_is_right(void)
{
    link_bench_open();
    (void)link_bench_say("t00020101", 2);
    link_bench_heard("t08181082110000000000\r", link_bench_say("t201106", 3));
    TEST_ASSERT_EQUAL_HEX32(0x11, link_bench_get(0x1001, 0));
    TEST_ASSERT_NULL(strstr(link_bench_say("t201106", 3), "t081"));
    link_bench_heard("t08180000000000000000\r", link_bench_say("t20120600", 3));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(0x1001, 0));
    TEST_ASSERT_NULL(strstr(link_bench_say("t20120600", 3), "t081"));
    link_bench_heard("t08181082110000000000\r", link_bench_say("t2010", 3));
    TEST_ASSERT_EQUAL_STRING("4F03100002000000", link_bench_sdo("4003100000000000"));
    TEST_ASSERT_EQUAL_STRING("6003100000000000", link_bench_sdo("2F03100000000000"));
    TEST_ASSERT_EQUAL_STRING("8003100124000008", link_bench_sdo("4003100100000000")); /* none */
}

/* Each PDO has an error of its own, which ends with the PDO, too. */
static void test_errors_of_pdos_end_with_the_last_of_them(void)
{
    link_bench_open();
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1403, 1, 4, 0x501));
    (void)link_bench_say("t00020101", 2);
    link_bench_heard("t08181082110000000000\r", link_bench_say("t5010", 3));
    link_bench_heard("t08181082110000000000\r", link_bench_say("t2010", 3));
    TEST_ASSERT_NULL(strstr(link_bench_say("t20120600", 3), "t081"));
    TEST_ASSERT_EQUAL_HEX32(0x11, link_bench_get(0x1001, 0));
    link_bench_heard("t08180000000000000000\r",
                     link_bench_say("t60182303140101050080", 3)); /* invalid */
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(0x1001, 0));
}

static void test_a_number_of_the_node_acts_when_communication_is_reset(void)
{
    link_bench_open();
    (void)link_bench_sdo("2325210005000000"); /* node_id 5 */
    TEST_ASSERT_EQUAL(5, (int)bench.application.chosen.node_id);
    TEST_ASSERT_EQUAL_STRING("4325210005000000", link_bench_sdo("4025210000000000"));
    link_bench_heard("t705100\r", link_bench_say("t00028201", 2));
    TEST_ASSERT_EQUAL_STRING("", link_bench_sdo("4025210000000000"));
    link_bench_heard("t5858", link_bench_say("t60584025210000000000", 2));
}

/* 1017h is of communication, 2403h is ours, 6060h and 6083h are of the profile. */
static void put_and_reset(unsigned command)
{
    TEST_ASSERT_EQUAL(0, link_bench_put(0x1017, 0, 2, 500));
    TEST_ASSERT_EQUAL(0, link_bench_put(0x2403, 1, 2, 600));
    TEST_ASSERT_EQUAL(0, link_bench_put(0x6060, 0, 1, 3));
    TEST_ASSERT_EQUAL(0, link_bench_put(0x6083, 0, 4, 65536));
    if (command != 0u) {
        link_bench_heard("t701100\r", link_bench_nmt(command, 2));
    } else {
        (void)link_bench_say("C", 1);
        link_bench_heard("t701100\r", link_bench_say("O", 2));
    }
    TEST_ASSERT_EQUAL(0, link_bench_get(0x1017, 0));
}

static void test_communication_that_begins_anew_leaves_the_profile(void)
{
    link_bench_open();
    for (unsigned command = 0; command <= 0x82u; command += 0x82u) {
        put_and_reset(command);
        TEST_ASSERT_EQUAL(600, link_bench_get(0x2403, 1));
        TEST_ASSERT_EQUAL(3, link_bench_get(0x6060, 0));
        TEST_ASSERT_EQUAL(65536, link_bench_get(0x6083, 0));
        TEST_ASSERT_EQUAL(2, link_bench_get(0x2403, 0));
    }
}

static void test_a_node_that_is_reset_is_as_from_power_up(void)
{
    link_bench_open();
    const uint32_t acceleration = link_bench_get(0x6083, 0);

    put_and_reset(0x81);
    TEST_ASSERT_EQUAL(700, link_bench_get(0x2403, 1));
    TEST_ASSERT_EQUAL(1, link_bench_get(0x6060, 0));
    TEST_ASSERT_EQUAL(acceleration, link_bench_get(0x6083, 0));
}

static void test_a_node_that_is_reset_has_the_settings_that_are_stored(void)
{
    link_bench_open();
    bench.application.chosen.current_limit_A = 2.0;
    TEST_ASSERT_EQUAL(0, link_bench_put(0x1010, 1, 4, 0x65766173));
    TEST_ASSERT_EQUAL(0, link_bench_put(0x6072, 0, 2, 500));
    TEST_ASSERT_TRUE(bench.application.chosen.current_limit_A == 1.5);
    (void)link_bench_nmt(0x81, 2);
    TEST_ASSERT_TRUE(bench.application.chosen.current_limit_A == 2.0);
}

static void test_pdos_wait_for_sync(void)
{
    link_bench_open();
    (void)link_bench_sdo("2F00180202000000"); /* sent with every second */
    (void)link_bench_sdo("2F00140200000000"); /* received: acts with the next */
    (void)link_bench_say("t00020101", 2);
    (void)link_bench_say("t20120600", 2); /* shutdown */
    TEST_ASSERT_EQUAL_STRING("4B41600040020000", link_bench_sdo("4041600000000000"));
    TEST_ASSERT_EQUAL_STRING("z\r", link_bench_say("t0800", 20));
    TEST_ASSERT_EQUAL_STRING("4B41600021020000", link_bench_sdo("4041600000000000"));
    link_bench_heard("t18122102\r", link_bench_say("t0800", 20));
}

static long inputs = 100000;

static void type_frame(const struct can_frame *frame)
{
    char line[40];
    size_t end = (size_t)snprintf(line, sizeof line, "t%03X%u", frame->id, frame->length);

    for (unsigned i = 0; i < frame->length; i++) {
        end += (size_t)snprintf(&line[end], sizeof line - end, "%02X", frame->data[i]);
    }
    bench_type(line);
    bench_type("\r");
}

/* Until what has been typed is read, and some periods more. */
static void pass(int periods)
{
    for (int i = 0; i < periods || bench.typed_read < bench.typed_count; i++) {
        TEST_ASSERT_TRUE(i < 10000);
        bench_periods(1);
        (void)bench_heard();
    }
}

/* What the device type is asked for, whatever number the node has by now. */
static void assert_the_node_answers(void)
{
    const unsigned node = bench_link.node;
    char request[40], response[40];

    snprintf(request, sizeof request, "t%03X84000100000000000", 0x600u + node);
    snprintf(response, sizeof response, "t%03X84300100092010400\r", 0x580u + node);
    link_bench_heard(response, link_bench_say(request, 2));
}

/* Of CANopen as text: lines that are whole, and some that are none. */
static void test_whatever_comes_the_node_goes_on(void)
{
    fuzz_find_objects();
    for (long i = 0; i < inputs; i++) {
        if (i % FUZZ_BETWEEN_STARTS == 0) {
            fuzz_start();
        }
        if (fuzz_once_in(64)) {
            char bytes[8];

            for (size_t n = 0; n < sizeof bytes; n++) {
                bytes[n] = (char)fuzz_draw(256);
            }
            bench_type_bytes(bytes, sizeof bytes);
        }
        if (!bench_link.open) {
            bench_type("\rO\r");
        }
        const struct can_frame frame = fuzz_frame();

        type_frame(&frame);
        pass(4);
        fuzz_look();
    }
    TEST_ASSERT_TRUE(fuzz.captures >= inputs / 100);
    TEST_ASSERT_TRUE(fuzz.enabled >= inputs / 100);
    (void)link_bench_say("", 20); /* the end of a line that is being received */
    (void)link_bench_say("C", 20);
    (void)link_bench_say("O", 2);
    assert_the_node_answers();
}

/* An argument is how many inputs there are to be of any content. */
int main(int count, char **arguments)
{
    inputs = count > 1 ? strtol(arguments[1], NULL, 10) : inputs;
    UNITY_BEGIN();
    RUN_TEST(test_an_open_channel_boots_the_node_and_silences_the_console);
    RUN_TEST(test_a_client_that_listens_is_answered_nothing);
    RUN_TEST(test_heartbeats_show_the_state_of_the_node);
    RUN_TEST(test_objects_are_read_at_once_or_in_segments);
    RUN_TEST(test_what_is_not_there_is_said_by_its_abort_code);
    RUN_TEST(test_a_setting_is_written_in_segments);
    RUN_TEST(test_blocks_are_sent_acknowledged_and_checked);
    RUN_TEST(test_a_block_has_no_checksum_unless_it_is_asked_for);
    RUN_TEST(test_more_than_was_sent_is_not_acknowledged);
    RUN_TEST(test_blocks_are_received_and_checked);
    RUN_TEST(test_a_request_ends_a_block_that_was_left);
    RUN_TEST(test_a_setting_that_waits_is_refused_while_the_drive_is_ready);
    RUN_TEST(test_a_fault_is_an_emergency_and_stays_in_the_list);
    RUN_TEST(test_a_pdo_is_mapped_at_run_time_and_sent_when_it_changes);
    RUN_TEST(test_a_mapping_that_cannot_be_is_refused);
    RUN_TEST(test_identifiers_that_the_bus_needs_are_not_to_be_had);
    RUN_TEST(test_a_pdo_that_is_too_short_is_an_emergency_until_one_is_right);
    RUN_TEST(test_errors_of_pdos_end_with_the_last_of_them);
    RUN_TEST(test_a_number_of_the_node_acts_when_communication_is_reset);
    RUN_TEST(test_communication_that_begins_anew_leaves_the_profile);
    RUN_TEST(test_a_node_that_is_reset_is_as_from_power_up);
    RUN_TEST(test_a_node_that_is_reset_has_the_settings_that_are_stored);
    RUN_TEST(test_pdos_wait_for_sync);
    RUN_TEST(test_whatever_comes_the_node_goes_on);
    return UNITY_END();
}
