/* The node on a CAN bus beside the console: which carrier it lives on, and what it says of the bus.
 */
#include <stdlib.h>

#include "firmware/link/axis_motion.h"
#include "tests/unit/link_fuzz.h"

enum { FRAMES = 64 };

/* A bus whose other end is the test. */
static struct {
    struct can_frame sent[FRAMES], coming[FRAMES];
    size_t sent_count, coming_count, taken;
    size_t room;
    uint16_t ids[HAL_CAN_IDS];
    bool accepts;
    uint32_t state;
} bus;

static bool bus_receive(void *context, struct can_frame *frame)
{
    TEST_ASSERT_EQUAL_PTR(&bus, context);
    if (bus.taken == bus.coming_count) {
        return false;
    }
    *frame = bus.coming[bus.taken++];
    return true;
}

static size_t bus_room(void *context)
{
    (void)context;
    return bus.room;
}

static void bus_send(void *context, const struct can_frame *frame)
{
    (void)context;
    if (bus.sent_count < FRAMES) {
        bus.sent[bus.sent_count++] = *frame;
    }
}

static void bus_accept(void *context, const uint16_t ids[HAL_CAN_IDS])
{
    (void)context;
    bus.accepts = ids != NULL;
    for (size_t i = 0; i < HAL_CAN_IDS; i++) {
        bus.ids[i] = ids == NULL ? 0xffffu : ids[i];
    }
}

static uint32_t bus_state(void *context)
{
    const uint32_t state = bus.state;

    (void)context;
    bus.state &= ~(uint32_t)HAL_CAN_LOST;
    return state;
}

static const struct hal_can bench_can = {.context = &bus,
                                         .receive = bus_receive,
                                         .room = bus_room,
                                         .send = bus_send,
                                         .accept = bus_accept,
                                         .state = bus_state};

void setUp(void)
{
    memset(&bus, 0, sizeof bus);
    bus.room = 8;
    link_bench_start();
    link_put_can(&bench_link, &bench_can);
}

void tearDown(void)
{
}

/* A frame from the bus, of digits as those of slcan, and some periods for it. */
static void come(uint16_t id, const char *digits, int periods)
{
    struct can_frame frame = {.id = id, .length = (uint8_t)(strlen(digits) / 2u)};

    for (size_t i = 0; i < frame.length; i++) {
        unsigned byte;

        TEST_ASSERT_EQUAL_INT(1, sscanf(&digits[2u * i], "%2x", &byte));
        frame.data[i] = (uint8_t)byte;
    }
    if (bus.taken == bus.coming_count) {
        bus.taken = bus.coming_count = 0;
    }
    TEST_ASSERT_TRUE(bus.coming_count < FRAMES);
    bus.coming[bus.coming_count++] = frame;
    bench_periods(periods);
}

static void expect_sent(size_t at, uint16_t id, const char *digits)
{
    char text[20] = "";

    TEST_ASSERT_TRUE_MESSAGE(at < bus.sent_count, digits);
    for (size_t i = 0; i < bus.sent[at].length; i++) {
        snprintf(&text[2u * i], 3, "%02X", bus.sent[at].data[i]);
    }
    TEST_ASSERT_EQUAL_HEX16(id, bus.sent[at].id);
    TEST_ASSERT_EQUAL_STRING(digits, text);
}

static void put(unsigned index, unsigned bytes, uint32_t value)
{
    const unsigned specifier = 0x23u | (4u - bytes) << 2;
    char request[20];

    snprintf(request, sizeof request, "%02X%02X%02X%02X%02X%02X%02X%02X", specifier & 255u,
             index & 255u, index >> 8 & 255u, index == 0x1016u ? 1u : 0u, (unsigned)(value & 255u),
             (unsigned)(value >> 8 & 255u), (unsigned)(value >> 16 & 255u),
             (unsigned)(value >> 24));
    bus.sent_count = 0;
    come(0x601, request, 2);
    TEST_ASSERT_EQUAL_HEX16(0x581, bus.sent[0].id);
    TEST_ASSERT_EQUAL_HEX8(0x60, bus.sent[0].data[0]);
}

/* In profile velocity, at a turn in a second. */
static void enable(void)
{
    put(0x6060, 1, 3);
    for (uint32_t word = 6; word < 16u; word += word == 7u ? 8u : 1u) {
        put(0x6040, 2, word);
        bench_periods(20);
    }
    put(0x60ff, 4, 65536);
    bench_periods(1000);
    TEST_ASSERT_EQUAL_HEX8(CIA402_OPERATION_ENABLED, bench_link.axis.state);
    bus.sent_count = 0;
}

static bool is_off(void)
{
    return bench.application.drive.supervision.state == DRIVE_SWITCH_ON_DISABLED;
}

static bool accepts(uint16_t id)
{
    for (size_t i = 0; i < HAL_CAN_IDS; i++) {
        if (bus.accepts && bus.ids[i] == id) {
            return true;
        }
    }
    return false;
}

/* ---- which carrier ---- */

static void test_the_node_says_that_it_lives_on_the_bus_and_the_console_goes_on(void)
{
    bench_periods(2);
    TEST_ASSERT_EQUAL_size_t(1, bus.sent_count);
    expect_sent(0, 0x701, "00");
    come(0x601, "4000100000000000", 2);
    expect_sent(1, 0x581, "4300100092010400");
    bench_type("state\n");
    bench_periods(3);
    link_bench_heard("ok switch-on-disabled", bench_heard());
    bench_type("t6018400010000000000\r");
    bench_periods(3);
    TEST_ASSERT_EQUAL_STRING("\a", bench_heard()); /* the line's channel is closed */
    TEST_ASSERT_EQUAL_size_t(2, bus.sent_count);
}

static void test_a_pass_takes_a_frame(void)
{
    bench_periods(1);
    for (int i = 0; i < 3; i++) {
        come(0x601, "4000100000000000", 0);
    }
    for (size_t i = 1; i <= 3u; i++) {
        bench_periods(1);
        TEST_ASSERT_EQUAL_size_t(i, bus.taken);
    }
}

/* Until it closes. */
static void test_the_line_takes_the_channel_when_it_is_opened(void)
{
    bench_periods(2);
    bus.sent_count = 0;
    link_bench_heard("\rt701100\r", link_bench_say("O", 2));
    TEST_ASSERT_FALSE(bus.accepts);
    come(0x601, "4000100000000000", 20);
    TEST_ASSERT_EQUAL_size_t(0, bus.taken);
    link_bench_heard("t58184300100092010400\r", link_bench_say("t60184000100000000000", 2));
    TEST_ASSERT_EQUAL_size_t(0, bus.sent_count);
    TEST_ASSERT_EQUAL_STRING("\r", link_bench_say("C", 3));
    TEST_ASSERT_EQUAL_size_t(1, bus.sent_count); /* what has come meanwhile is not answered */
    expect_sent(0, 0x701, "00");
    TEST_ASSERT_TRUE(bus.accepts);
}

static void test_modbus_takes_it_too(void)
{
    bench_periods(2);
    bus.sent_count = 0;
    bench_type("modbus\n");
    bench_periods(20);
    come(0x601, "4000100000000000", 20);
    TEST_ASSERT_EQUAL_size_t(0, bus.sent_count);
    bench_type("C\r");
    bench_periods(100);
    expect_sent(0, 0x701, "00");
}

static void test_a_line_that_closes_what_it_has_not_opened_leaves_the_bus_alone(void)
{
    bench_periods(2);
    bus.sent_count = 0;
    TEST_ASSERT_EQUAL_STRING("\r", link_bench_say("C", 20));
    TEST_ASSERT_EQUAL_size_t(0, bus.sent_count);
    TEST_ASSERT_TRUE(bench_link.open && bench_link.on_bus);
}

/* Of `L`, too, which only listens. */
static void test_what_the_bus_has_moved_stops_when_the_line_takes_the_channel(void)
{
    static const char *const opened[] = {"O", "L"};

    for (int i = 0; i < 2; i++) {
        setUp();
        bench_periods(2);
        enable();
        (void)link_bench_say(opened[i], 5000);
        TEST_ASSERT_TRUE(axis_motion_rests(&bench.application));
        TEST_ASSERT_FALSE(is_off());
    }
}

static void test_a_quick_stop_of_the_line_ends_before_the_node_is_back_on_the_bus(void)
{
    bench_periods(2);
    link_bench_open();
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1006, 0, 4, 4000));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x6060, 0, 1, 3));
    for (unsigned word = 6; word < 16u; word += word == 7u ? 8u : 1u) {
        TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x6040, 0, 2, word));
        bench_periods(20);
    }
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x60ff, 0, 4, 65536));
    bench_periods(1000);
    (void)link_bench_nmt(1, 2);
    (void)link_bench_say("t0800", 2);
    bus.sent_count = 0;
    (void)link_bench_say("C", 10);
    TEST_ASSERT_EQUAL_size_t(0, bus.sent_count);
    bench_periods(8000);
    TEST_ASSERT_TRUE(is_off());
    expect_sent(0, 0x701, "00");
}

/* It is not the bus that has enabled it. */
static void test_what_the_console_has_enabled_outlives_the_line_and_the_bus(void)
{
    bench_periods(2);
    bench_type("enable\n");
    bench_periods(500);
    TEST_ASSERT_FALSE(is_off());
    TEST_ASSERT_EQUAL_HEX8(CIA402_SWITCH_ON_DISABLED, bench_link.axis.state);
    (void)link_bench_say("L", 20);
    (void)link_bench_say("C", 20);
    TEST_ASSERT_EQUAL_HEX8(CIA402_SWITCH_ON_DISABLED, bench_link.axis.state);
    bus.state = HAL_CAN_OFF;
    bench_periods(5000);
    TEST_ASSERT_FALSE(is_off());
    bus.state = 0;
    come(0x000, "8201", 20); /* reset communication: a master has what it finds */
    TEST_ASSERT_EQUAL_HEX8(CIA402_SWITCHED_ON, bench_link.axis.state);
    TEST_ASSERT_FALSE(is_off());
}

static void test_a_board_without_a_bus_has_none(void)
{
    link_put_can(&bench_link, NULL);
    bench_periods(100);
    TEST_ASSERT_FALSE(bench_link.open);
    link_bench_heard("t701100\r", link_bench_say("O", 2));
}

/* ---- what the board receives ---- */

static void test_the_board_receives_what_is_for_this_node_and_nothing_else(void)
{
    bench_periods(2);
    come(0x601, "2300140180020080", 2); /* 1400h, 1: 280h */
    come(0x601, "2300140180020000", 2);
    bench_periods(20);
    TEST_ASSERT_TRUE(accepts(0x280) && !accepts(0x201) && !accepts(0x602) && !accepts(0x581));
    come(0x601, "2300140101020080", 2);
    put(0x1016, 4, 0x00050014);
    bench_periods(20);
    TEST_ASSERT_TRUE(accepts(0x000) && accepts(0x080) && accepts(0x601) && accepts(0x705));
    TEST_ASSERT_FALSE(accepts(0x201)); /* it is not valid */
}

/* ---- errors of the bus ---- */

static void test_error_passive_is_an_emergency_and_another_one_when_it_is_over(void)
{
    bench_periods(20);
    bus.sent_count = 0;
    bus.state = HAL_CAN_PASSIVE;
    bench_periods(200);
    TEST_ASSERT_EQUAL_size_t(1, bus.sent_count);
    expect_sent(0, 0x081, "2081110000000000");
    TEST_ASSERT_EQUAL_HEX32(0x8120, bench_link.objects.error_1);
    bus.state = 0;
    bench_periods(200);
    TEST_ASSERT_EQUAL_size_t(2, bus.sent_count);
    expect_sent(1, 0x081, "0000000000000000");
}

static void test_frames_that_were_lost_are_an_emergency_once_in_a_second(void)
{
    bench_periods(20);
    bus.sent_count = 0;
    for (int i = 0; i < 1500; i++) { /* 1.5 s */
        bus.state = HAL_CAN_LOST;
        bench_periods(10);
    }
    TEST_ASSERT_EQUAL_size_t(2, bus.sent_count);
    expect_sent(0, 0x081, "1081000000000000");
}

static void test_bus_off_stops_the_drive_and_the_way_back_is_an_emergency(void)
{
    bench_periods(2);
    enable();
    bus.state = HAL_CAN_PASSIVE | HAL_CAN_OFF;
    bench_periods(20);
    TEST_ASSERT_EQUAL_HEX8(CIA402_QUICK_STOP_ACTIVE, bench_link.axis.state);
    TEST_ASSERT_FALSE(is_off()); /* it is braked before */
    bench_periods(4000);
    TEST_ASSERT_TRUE(is_off());
    TEST_ASSERT_EQUAL_size_t(0, bus.sent_count);
    TEST_ASSERT_EQUAL_HEX8(0x11, link_error_register(&bench.application));
    bus.state = 0;
    bench_periods(200);
    TEST_ASSERT_EQUAL_size_t(2, bus.sent_count);
    expect_sent(0, 0x081, "4081110000000000");
    expect_sent(1, 0x081, "0000000000000000");
    put(0x6040, 2, 6); /* the master has it again */
    bench_periods(20);
    TEST_ASSERT_EQUAL_HEX8(CIA402_READY_TO_SWITCH_ON, bench_link.axis.state);
}

static void test_a_node_that_is_only_switched_on_is_off_at_once(void)
{
    bench_periods(2);
    put(0x6040, 2, 6);
    bench_periods(20);
    put(0x6040, 2, 7);
    bench_periods(200);
    TEST_ASSERT_FALSE(is_off());
    bus.state = HAL_CAN_OFF;
    bench_periods(30);
    TEST_ASSERT_TRUE(is_off());
}

/* A quick stop comes in whether or not the node gets its own frames out. */
static void test_a_bus_that_takes_nothing_is_heard(void)
{
    bench_periods(2);
    enable();
    bus.room = 0;
    come(0x601, "2B40600002000000", 20);
    TEST_ASSERT_EQUAL_HEX8(CIA402_QUICK_STOP_ACTIVE, bench_link.axis.state);
}

/* ---- whatever comes ---- */

static long inputs = 100000;

/* What the node puts on the bus is what a slave may send. */
static void look_at_what_was_sent(void)
{
    for (size_t i = 0; i < bus.sent_count; i++) {
        TEST_ASSERT_TRUE(bus.sent[i].id >= 0x80u && bus.sent[i].id <= 0x7ffu);
        TEST_ASSERT_TRUE(bus.sent[i].length <= 8u);
    }
    bus.sent_count = 0;
}

/* Errors of the bus, no room on it, and a line that takes the channel and closes it. */
static void disturb(void)
{
    static const char *const lines[] = {"O\r", "L\r", "C\r", "C\r", "state\n", "modbus\n"};

    switch (fuzz_draw(64)) {
    case 0:
        bus.state = fuzz_draw(8);
        break;
    case 1:
    case 2:
        bus.state = 0;
        break;
    case 3:
        bus.room = fuzz_draw(9);
        break;
    case 4:
    case 5:
        bus.room = 8;
        break;
    case 6:
        bench_type(lines[fuzz_draw(6)]);
        break;
    case 7:
        bench_periods(60);
        bench_type("C\r"); /* ends Modbus, between two silences */
        bench_periods(60);
        break;
    default:
        break;
    }
}

static void start_on_the_bus(void)
{
    memset(&bus, 0, sizeof bus);
    bus.room = 8;
    fuzz_start();
    link_put_can(&bench_link, &bench_can);
    bench_periods(2);
}

/* What the board would not receive, too. */
static void test_whatever_comes_the_node_goes_on(void)
{
    fuzz_find_objects();
    for (long i = 0; i < inputs; i++) {
        if (i % FUZZ_BETWEEN_STARTS == 0) {
            start_on_the_bus();
        }
        disturb();
        if (bus.taken == bus.coming_count) {
            bus.taken = bus.coming_count = 0;
        }
        if (bus.coming_count < FRAMES) {
            bus.coming[bus.coming_count++] = fuzz_frame();
        }
        bench_periods((int)fuzz_draw(4));
        look_at_what_was_sent();
        (void)bench_heard();
        fuzz_look();
    }
    TEST_ASSERT_TRUE(fuzz.captures >= inputs / 100);
    TEST_ASSERT_TRUE(fuzz.enabled >= inputs / 100);
    bus.room = 8;
    bus.state = 0;
    bench_periods(100);
    bench_type("C\r");
    bench_periods(20000); /* a quick stop ends before the node is back */
    look_at_what_was_sent();
    come(0x000, "8200", 4);
    expect_sent(0, (uint16_t)(0x700u + bench_link.node), "00");
    come((uint16_t)bench_link.objects.sdo_request, "4000100000000000", 4);
    /* Behind the emergency of a drive that is in fault. */
    expect_sent(bus.sent_count - 1u, (uint16_t)bench_link.objects.sdo_response, "4300100092010400");
}

/* An argument is how many inputs there are to be of any content. */
int main(int count, char **arguments)
{
    inputs = count > 1 ? strtol(arguments[1], NULL, 10) : inputs;
    UNITY_BEGIN();
    RUN_TEST(test_the_node_says_that_it_lives_on_the_bus_and_the_console_goes_on);
    RUN_TEST(test_a_pass_takes_a_frame);
    RUN_TEST(test_the_line_takes_the_channel_when_it_is_opened);
    RUN_TEST(test_modbus_takes_it_too);
    RUN_TEST(test_a_line_that_closes_what_it_has_not_opened_leaves_the_bus_alone);
    RUN_TEST(test_what_the_bus_has_moved_stops_when_the_line_takes_the_channel);
    RUN_TEST(test_a_quick_stop_of_the_line_ends_before_the_node_is_back_on_the_bus);
    RUN_TEST(test_what_the_console_has_enabled_outlives_the_line_and_the_bus);
    RUN_TEST(test_a_board_without_a_bus_has_none);
    RUN_TEST(test_the_board_receives_what_is_for_this_node_and_nothing_else);
    RUN_TEST(test_error_passive_is_an_emergency_and_another_one_when_it_is_over);
    RUN_TEST(test_frames_that_were_lost_are_an_emergency_once_in_a_second);
    RUN_TEST(test_bus_off_stops_the_drive_and_the_way_back_is_an_emergency);
    RUN_TEST(test_a_node_that_is_only_switched_on_is_off_at_once);
    RUN_TEST(test_a_bus_that_takes_nothing_is_heard);
    RUN_TEST(test_whatever_comes_the_node_goes_on);
    return UNITY_END();
}
