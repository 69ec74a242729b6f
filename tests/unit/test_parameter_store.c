/* Learned parameters in a flash that is erased in pages and programmed once per word. */
#include <string.h>

#include <unity.h>

#include "firmware/drive/parameter_store.h"
#include "firmware/drive/record_log.h"

enum { PAGE = 256, PAGES = 2, WORD = 8 };

static uint8_t flash[PAGE * PAGES];
static int bytes_until_power_fails; /* while programming; < 0: never */
static int erased_pages;
static size_t worn_from, worn_to; /* bytes that refuse to be programmed, and hold nothing */
static bool worn_stays_blank;
static int refused; /* to program what is not blank, which no flash does */
static struct hal_facts facts;
static struct hal board;

static bool erase(void *context, uint32_t page)
{
    (void)context;
    erased_pages++;
    memset(&flash[page * PAGE], 0xff, PAGE);
    return true;
}

static bool program(void *context, uint32_t offset, const void *data, size_t count)
{
    const uint8_t *bytes = data;

    (void)context;
    if (offset % WORD != 0 || count % WORD != 0 || offset + count > sizeof flash) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        if (flash[offset + i] != 0xff) {
            refused++;
            return false;
        }
    }
    if (offset < worn_to && offset + count > worn_from) {
        memset(&flash[offset], worn_stays_blank ? 0xff : 0, count);
        return false;
    }
    for (size_t i = 0; i < count && bytes_until_power_fails != 0; i++) {
        flash[offset + i] = bytes[i];
        bytes_until_power_fails--;
    }
    return true;
}

static bool read_back(void *context, uint32_t offset, void *data, size_t count)
{
    (void)context;
    if (offset + count > sizeof flash) {
        return false;
    }
    memcpy(data, &flash[offset], count);
    return true;
}

void setUp(void)
{
    memset(flash, 0xff, sizeof flash);
    bytes_until_power_fails = -1;
    erased_pages = 0;
    worn_from = worn_to = 0;
    worn_stays_blank = false;
    refused = 0;
    facts = (struct hal_facts){.parameter_page_bytes = PAGE, .parameter_word_bytes = WORD};
    board = (struct hal){.facts = &facts,
                         .parameters_erase = erase,
                         .parameters_program = program,
                         .parameters_read = read_back};
}

void tearDown(void)
{
}

static bool refuse_to_erase(void *context, uint32_t page)
{
    (void)context;
    (void)page;
    return false;
}

static bool save(double torque_Nm)
{
    const struct learned_parameters learned = {
        {torque_Nm, -torque_Nm, 2.0 * torque_Nm, 0.0, 1e-7, -3.0 * torque_Nm}};

    return parameter_store_write(&board, &learned);
}

/* The first coefficient; -1: nothing is kept. */
static double kept(void)
{
    struct learned_parameters learned;

    return parameter_store_read(&board, &learned) ? learned.detent_torque_Nm[0] : -1.0;
}

/* CRC-32 of IEEE 802.3, as another program computes it over all before it. */
static void test_the_check_of_a_record_is_the_standard_one(void)
{
    static const struct record_log log = {.first_page = 0, .format = 1, .payload_bytes = 8};
    uint8_t record[RECORD_BYTES(8)] = {0};

    for (uint8_t i = 0; i < 8; i++) {
        record[RECORD_HEADER_BYTES + i] = (uint8_t)(17u * i);
    }
    record_seal(&log, record, 5u);
    TEST_ASSERT_EQUAL_HEX32(0x4be5e43du, record_get(&record[sizeof record - 4u], 4));
    TEST_ASSERT_TRUE(record_is_valid(&log, record));
    record[RECORD_HEADER_BYTES] ^= 1u;
    TEST_ASSERT_FALSE(record_is_valid(&log, record));
}

/* In steps of 1e-7 N m, to nearest, up to 2^31 - 1 of them on either side. */
static void test_a_torque_is_kept_to_nearest_and_within_its_range(void)
{
    static const double given_Nm[] = {0.6e-7, 0.4e-7, -0.6e-7, -0.4e-7, 1.4e-7,
                                      1e3,    -1e3,   300.0,   -300.0};
    static const double kept_Nm[] = {1e-7,        0.0,          -1e-7,       0.0,         1e-7,
                                     214.7483647, -214.7483647, 214.7483647, -214.7483647};

    for (int i = 0; i < 9; i++) {
        TEST_ASSERT_TRUE(save(given_Nm[i]));
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, kept_Nm[i], kept());
    }
}

static void test_what_is_saved_is_found_again(void)
{
    struct learned_parameters learned;

    TEST_ASSERT_TRUE(save(0.0123456));
    TEST_ASSERT_TRUE(parameter_store_read(&board, &learned));
    TEST_ASSERT_DOUBLE_WITHIN(5e-8, 0.0123456, learned.detent_torque_Nm[0]);
    TEST_ASSERT_DOUBLE_WITHIN(5e-8, -0.0123456, learned.detent_torque_Nm[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1e-7, learned.detent_torque_Nm[4]);
    TEST_ASSERT_DOUBLE_WITHIN(5e-8, -0.0370368, learned.detent_torque_Nm[5]);
}

static void test_an_erased_store_keeps_nothing(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(-1.0, kept());
}

static void test_the_last_of_many_savings_counts(void)
{
    for (int i = 1; i <= 100; i++) {
        TEST_ASSERT_TRUE(save(1e-3 * i));
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, 1e-3 * i, kept());
    }
    /* six records in a page */
    TEST_ASSERT_EQUAL_INT(17, erased_pages);
}

static void test_the_supply_may_fail_at_any_byte_of_any_saving(void)
{
    for (int savings = 1; savings <= 13; savings++) {
        for (int bytes = 0; bytes < 36; bytes++) {
            setUp();
            for (int i = 1; i <= savings; i++) {
                TEST_ASSERT_TRUE(save(1e-3 * i));
            }
            bytes_until_power_fails = bytes;
            (void)save(1.0);
            bytes_until_power_fails = -1;
            TEST_ASSERT_DOUBLE_WITHIN(1e-7, 1e-3 * savings, kept());
            TEST_ASSERT_TRUE(save(2.0)); /* and the store goes on */
            TEST_ASSERT_DOUBLE_WITHIN(1e-7, 2.0, kept());
            TEST_ASSERT_EQUAL_INT(0, refused);
        }
    }
}

static void goes_on_with_worn_cells_from(size_t from, size_t to)
{
    setUp();
    worn_from = from;
    worn_to = to;
    for (int i = 1; i <= 40; i++) {
        TEST_ASSERT_TRUE(save(1e-3 * i));
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, 1e-3 * i, kept());
    }
}

static void test_a_page_whose_first_word_is_worn_out_is_used_behind_it(void)
{
    goes_on_with_worn_cells_from(0, WORD);
    goes_on_with_worn_cells_from(PAGE, PAGE + WORD);
    TEST_ASSERT_EQUAL_INT(8, erased_pages); /* six records, and five */
}

/* One that looks as if it had never been tried. */
static void test_a_slot_that_stays_blank_is_passed_over(void)
{
    worn_stays_blank = true;
    worn_to = WORD;
    for (int i = 1; i <= 40; i++) {
        TEST_ASSERT_TRUE(save(1e-3 * i));
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, 1e-3 * i, kept());
    }
    TEST_ASSERT_EQUAL_INT(8, erased_pages);
    TEST_ASSERT_EQUAL_INT(0, refused);
}

static void test_a_page_that_is_worn_out_leaves_the_other(void)
{
    goes_on_with_worn_cells_from(0, PAGE);
    goes_on_with_worn_cells_from(PAGE, 2 * PAGE);
}

static void test_a_store_that_takes_nothing_refuses(void)
{
    TEST_ASSERT_TRUE(save(1e-3));
    worn_to = sizeof flash;
    TEST_ASSERT_FALSE(save(2e-3));
    setUp();
    board.parameters_erase = refuse_to_erase;
    TEST_ASSERT_FALSE(save(1e-3));
}

static void test_each_record_has_the_next_number(void)
{
    for (uint32_t i = 1; i <= 8u; i++) {
        const size_t page = i > 6u ? PAGE : 0u; /* six in the first */

        TEST_ASSERT_TRUE(save(1e-3));
        TEST_ASSERT_EQUAL_HEX16(1, (uint16_t)record_get(&flash[page], 2)); /* format */
        TEST_ASSERT_EQUAL_HEX32(i,
                                (uint32_t)record_get(&flash[page + 40u * ((i - 1u) % 6u) + 4u], 4));
    }
}

static void test_a_record_that_went_elsewhere_says_so(void)
{
    const struct record_log log = {0, 1, 24};
    uint8_t slot[RECORD_SLOT_BYTES(24)] = {0};

    TEST_ASSERT_EQUAL_INT(RECORD_WRITTEN, record_log_write(&board, &log, slot));
    worn_from = 40;
    worn_to = 48;
    TEST_ASSERT_EQUAL_INT(RECORD_WRITTEN_ELSEWHERE, record_log_write(&board, &log, slot));
    TEST_ASSERT_EQUAL_INT(RECORD_WRITTEN, record_log_write(&board, &log, slot));
}

static void test_a_flipped_bit_makes_a_record_void(void)
{
    TEST_ASSERT_TRUE(save(0.01));
    for (int bit = 0; bit < 36 * 8; bit++) {
        flash[bit / 8] ^= (uint8_t)(1 << bit % 8);
        TEST_ASSERT_EQUAL_DOUBLE(-1.0, kept());
        flash[bit / 8] ^= (uint8_t)(1 << bit % 8);
    }
}

static void test_a_board_without_a_store_keeps_nothing(void)
{
    facts.parameter_page_bytes = 0;
    TEST_ASSERT_FALSE(save(0.01));
    TEST_ASSERT_EQUAL_DOUBLE(-1.0, kept());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_check_of_a_record_is_the_standard_one);
    RUN_TEST(test_a_torque_is_kept_to_nearest_and_within_its_range);
    RUN_TEST(test_what_is_saved_is_found_again);
    RUN_TEST(test_an_erased_store_keeps_nothing);
    RUN_TEST(test_the_last_of_many_savings_counts);
    RUN_TEST(test_the_supply_may_fail_at_any_byte_of_any_saving);
    RUN_TEST(test_a_page_whose_first_word_is_worn_out_is_used_behind_it);
    RUN_TEST(test_a_slot_that_stays_blank_is_passed_over);
    RUN_TEST(test_a_page_that_is_worn_out_leaves_the_other);
    RUN_TEST(test_a_store_that_takes_nothing_refuses);
    RUN_TEST(test_each_record_has_the_next_number);
    RUN_TEST(test_a_record_that_went_elsewhere_says_so);
    RUN_TEST(test_a_flipped_bit_makes_a_record_void);
    RUN_TEST(test_a_board_without_a_store_keeps_nothing);
    return UNITY_END();
}
