/* Frames as text. */
#include <unity.h>

#include "firmware/link/slcan.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static enum slcan_meaning read_line(const char *line, struct can_frame *frame)
{
    return slcan_read(line, strlen(line), frame);
}

static void test_a_frame_is_read_and_written_as_the_same_text(void)
{
    static const char *const lines[] = {"t0000\r", "t7FF80102030405060708\r", "t1232AABB\r"};

    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        struct can_frame frame = {.id = 0};
        char text[SLCAN_FRAME_BYTES + 1] = "";

        TEST_ASSERT_EQUAL(SLCAN_SENDS, slcan_read(lines[i], strlen(lines[i]) - 1u, &frame));
        TEST_ASSERT_EQUAL(strlen(lines[i]), slcan_write(&frame, text));
        TEST_ASSERT_EQUAL_STRING_LEN(lines[i], text, strlen(lines[i]));
    }
}

static void test_digits_may_be_small(void)
{
    struct can_frame frame;

    TEST_ASSERT_EQUAL(SLCAN_SENDS, read_line("t1232aabb", &frame));
    TEST_ASSERT_EQUAL_HEX8(0xbb, frame.data[1]);
}

static void test_what_is_no_frame_is_refused(void)
{
    static const char *const lines[] = {"t",
                                        "t12",
                                        "t1239AABBCCDDEEFF0011",
                                        "t1239AABBCCDDEEFF001122",
                                        "t1232AAB",
                                        "t1232AABBC",
                                        "t8000",
                                        "t12G0",
                                        "t1231ZZ"};
    struct can_frame frame;

    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        TEST_ASSERT_EQUAL_MESSAGE(SLCAN_REFUSED, read_line(lines[i], &frame), lines[i]);
    }
}

static void test_every_rate_and_filter_is_accepted(void)
{
    static const char *const lines[] = {"S0", "S6", "S8",    "Y2",        "Z1",
                                        "X0", "U1", "s031C", "M00000000", "mFFFFFFFF"};
    struct can_frame frame;

    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        TEST_ASSERT_EQUAL_MESSAGE(SLCAN_SETS, read_line(lines[i], &frame), lines[i]);
    }
    TEST_ASSERT_EQUAL_STRING("\r", slcan_answer(SLCAN_SETS, false));
}

static void test_what_the_console_understands_is_no_slcan(void)
{
    static const char *const lines[] = {
        "",  "state",          "set node_id 3", "move 1.5", "S",   "OO",   "store",
        "X", "T123456782AABB", "r1232",         "move",     "set", "sine", "torque 0.1"};
    struct can_frame frame;

    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        TEST_ASSERT_EQUAL_MESSAGE(SLCAN_UNKNOWN, read_line(lines[i], &frame), lines[i]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_frame_is_read_and_written_as_the_same_text);
    RUN_TEST(test_digits_may_be_small);
    RUN_TEST(test_what_is_no_frame_is_refused);
    RUN_TEST(test_every_rate_and_filter_is_accepted);
    RUN_TEST(test_what_the_console_understands_is_no_slcan);
    return UNITY_END();
}
