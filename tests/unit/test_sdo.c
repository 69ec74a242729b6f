/* A client's access to objects: one frame or segments, and what it is refused. */
#include "firmware/link/data_sheet.h"
#include "tests/unit/link_bench.h"

void setUp(void)
{
    link_bench_start();
    link_bench_open();
}

void tearDown(void)
{
}

static void asked(const char *request, const char *answer)
{
    TEST_ASSERT_EQUAL_STRING_MESSAGE(answer, link_bench_sdo(request), request);
}

static void test_a_short_value_comes_in_one_frame_with_its_size(void)
{
    asked("4000100000000000", "4300100092010400");
    asked("405A600000000000", "4B5A600002000000");
    asked("4060600000000000", "4F60600001000000");
    asked("4018100300000000", "4318100302000000");
}

static void test_a_short_value_is_written_in_one_frame(void)
{
    asked("2B17100034120000", "6017100000000000");
    asked("4017100000000000", "4B17100034120000");
    asked("2217100078560000", "6017100000000000"); /* without a size */
    asked("4017100000000000", "4B17100078560000");
    asked("2F17100001000000", "8017100010000706"); /* of one byte */
    asked("2217100100000000", "8017100111000906");
    asked("2220210001000000", "8020210010000706"); /* eight bytes at once */
    asked("4017100000000000", "4B17100078560000");
}

static void test_a_long_value_is_written_with_or_without_its_size(void)
{
    asked("2020210000000000", "6020210000000000");
    asked("0000000000000000", "2000000000000000");
    asked("1D40000000000000", "3000000000000000");
    TEST_ASSERT_TRUE(bench.application.chosen.current_limit_A == 2.0);
    asked("0000000000000000", "8020210001000405"); /* a segment behind the last */
    asked("2120210008000000", "6020210000000000");
    asked("0000000000000000", "2000000000000000");
    asked("4000100000000000", "4300100092010400"); /* another transfer ends it */
    asked("1D40000000000000", "8000100001000405");
}

static void test_a_transfer_is_ended_by_a_wrong_toggle(void)
{
    asked("2120210008000000", "6020210000000000");
    asked("1000000000000000", "8020210000000305");
    asked("0000000000000000", "8020210001000405");
    asked("2120210008000000", "6020210000000000");
    asked("0000000000000000", "2000000000000000");
    asked("0D40000000000000", "8020210000000305");
    asked("4020210000000000", "4120210008000000");
    asked("7000000000000000", "8020210000000305");
    asked("6000000000000000", "8020210001000405");
    asked("4020210000000000", "4120210008000000");
    asked("4000100000000000", "4300100092010400");
    asked("6000000000000000", "8000100001000405");
}

static void test_segments_that_are_too_long_or_too_few_are_refused(void)
{
    asked("2120210008000000", "6020210000000000");
    asked("0000000000000000", "2000000000000000");
    asked("1B00000000000000", "8020210012000706"); /* nine bytes */
    asked("2120210008000000", "6020210000000000");
    asked("0100000000000000", "8020210010000706"); /* seven, the last */
    asked("2120210008000000", "6020210000000000");
    asked("0100000000000000", "8020210010000706");
    asked("2117100002000000", "6017100000000000"); /* a short value in a segment */
    asked("0B22110000000000", "2000000000000000");
    asked("4017100000000000", "4B17100022110000");
    TEST_ASSERT_FALSE(bench.application.chosen.current_limit_A == 0.0);
}

static void test_an_abort_of_the_client_is_not_answered_and_ends_the_transfer(void)
{
    asked("4020210000000000", "4120210008000000");
    asked("8020210000000000", "");
    asked("6000000000000000", "8020210001000405");
    asked("2120210008000000", "6020210000000000");
    asked("8020210000000000", "");
    asked("0000000000000000", "8020210001000405");
}

static void test_what_is_no_request_of_eight_bytes_is_not_answered(void)
{
    TEST_ASSERT_EQUAL_STRING("z\r", link_bench_say("t601740001000000000", 2));
    TEST_ASSERT_EQUAL_STRING("z\r", link_bench_say("t60284000100000000000", 2)); /* another node */
}

/* Eight bytes, of an object that is stored as such: a sanitizer sees what is written beside it. */
static void test_a_real_number_that_is_stored_comes_in_two_segments(void)
{
    asked("2100240408000000", "6000240400000000");
    asked("00000000000000E0", "2000000000000000");
    asked("1D3F000000000000", "3000000000000000");
    TEST_ASSERT_EQUAL_DOUBLE(0.5, bench_link.objects.capture_level);
}

static void test_a_text_comes_in_segments_of_seven(void)
{
    bench.application.facts.board_name = "a board of this name";
    asked("4008100000000000", "4108100014000000");
    asked("6000000000000000", "006120626F617264");
    asked("7000000000000000", "10206F6620746869");
    asked("6000000000000000", "0373206E616D6500"); /* six, the last */
    asked("7000000000000000", "8008100001000405");
    asked("2308100000000000", "8008100002000106");
}

/* Which takes a fourth of an image: it may be without, and says so. */
static void test_the_data_sheet_comes_in_segments_where_there_is_one(void)
{
    char begins[32];

    asked("4022100000000000", "4F22100000000000"); /* as text */
    if (data_sheet_bytes == 0u) {
        asked("4021100000000000", "8021100024000008");
        return;
    }
    snprintf(begins, sizeof begins, "41211000%02X%02X0000", (unsigned)(data_sheet_bytes & 0xffu),
             (unsigned)(data_sheet_bytes >> 8 & 0xffu));
    asked("4021100000000000", begins);
    asked("6000000000000000", "005B46696C65496E"); /* [FileIn */
    asked("7000000000000000", "10666F5D0A46696C"); /* fo], File */
    TEST_ASSERT_EQUAL_STRING_LEN("says how to connect.", strstr(data_sheet, "says"), 20);
}

/* What a download has begun, an upload does not end, and the other way round. */
static void test_segments_go_the_way_that_the_transfer_does(void)
{
    asked("4020210000000000", "4120210008000000");
    asked("0000000000000000", "8020210001000405");
    asked("2120210008000000", "6020210000000000");
    asked("6000000000000000", "8020210001000405");
}

/* ---- what becomes of a value ---- */

static void test_numbers_of_every_type_are_put_and_shown(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x607c, 0, 4, (uint32_t)-70000));
    TEST_ASSERT_EQUAL_HEX32((uint32_t)-70000, link_bench_get(0x607c, 0));
    TEST_ASSERT_EQUAL_HEX32(50, link_bench_get(0x2008, 0)); /* teeth */
}

static void test_types_are_those_of_the_standard(void)
{
    static const struct {
        uint16_t index;
        uint8_t sub, type;
    } all[] = {{0x1000, 0, 0x07}, {0x1001, 0, 0x05}, {0x1008, 0, 0x09}, {0x1017, 0, 0x06},
               {0x605a, 0, 0x03}, {0x6060, 0, 0x02}, {0x607a, 0, 0x04}, {0x2120, 0, 0x11},
               {0x2302, 0, 0x01}, {0x2300, 0, 0x05}, {0x603f, 0, 0x06}, {0x2301, 0, 0x07},
               {0x2327, 0, 0x11}, {0x2200, 0, 0x05}, {0x2201, 0, 0x11}, {0x2008, 0, 0x04}};
    static const uint8_t bytes[] = {4, 1, 0, 2, 2, 1, 4, 8, 1, 1, 2, 4, 8, 1, 8, 4};

    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        struct object found;

        TEST_ASSERT_EQUAL_HEX32(OBJECT_DONE, objects_find(all[i].index, all[i].sub, &found));
        TEST_ASSERT_EQUAL_HEX8(all[i].type, found.type);
        TEST_ASSERT_EQUAL_size_t(bytes[i], object_bytes(&found));
        TEST_ASSERT_EQUAL_HEX16(all[i].index, found.index);
    }
}

static void test_modes_are_those_there_are(void)
{
    for (unsigned mode = 0; mode < 256u; mode++) {
        const bool is = mode == 0u || mode == 1u || mode == 3u || mode == 6u || mode == 8u;

        TEST_ASSERT_EQUAL_HEX32(is ? 0 : OBJECT_OUT_OF_RANGE, link_bench_put(0x6060, 0, 1, mode));
    }
    TEST_ASSERT_EQUAL_HEX32(0xa5, link_bench_get(0x6502, 0)); /* 1, 3, 6, 8 */
}

static void test_what_would_make_no_sense_is_refused(void)
{
    static const struct {
        uint16_t index;
        uint8_t sub, bytes;
        uint32_t value;
        bool accepted;
    } all[] = {
        {0x6098, 0, 1, 35, true},     {0x6098, 0, 1, 37, true},    {0x6098, 0, 1, 34, true},
        {0x6098, 0, 1, 0xff, true},   {0x6098, 0, 1, 0xfe, true},  {0x6098, 0, 1, 36, false},
        {0x6098, 0, 1, 38, false},    {0x6098, 0, 1, 32, false},   {0x6098, 0, 1, 33, true},
        {0x605a, 0, 2, 2, true},      {0x605a, 0, 2, 6, true},     {0x605a, 0, 2, 3, false},
        {0x605a, 0, 2, 0x102, false}, {0x60c2, 1, 1, 0, false},    {0x60c2, 1, 1, 1, true},
        {0x60c2, 2, 1, 0xfa, true},   {0x60c2, 2, 1, 0xf9, false}, {0x60c2, 2, 1, 0, true},
        {0x60c2, 2, 1, 1, false},     {0x6081, 0, 4, 0, false},    {0x6083, 0, 4, 0, false},
        {0x6085, 0, 4, 0, false},     {0x6081, 0, 4, 1, true},     {0x6083, 0, 4, 1, true},
        {0x6085, 0, 4, 1, true},      {0x6091, 1, 4, 0, false},    {0x6091, 2, 4, 0, false},
        {0x6092, 1, 4, 0, false},     {0x6092, 2, 4, 0, false},    {0x6091, 1, 4, 2, true},
        {0x607c, 0, 4, 0, true},      {0x1017, 0, 2, 0, true},     {0x6085, 0, 4, 0x100, true}};

    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        TEST_ASSERT_EQUAL_HEX32(
            all[i].accepted ? 0 : OBJECT_OUT_OF_RANGE,
            link_bench_put(all[i].index, all[i].sub, all[i].bytes, all[i].value));
    }
}

static void test_what_was_set_is_stored_by_its_word_only(void)
{
    TEST_ASSERT_EQUAL_HEX32(1, link_bench_get(0x1010, 1));
    TEST_ASSERT_EQUAL_HEX32(1, link_bench_get(0x1011, 1));
    TEST_ASSERT_EQUAL_HEX32(OBJECT_NOT_TRANSFERRED, link_bench_put(0x1010, 1, 4, 0x65766174));
    TEST_ASSERT_EQUAL_HEX8(0xff, bench.store[2 * BENCH_PAGE]);
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1010, 1, 4, 0x65766173));
    TEST_ASSERT_NOT_EQUAL(0xff, bench.store[2 * BENCH_PAGE]);
}

static void test_defaults_are_put_in_force_by_their_word_only(void)
{
    const double limit_A = bench.application.chosen.current_limit_A;

    asked("2020210000000000", "6020210000000000");
    asked("0000000000000000", "2000000000000000");
    asked("1D40000000000000", "3000000000000000");
    TEST_ASSERT_EQUAL_HEX32(OBJECT_NOT_TRANSFERRED, link_bench_put(0x1011, 1, 4, 0x65766173));
    TEST_ASSERT_TRUE(bench.application.chosen.current_limit_A == 2.0);
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1010, 1, 4, 0x65766173));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1011, 1, 4, 0x64616f6c));
    TEST_ASSERT_TRUE(bench.application.chosen.current_limit_A == limit_A);
    (void)link_bench_nmt(0x81, 20); /* finds what is stored, which are the defaults */
    TEST_ASSERT_TRUE(bench.application.chosen.current_limit_A == limit_A);
    (void)link_bench_put(0x2200, 0, 1, 1); /* enable */
    bench_periods(10);
    TEST_ASSERT_EQUAL_HEX32(OBJECT_WRONG_STATE, link_bench_put(0x1011, 1, 4, 0x64616f6c));
}

static void test_a_store_that_is_worn_says_so(void)
{
    bench.worn = true;
    memset(bench.store, 0, sizeof bench.store);
    bench.bytes_until_power_fails = 0;
    TEST_ASSERT_EQUAL_HEX32(OBJECT_STORE_FAILED, link_bench_put(0x1010, 1, 4, 0x65766173));
}

static void test_commands_are_given_by_their_number(void)
{
    TEST_ASSERT_EQUAL_HEX32(OBJECT_OUT_OF_RANGE, link_bench_put(0x2200, 0, 1, 0));
    TEST_ASSERT_EQUAL_HEX32(OBJECT_OUT_OF_RANGE, link_bench_put(0x2200, 0, 1, DRIVE_COMMANDS + 1));
    TEST_ASSERT_EQUAL_HEX32(OBJECT_WRONG_STATE, link_bench_put(0x2200, 0, 1, 3)); /* hold */
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x2200, 0, 1, 1));
    bench_periods(10);
    TEST_ASSERT_EQUAL(DRIVE_OPERATION_ENABLED, bench.application.drive.supervision.state);
    asked("2101220008000000", "6001220000000000"); /* position_rad: 2.0 */
    asked("0000000000000000", "2000000000000000");
    asked("1D40000000000000", "3000000000000000");
    asked("4001220000000000", "4101220008000000");
    asked("6000000000000000", "0000000000000000");
    asked("7000000000000000", "1D40000000000000");
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x2200, 0, 1, 13)); /* set-position */
    bench_periods(10);
    TEST_ASSERT_INT_WITHIN(1, 65536.0 * 2.0 / TWO_PI, (int32_t)link_bench_get(0x6062, 0));
    TEST_ASSERT_EQUAL_HEX32(OBJECT_WRONG_STATE, /* torque: there is no encoder */
                            link_bench_put(0x2200, 0, 1, DRIVE_COMMANDS));
}

static void test_signals_have_the_type_of_what_they_show(void)
{
    asked("4000230000000000", "4F00230000000000"); /* state */
    asked("4002230000000000", "4F02230000000000"); /* moving */
    asked("403F600000000000", "4B3F600000000000"); /* fault: a code */
    asked("4005230000000000", "4305230000000000"); /* underruns */
    asked("4027230000000000", "4127230008000000"); /* V */
    asked("2F00230001000000", "8000230002000106");
    asked("4000230100000000", "8000230111000906");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_short_value_comes_in_one_frame_with_its_size);
    RUN_TEST(test_a_short_value_is_written_in_one_frame);
    RUN_TEST(test_a_long_value_is_written_with_or_without_its_size);
    RUN_TEST(test_a_transfer_is_ended_by_a_wrong_toggle);
    RUN_TEST(test_segments_that_are_too_long_or_too_few_are_refused);
    RUN_TEST(test_an_abort_of_the_client_is_not_answered_and_ends_the_transfer);
    RUN_TEST(test_what_is_no_request_of_eight_bytes_is_not_answered);
    RUN_TEST(test_a_real_number_that_is_stored_comes_in_two_segments);
    RUN_TEST(test_a_text_comes_in_segments_of_seven);
    RUN_TEST(test_the_data_sheet_comes_in_segments_where_there_is_one);
    RUN_TEST(test_segments_go_the_way_that_the_transfer_does);
    RUN_TEST(test_numbers_of_every_type_are_put_and_shown);
    RUN_TEST(test_types_are_those_of_the_standard);
    RUN_TEST(test_modes_are_those_there_are);
    RUN_TEST(test_what_would_make_no_sense_is_refused);
    RUN_TEST(test_what_was_set_is_stored_by_its_word_only);
    RUN_TEST(test_defaults_are_put_in_force_by_their_word_only);
    RUN_TEST(test_a_store_that_is_worn_says_so);
    RUN_TEST(test_commands_are_given_by_their_number);
    RUN_TEST(test_signals_have_the_type_of_what_they_show);
    return UNITY_END();
}
