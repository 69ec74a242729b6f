/* Modbus RTU: objects as registers, what is refused, and where a request begins and ends. */
#include <stdlib.h>

#include "firmware/link/modbus.h"
#include "tests/unit/link_fuzz.h"

enum { SILENCE = 60 /* periods */ };

void setUp(void)
{
    link_bench_start();
    TEST_ASSERT_EQUAL_STRING("ok modbus\n", link_bench_say("modbus", 1));
    bench_periods(SILENCE);
}

void tearDown(void)
{
}

static size_t bytes_of(const char *digits, uint8_t *bytes)
{
    size_t count = 0;
    unsigned byte;

    while (sscanf(digits, "%2x", &byte) == 1) {
        bytes[count++] = (uint8_t)byte;
        digits += digits[2] == ' ' ? 3 : 2;
    }
    return count;
}

static size_t with_crc(const char *digits, uint8_t *frame)
{
    const size_t count = bytes_of(digits, frame);
    const uint16_t crc = modbus_crc(frame, count);

    frame[count] = (uint8_t)crc;
    frame[count + 1u] = (uint8_t)(crc >> 8);
    return count + 2u;
}

static void send(const uint8_t *bytes, size_t count)
{
    (void)bench_heard();
    bench_type_bytes((const char *)bytes, count);
    bench_periods(8);
}

/* The frame without its checksum, which must be right. */
static const char *heard(void)
{
    static char digits[600];
    const size_t count = bench.written_count;
    const uint8_t *frame = (const uint8_t *)bench_heard();

    digits[0] = '\0';
    if (count >= 2u) {
        TEST_ASSERT_EQUAL_HEX16(0, modbus_crc(frame, count));
    }
    for (size_t i = 0; i + 2u < count; i++) {
        snprintf(&digits[2u * i], sizeof digits - 2u * i, "%02x", frame[i]);
    }
    return digits;
}

static void asked(const char *request, const char *response)
{
    uint8_t frame[300];

    send(frame, with_crc(request, frame));
    TEST_ASSERT_EQUAL_STRING_MESSAGE(response, heard(), request);
}

static void test_the_checksum_is_that_of_the_standard(void)
{
    uint8_t frame[16];
    const size_t count = bytes_of("01 03 00 00 00 0a", frame);

    TEST_ASSERT_EQUAL_HEX16(0xcdc5, modbus_crc(frame, count));
}

static void test_an_object_is_read_as_registers_highest_first(void)
{
    asked("01 03 1000 0002", "01030400040192");
    asked("01 04 1000 0002", "01040400040192");
    asked("01 03 605a 0001", "0103020002");
    asked("01 03 6060 0001", "0103020001");
    asked("01 03 2120 0004", "0103084008000000000000"); /* current_limit_A, 3 A */
}

static void test_an_array_is_read_from_its_first_value_on(void)
{
    asked("01 03 607d 0002", "01030480000000");
    asked("01 03 607d 0004", "010308800000007fffffff");
    asked("01 03 607d 0003", "018303");
    asked("01 03 607d 0006", "018302");
}

static void test_a_text_ends_with_zeros(void)
{
    uint8_t frame[64];

    send(frame, with_crc("01 03 1008 0010", frame));
    const char *digits = heard();

    TEST_ASSERT_EQUAL_STRING_LEN("010320", digits, 6);
    TEST_ASSERT_EQUAL_STRING("00", &digits[6 + 62]);
    TEST_ASSERT_TRUE(strncmp("00", &digits[6], 2) != 0);
}

static void test_registers_are_written_one_or_several(void)
{
    asked("01 06 6060 0003", "010660600003");
    asked("01 03 6060 0001", "0103020003");
    asked("01 06 60c2 0005", "010660c20005");
    asked("01 10 60c2 0002 04 0002 fffd", "011060c20002"); /* 2, 10^-3 */
    asked("01 03 60c2 0002", "0103040002fffd");
    asked("01 10 607a 0002 04 fffe 7960", "0110607a0002");
    TEST_ASSERT_EQUAL(-100000, bench_link.objects.target_position);
    asked("01 10 6060 0001 02 0001", "011060600001");
    asked("01 03 6060 0001", "0103020001");
    asked("01 10 2120 0004 08 3ff8 0000 0000 0000", "011021200004");
    TEST_ASSERT_TRUE(bench.application.chosen.current_limit_A == 1.5);
}

static void test_what_cannot_be_is_an_exception(void)
{
    asked("01 03 1234 0001", "018302"); /* no object */
    asked("01 06 6041 0000", "018602"); /* read only */
    asked("01 03 2200 0001", "018302"); /* write only */
    asked("01 03 2402 0001", "018302"); /* a domain */
    asked("01 03 1000 0001", "018303"); /* half of a value */
    asked("01 03 1000 0000", "018303");
    asked("01 03 1008 007e", "018303");
    asked("01 06 6060 0004", "018603"); /* no such mode */
    asked("01 06 6060 0103", "018603"); /* more than a byte */
    asked("01 06 6060 ff03", "018603");
    asked("01 10 607a 0002 02 0000", "019003");
    asked("01 10 6060 0000 00", "019003");
    asked("01 10 1010 0002 04 0000 0001", "019003"); /* not "save" */
    asked("01 06 2200 0003", "018604");              /* a command that the drive refuses */
    asked("01 08 0001 0000", "018801");
}

static void test_an_unknown_function_is_answered_behind_the_silence(void)
{
    uint8_t frame[16];

    send(frame, with_crc("01 2b 0e 01 00", frame));
    TEST_ASSERT_EQUAL_STRING("", heard());
    bench_periods(SILENCE);
    TEST_ASSERT_EQUAL_STRING("01ab01", heard());
}

static void test_an_echo_comes_back(void)
{
    asked("01 08 0000 a5c3", "01080000a5c3");
}

static void test_others_and_all_are_not_answered(void)
{
    asked("02 06 6060 0003", "");
    asked("01 03 6060 0001", "0103020001");
    asked("00 06 6060 0003", "");
    asked("01 03 6060 0001", "0103020003");
}

static void test_a_request_may_come_in_pieces_and_not_too_slowly(void)
{
    uint8_t frame[16];
    const size_t count = with_crc("01 03 605a 0001", frame);

    send(frame, 3);
    send(&frame[3], count - 3u);
    TEST_ASSERT_EQUAL_STRING("0103020002", heard());
    send(frame, 3);
    bench_periods(SILENCE);
    send(&frame[3], count - 3u);
    TEST_ASSERT_EQUAL_STRING("", heard());
    bench_periods(SILENCE);
    asked("01 03 605a 0001", "0103020002");
}

static void test_rubbish_is_over_with_the_silence(void)
{
    uint8_t frame[300];

    memset(frame, 0xa5, sizeof frame);
    send(frame, sizeof frame);
    bench_periods(SILENCE);
    TEST_ASSERT_EQUAL_STRING("", heard());
    send(frame, with_crc("01 03 605a 0001", frame) - 1u);
    bench_periods(SILENCE);
    TEST_ASSERT_EQUAL_STRING("", heard());
    asked("01 03 605a 0001", "0103020002");
}

static void test_the_drive_is_operated(void)
{
    asked("01 06 6040 0006", "010660400006");
    bench_periods(20);
    asked("01 03 6041 0001", "0103020221");
    asked("01 06 6040 0007", "010660400007");
    bench_periods(20);
    asked("01 03 6041 0001", "0103020233");
}

/* A client that asks is heard: a motion goes on as long as command_timeout_s lets it. */
static void test_a_request_is_heard(void)
{
    bench_periods(100);
    asked("02 03 6041 0001", "");
    TEST_ASSERT_TRUE(bench.period - bench.application.heard_in > 100u);
    asked("01 03 605a 0001", "0103020002");
    TEST_ASSERT_TRUE(bench.period - bench.application.heard_in < 10u);
}

/* No frame of CANopen comes between, a fault's emergency included. */
static void test_nothing_is_sent_unasked(void)
{
    asked("01 06 1017 000a", "01061017000a"); /* heartbeat, 10 ms */
    (void)bench_heard();
    bench_periods(400);
    TEST_ASSERT_EQUAL_STRING("", bench_heard());
}

static void test_the_console_comes_back(void)
{
    (void)bench_heard();
    bench_type("C\r");
    bench_periods(2 * SILENCE);
    TEST_ASSERT_EQUAL_STRING_LEN("ok ", bench_ask("state"), 3);
}

static void test_a_setting_makes_it_so_from_power_up(void)
{
    bench.application.chosen.modbus_rtu = true;
    application_put_link(&bench.application, &bench_link);
    asked("01 03 605a 0001", "0103020002");
    bench.application.chosen.modbus_rtu = false;
    application_put_link(&bench.application, &bench_link);
    TEST_ASSERT_FALSE(bench_link.open);
}

static long inputs = 100000;

static void type_bytes(const uint8_t *bytes, size_t count)
{
    bench_type_bytes((const char *)bytes, count);
    for (int i = 0; i < 4 || bench.typed_read < bench.typed_count; i++) {
        TEST_ASSERT_TRUE(i < 10000);
        bench_periods(1);
        (void)bench_heard();
    }
}

/* The values of an object from its first on, the highest register first, as they are written. */
static size_t registers_for(const struct object *first, uint32_t most, uint8_t *registers)
{
    struct object object = *first;
    size_t count = 0;

    for (uint32_t i = 0; i < most; i++) {
        uint8_t value[OBJECT_BYTES_MAX];
        const size_t bytes = fuzz_value(&object, value);
        const size_t words = (bytes + 1u) / 2u;

        for (size_t word = words; word > 0u; word--) {
            registers[count++] = value[2u * word - 1u];
            registers[count++] = value[2u * word - 2u];
        }
        object.sub++;
        if (objects_find(object.index, object.sub, &object) != OBJECT_DONE) {
            break;
        }
    }
    return count;
}

/* The next of the controlwords that enable the drive. */
static size_t request_to_enable(uint8_t *frame)
{
    static const uint8_t words[] = {0x06, 0x07, 0x0f};
    static size_t next;

    frame[0] = bench_link.node;
    frame[1] = 6;
    frame[2] = 0x60;
    frame[3] = 0x40;
    frame[5] = words[next++ % 3u];
    return 6;
}

/* A request without its checksum, which fits. */
static size_t any_request(uint8_t *frame)
{
    static const uint8_t functions[] = {3, 4, 6, 8, 16, 16, 16, 16};
    struct object object = fuzz_object();

    (void)objects_find(object.index, object.sub > 0u ? 1 : 0, &object);
    frame[0] = (uint8_t)(fuzz_once_in(16) ? fuzz_draw(3) : bench_link.node);
    frame[1] = (uint8_t)(fuzz_once_in(16) ? fuzz_draw(256) : functions[fuzz_draw(8)]);
    frame[2] = (uint8_t)(object.index >> 8);
    frame[3] = (uint8_t)object.index;

    const size_t bytes = registers_for(&object, 1u + fuzz_draw(4), &frame[7]);

    if (frame[1] != 16u) {
        frame[4] = frame[7];
        frame[5] = (uint8_t)(frame[1] == 6u ? frame[8] : 1u + fuzz_draw(12));
        return 6;
    }
    frame[4] = 0;
    frame[5] = (uint8_t)(fuzz_once_in(32) ? fuzz_draw(256) : bytes / 2u);
    frame[6] = (uint8_t)(fuzz_once_in(32) ? fuzz_draw(256) : bytes);
    return 7u + bytes;
}

/* Whole requests with a valid checksum, spoilt ones, pieces of them, and bytes of any kind. */
static void type_any_request(void)
{
    uint8_t frame[MODBUS_REQUEST_BYTES] = {0};
    size_t count = fuzz_once_in(16) ? request_to_enable(frame) : any_request(frame);

    if (fuzz_once_in(64)) {
        count = 1u + fuzz_draw(MODBUS_REQUEST_BYTES - 2);
        for (size_t n = 0; n < count; n++) {
            frame[n] = (uint8_t)fuzz_draw(256);
        }
    }
    const uint16_t crc = modbus_crc(frame, count);

    frame[count++] = (uint8_t)crc;
    frame[count++] = (uint8_t)(crc >> 8);
    if (fuzz_once_in(32)) {
        frame[fuzz_draw((uint32_t)count)] = (uint8_t)fuzz_draw(256);
    }
    type_bytes(frame, fuzz_once_in(64) ? fuzz_draw((uint32_t)count) : count);
    bench_periods(fuzz_once_in(8) ? SILENCE : 0);
}

static void open_modbus(void)
{
    fuzz_start();
    (void)link_bench_say("modbus", 1);
    bench_periods(SILENCE);
}

static void test_whatever_comes_the_node_goes_on(void)
{
    fuzz_find_objects();
    for (long i = 0; i < inputs; i++) {
        if (i % FUZZ_BETWEEN_STARTS == 0 || !bench_link.open) {
            open_modbus();
        }
        type_any_request();
        fuzz_look();
    }
    TEST_ASSERT_TRUE(fuzz.captures >= inputs / 1000);
    TEST_ASSERT_TRUE(fuzz.enabled >= inputs / 100);
    bench_periods(SILENCE);

    uint8_t frame[8] = {bench_link.node, 3, 0x10, 0, 0, 2};
    const uint16_t crc = modbus_crc(frame, 6);

    frame[6] = (uint8_t)crc;
    frame[7] = (uint8_t)(crc >> 8);
    send(frame, sizeof frame);
    TEST_ASSERT_EQUAL_STRING("030400040192", &heard()[2]);
}

/* An argument is how many inputs there are to be of any content. */
int main(int count, char **arguments)
{
    inputs = count > 1 ? strtol(arguments[1], NULL, 10) : inputs;
    UNITY_BEGIN();
    RUN_TEST(test_the_checksum_is_that_of_the_standard);
    RUN_TEST(test_an_object_is_read_as_registers_highest_first);
    RUN_TEST(test_an_array_is_read_from_its_first_value_on);
    RUN_TEST(test_a_text_ends_with_zeros);
    RUN_TEST(test_registers_are_written_one_or_several);
    RUN_TEST(test_what_cannot_be_is_an_exception);
    RUN_TEST(test_an_unknown_function_is_answered_behind_the_silence);
    RUN_TEST(test_an_echo_comes_back);
    RUN_TEST(test_others_and_all_are_not_answered);
    RUN_TEST(test_a_request_may_come_in_pieces_and_not_too_slowly);
    RUN_TEST(test_rubbish_is_over_with_the_silence);
    RUN_TEST(test_the_drive_is_operated);
    RUN_TEST(test_a_request_is_heard);
    RUN_TEST(test_nothing_is_sent_unasked);
    RUN_TEST(test_the_console_comes_back);
    RUN_TEST(test_a_setting_makes_it_so_from_power_up);
    RUN_TEST(test_whatever_comes_the_node_goes_on);
    return UNITY_END();
}
