#include "firmware/application/settings_record.h"

#include <string.h>
#include <unity.h>

#include "firmware/interface/settings.h"

#include "tests/unit/console_bench.h"

static struct hal_facts facts;
static struct hal board;

void setUp(void)
{
    bench_power_up();
    facts = bench_stored_facts();
    board = bench_board(&facts);
}

void tearDown(void)
{
}

/* Every setting another value, none of them a default. */
static struct drive_settings peculiar(void)
{
    struct drive_settings s;
    double next = 0.1;

    drive_settings_default(&s, &bench_params);
    for (size_t i = 0; setting_number(i) != NULL; i++) {
        const struct setting *row = setting_number(i);

        for (size_t element = 0; element < row->count; element++, next += 0.7) {
            const double before = setting_get(&s, row, element);

            setting_put(&s, row, element,
                        row->type == SETTING_REAL    ? next
                        : row->type == SETTING_COUNT ? -before - 1.0
                        : before < row->most         ? before + 1.0
                                                     : before - 1.0);
        }
    }
    for (int i = 1; i < DRIVE_LAW_GAINS; i += 2) {
        s.law_gains[i] = __builtin_nan(""); /* not given */
    }
    return s;
}

/* Encoding is one to one: equal settings have equal records. */
static void assert_same(const struct drive_settings *a, const struct drive_settings *b)
{
    uint8_t first[SETTINGS_RECORD_BYTES];
    uint8_t second[SETTINGS_RECORD_BYTES];

    settings_record_encode(a, 1, first);
    settings_record_encode(b, 1, second);
    TEST_ASSERT_EQUAL_UINT8_ARRAY(first, second, sizeof first);
}

static void test_every_field_comes_back(void)
{
    struct drive_settings in = peculiar();
    struct drive_settings out;
    uint8_t record[SETTINGS_RECORD_BYTES];

    memset(&out, 0x55, sizeof out);
    settings_record_encode(&in, 7, record);
    TEST_ASSERT_TRUE(settings_record_decode(&out, record));
    TEST_ASSERT_EQUAL_INT32(-51, out.motor.rotor_teeth);
    TEST_ASSERT_TRUE(out.law_gains[10] == in.law_gains[10]);
    TEST_ASSERT_TRUE(out.law_gains[11] != out.law_gains[11]);
    for (size_t i = 0; setting_number(i) != NULL; i++) {
        const double value = setting_get(&in, setting_number(i), 0);

        TEST_ASSERT_TRUE(setting_get(&out, setting_number(i), 0) == value);
    }
    assert_same(&in, &out);
}

static const struct record_log entries = {SETTINGS_RECORD_FIRST_PAGE, SETTINGS_RECORD_FORMAT,
                                          SETTINGS_RECORD_PAYLOAD};

/* A record with these bytes at the begin of its payload in place of what is encoded. */
static bool decodes(struct drive_settings *out, const struct drive_settings *in, const void *bytes,
                    size_t count)
{
    uint8_t record[SETTINGS_RECORD_BYTES];

    settings_record_encode(in, 1, record);
    memcpy(&record[RECORD_HEADER_BYTES], bytes, count);
    record_seal(&entries, record, 1);
    return settings_record_decode(out, record);
}

static void test_every_element_has_its_own_place(void)
{
    const struct drive_settings in = peculiar();
    struct drive_settings out;
    uint8_t record[SETTINGS_RECORD_BYTES];

    for (size_t i = 0; setting_number(i) != NULL; i++) {
        const struct setting *row = setting_number(i);

        for (size_t element = 0; element < row->count; element++) {
            struct drive_settings other = in;

            setting_put(&other, row, element, row->type == SETTING_CHOICE ? 0.0 : 1.0);
            settings_record_encode(&other, 1, record);
            TEST_ASSERT_TRUE_MESSAGE(settings_record_decode(&out, record), row->name);
            assert_same(&other, &out);
        }
    }
}

/* The layout of settings_record.h, in bytes: stores of today are read tomorrow. */
static void test_the_layout_stays(void)
{
    struct drive_settings in = peculiar();
    uint8_t record[SETTINGS_RECORD_BYTES];
    static const uint8_t head[] = {0x05, 0x53, 0x10, 0x03, 0x04, 0x03, 0x02, 0x01};
    static const uint8_t one[] = {0x01, 0xa0, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f};
    static const uint8_t teeth[] = {0x08, 0x60, 0xcd, 0xff, 0xff, 0xff,
                                    0x00, 0x21, 1,    0x01, 0x21, 2};
    const uint8_t *payload = &record[RECORD_HEADER_BYTES];

    in.motor.resistance_ohm = 1.0;
    in.law = POSITION_LAW_FEEDBACK_LINEARISATION;
    settings_record_encode(&in, 0x01020304, record);
    TEST_ASSERT_EQUAL_UINT8_ARRAY(head, record, sizeof head);
    TEST_ASSERT_EQUAL_UINT8_ARRAY(one, payload, sizeof one);
    TEST_ASSERT_EQUAL_UINT8_ARRAY(teeth, &payload[70], sizeof teeth);
}

/* Of a firmware that has other settings: a number 0x3abc, and nothing of the motor's resistance
   in its place; what comes behind an end is not read. */
static void test_settings_that_come_and_go_leave_the_others(void)
{
    const struct drive_settings in = peculiar();
    struct drive_settings out;
    uint8_t record[SETTINGS_RECORD_BYTES], shorter[SETTINGS_RECORD_PAYLOAD] = {0};
    static const uint8_t later[] = {0xbc, 0xba, 1, 2, 3, 4, 5, 6, 7, 8};
    const size_t behind_motor = 7 * 10 + 6;

    settings_record_encode(&in, 1, record);
    memcpy(shorter, &record[RECORD_HEADER_BYTES], behind_motor);
    memcpy(shorter + behind_motor, later, sizeof later);
    memcpy(shorter + behind_motor + sizeof later, &record[RECORD_HEADER_BYTES + behind_motor],
           3); /* feedback, and then the end */
    TEST_ASSERT_TRUE(decodes(&out, &in, shorter, sizeof shorter));
    TEST_ASSERT_EQUAL_INT(in.feedback, out.feedback);
    TEST_ASSERT_TRUE(out.hold_ramp_s == 0.010);
    TEST_ASSERT_EQUAL_INT32(0, out.encoder_counts_per_turn);
    TEST_ASSERT_FALSE(decodes(&out, &in, later, sizeof later)); /* no whole motor */
}

static void test_an_unknown_choice_is_no_record(void)
{
    const struct drive_settings in = peculiar();
    struct drive_settings out;
    uint8_t record[SETTINGS_RECORD_BYTES];
    const size_t behind_motor = RECORD_HEADER_BYTES + 7 * 10 + 6;

    for (size_t i = 0; setting_number(i) != NULL; i++) {
        const struct setting *row = setting_number(i);
        struct drive_settings other = in;

        if (row->type == SETTING_CHOICE) { /* the one behind the last */
            setting_put(&other, row, 0, row->most + 1.0);
            settings_record_encode(&other, 1, record);
            TEST_ASSERT_FALSE_MESSAGE(settings_record_decode(&out, record), row->name);
        }
    }
    for (size_t choice = 0; choice < 7; choice++) {
        settings_record_encode(&in, 1, record);
        record[behind_motor + 3 * choice + 2] = 200;
        record_seal(&entries, record, 1);
        TEST_ASSERT_FALSE(settings_record_decode(&out, record));
    }
}

static void test_a_harmed_record_is_none(void)
{
    const struct drive_settings in = peculiar();
    struct drive_settings out;
    uint8_t record[SETTINGS_RECORD_BYTES];

    settings_record_encode(&in, 1, record);
    for (size_t i = 0; i < sizeof record; i++) {
        record[i] ^= 1u;
        TEST_ASSERT_FALSE(settings_record_decode(&out, record));
        record[i] ^= 1u;
    }
}

static void test_the_newest_of_many_is_read_beside_what_is_learned(void)
{
    struct drive_settings in = peculiar();
    struct drive_settings out;

    TEST_ASSERT_FALSE(settings_record_read(&board, &out));
    for (uint32_t i = 1; i <= 30; i++) { /* one to a page */
        in.encoder_counts_per_turn = (int32_t)i;
        TEST_ASSERT_TRUE(settings_record_write(&board, &in));
        TEST_ASSERT_TRUE(settings_record_read(&board, &out));
        TEST_ASSERT_EQUAL_INT32(i, out.encoder_counts_per_turn);
    }
    assert_same(&in, &out);
    for (int i = 0; i < 2 * BENCH_PAGE; i++) { /* pages 0 and 1 are the learned parameters' */
        TEST_ASSERT_EQUAL_HEX8(0xff, bench.store[i]);
    }
}

/* As a host prepares a store: the record at the begin of page 2. */
static void test_an_encoded_record_in_page_2_is_read(void)
{
    const struct drive_settings in = peculiar();
    struct drive_settings out;

    settings_record_encode(&in, 1, &bench.store[2 * BENCH_PAGE]);
    TEST_ASSERT_TRUE(settings_record_read(&board, &out));
    assert_same(&in, &out);
}

/* A record keeps a choice by its place: one that is added stands behind all others. */
static void test_a_stored_choice_means_what_it_meant(void)
{
    static const char *const laws[] = {"state-feedback",
                                       "pid",
                                       "feedback-linearisation",
                                       "microstepping",
                                       "stmms",
                                       "stmms-plus",
                                       "foc",
                                       "csmc",
                                       "csmc-equivalent",
                                       "csmc-servo",
                                       "smc"};
    static const char *const feedbacks[] = {"sensorless", "encoder"};
    static const char *const positions[] = {"assumed", "impulses", "published-impulses"};
    static const char *const policies[] = {"fault", "warn", "off"};

    for (size_t i = 0; i < sizeof laws / sizeof laws[0]; i++) {
        TEST_ASSERT_EQUAL_STRING(laws[i], drive_law_name((enum position_law)i));
    }
    for (size_t i = 0; i < sizeof feedbacks / sizeof feedbacks[0]; i++) {
        TEST_ASSERT_EQUAL_STRING(feedbacks[i], drive_feedback_name((enum drive_feedback)i));
    }
    for (size_t i = 0; i < sizeof positions / sizeof positions[0]; i++) {
        TEST_ASSERT_EQUAL_STRING(positions[i],
                                 drive_initial_position_name((enum drive_initial_position)i));
    }
    for (size_t i = 0; i < sizeof policies / sizeof policies[0]; i++) {
        TEST_ASSERT_EQUAL_STRING(policies[i],
                                 drive_synchronism_policy_name((enum drive_synchronism_policy)i));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_stored_choice_means_what_it_meant);
    RUN_TEST(test_every_field_comes_back);
    RUN_TEST(test_every_element_has_its_own_place);
    RUN_TEST(test_the_layout_stays);
    RUN_TEST(test_settings_that_come_and_go_leave_the_others);
    RUN_TEST(test_an_unknown_choice_is_no_record);
    RUN_TEST(test_a_harmed_record_is_none);
    RUN_TEST(test_the_newest_of_many_is_read_beside_what_is_learned);
    RUN_TEST(test_an_encoded_record_in_page_2_is_read);
    return UNITY_END();
}
