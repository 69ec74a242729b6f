/* Answers of a console: words and numbers into a buffer that may be too small. */
#include <string.h>

#include <unity.h>

#include "firmware/design/text.h"

static char buffer[40];
static struct text text;

void setUp(void)
{
    memset(buffer, '#', sizeof buffer);
    text = text_in(buffer, sizeof buffer);
}

void tearDown(void)
{
}

static void reads(const char *expected)
{
    TEST_ASSERT_EQUAL_STRING(expected, buffer);
    TEST_ASSERT_EQUAL_size_t(strlen(expected), text.length);
    setUp();
}

static void number_reads(const char *expected, double value, int digits)
{
    text_number(&text, value, digits);
    reads(expected);
}

static void test_words_follow_one_another(void)
{
    reads("");
    text_put(&text, "move");
    text_put(&text, " refused");
    reads("move refused");
}

static void test_what_does_not_fit_is_cut_and_nothing_behind_it_is_touched(void)
{
    text = text_in(buffer, 8);
    text_put(&text, "0123456789");
    text_unsigned(&text, 42);
    TEST_ASSERT_EQUAL_STRING("0123456", buffer);
    TEST_ASSERT_EQUAL_size_t(7, text.length);
    TEST_ASSERT_EQUAL_CHAR('#', buffer[8]);
}

static void test_whole_numbers_have_no_leading_zeros(void)
{
    static const uint32_t values[] = {0, 7, 10, 99, 100, 12345, 1000000000, 4294967295u};
    static const char *const words[] = {"0",   "7",     "10",         "99",
                                        "100", "12345", "1000000000", "4294967295"};

    for (int i = 0; i < 8; i++) {
        text_unsigned(&text, values[i]);
        reads(words[i]);
    }
}

static void test_hexadecimal_digits_are_as_many_as_asked_for(void)
{
    text_hexadecimal(&text, 0x1a2b3c4du, 8);
    reads("1a2b3c4d");
    text_hexadecimal(&text, 0x1a2b3c4du, 3);
    reads("c4d");
    text_hexadecimal(&text, 0xfu, 4);
    reads("000f");
    text_hexadecimal(&text, 0x9u, 1);
    reads("9");
}

static void test_a_number_has_its_digits_rounded_and_no_zeros_at_its_end(void)
{
    number_reads("0", 0.0, 4);
    number_reads("1", 1.0, 4);
    number_reads("-1.5", -1.5, 4);
    number_reads("3.142", 3.14159265, 4);
    number_reads("3.14159265", 3.14159265, 9);
    number_reads("3", 3.14159265, 1);
    number_reads("1500", 1500.0, 4);
    number_reads("1235", 1234.5, 4);
    number_reads("1234", 1234.49, 4);
    number_reads("9999", 9999.4, 4);
    number_reads("10000", 9999.6, 4);
    number_reads("0.0312", 0.0312, 4);
    number_reads("0.1", 0.09999999, 4);
    number_reads("0.2", 0.2, 9);
}

/* Beyond -4...5, or as many as there are digits. */
static void test_what_is_very_large_or_small_has_an_exponent(void)
{
    number_reads("0.0001", 1e-4, 4);
    number_reads("9.999e-05", 9.999e-5, 4);
    number_reads("123400", 123400.0, 4);
    number_reads("1.234e+06", 1234000.0, 4);
    number_reads("123456789", 123456789.0, 9);
    number_reads("1234567890", 1234567890.0, 9);
    number_reads("1.23456789e+10", 12345678900.0, 9);
    number_reads("-2.5e-07", -2.5e-7, 4);
    number_reads("1e+100", 1e100, 4);
    number_reads("1e-100", 1e-100, 4);
    number_reads("1.798e+308", 1.7976931348623157e308, 4);
}

static void test_what_is_no_number_says_so(void)
{
    number_reads("(not finite)", __builtin_nan(""), 4);
    number_reads("(not finite)", __builtin_inf(), 4);
    number_reads("(not finite)", -__builtin_inf(), 4);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_words_follow_one_another);
    RUN_TEST(test_what_does_not_fit_is_cut_and_nothing_behind_it_is_touched);
    RUN_TEST(test_whole_numbers_have_no_leading_zeros);
    RUN_TEST(test_hexadecimal_digits_are_as_many_as_asked_for);
    RUN_TEST(test_a_number_has_its_digits_rounded_and_no_zeros_at_its_end);
    RUN_TEST(test_what_is_very_large_or_small_has_an_exponent);
    RUN_TEST(test_what_is_no_number_says_so);
    return UNITY_END();
}
