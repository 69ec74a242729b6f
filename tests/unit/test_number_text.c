#include "firmware/application/number_text.h"

#include <math.h>
#include <string.h>
#include <unity.h>

void setUp(void)
{
}

void tearDown(void)
{
}

/* The same bits, signs of zeros included. */
static void reads(const char *text, double expected)
{
    double value = 0.0;

    TEST_ASSERT_EQUAL_INT_MESSAGE(NUMBER_TEXT_READ, number_from_text(text, strlen(text), &value),
                                  text);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&expected, &value, sizeof value, text);
}

static void refuses(const char *text, enum number_text expected)
{
    double value = 42.0;

    TEST_ASSERT_EQUAL_INT_MESSAGE(expected, number_from_text(text, strlen(text), &value), text);
    TEST_ASSERT_TRUE_MESSAGE(value == 42.0, text);
}

/* Against the compiler's own reading of the same number. */
static void test_a_decimal_number_is_the_nearest_double(void)
{
    reads("0", 0.0);
    reads("-0.0", -0.0);
    reads("1.5", 1.5);
    reads("+1.5", 1.5);
    reads("0.1", 0.1);
    reads(".1", 0.1);
    reads("7.", 7.0);
    reads("123456789.012345", 123456789.012345);
    reads("9007199254740992", 9007199254740992.0);
    reads("1e-4", 1e-4);
    reads("1E+4", 1e4);
    reads("3.14159265358979", 3.14159265358979);
    reads("-25e-22", -25e-22);
    reads("1e22", 1e22);
    reads("1e30", 1e30);
    reads("00000000000000000000001.50000000000000000000000", 1.5);
    reads("0.000000000000000000001", 1e-21);
    reads("100000000000000000000000", 1e23);
    reads("900719925474099e23", 900719925474099e23);
    reads("9999999999e27", 9999999999e27);
}

static void test_a_hexadecimal_number_is_exact(void)
{
    reads("0x1.8p+0", 0x1.8p+0);
    reads("-0X1.FFFFFFFFFFFFFP+1023", -0x1.fffffffffffffp+1023);
    reads("0x1p-1022", 0x1p-1022);
    reads("0x0p+0", 0.0);
    reads("0x.8p1", 1.0);
    reads("0xc.80p-3", 1.5625);
    reads("0x10", 16.0);
    reads("0x20000000000000p0", 0x1p+53);
    reads("0x1.921fb54442d18p+1", 0x1.921fb54442d18p+1);
    reads("0xabcdefp0", 11259375.0);
    reads("0xABCDEFp0", 11259375.0);
    reads("0x9.9p0", 9.5625);
}

static void test_what_one_rounding_cannot_give_is_refused(void)
{
    refuses("9007199254740993", NUMBER_TEXT_TOO_LONG);
    refuses("3.14159265358979323846", NUMBER_TEXT_TOO_LONG);
    refuses("0x1.00000000000008p0", NUMBER_TEXT_TOO_LONG);
    refuses("1e-23", NUMBER_TEXT_OUT_OF_RANGE);
    refuses("1e99999999999", NUMBER_TEXT_OUT_OF_RANGE);
    refuses("0x1p1024", NUMBER_TEXT_OUT_OF_RANGE);
    refuses("0x1p-1023", NUMBER_TEXT_OUT_OF_RANGE);
}

/* What is behind it belongs to something else. */
static void test_a_number_ends_with_its_length(void)
{
    double value = 42.0;

    TEST_ASSERT_EQUAL_INT(NUMBER_TEXT_READ, number_from_text("0x12", 1, &value));
    TEST_ASSERT_TRUE(value == 0.0);
    TEST_ASSERT_EQUAL_INT(NUMBER_TEXT_MALFORMED, number_from_text("0x12", 2, &value));
    TEST_ASSERT_EQUAL_INT(NUMBER_TEXT_READ, number_from_text("0x12", 3, &value));
    TEST_ASSERT_TRUE(value == 1.0);
    TEST_ASSERT_EQUAL_INT(NUMBER_TEXT_READ, number_from_text("1.25e7", 3, &value));
    TEST_ASSERT_TRUE(value == 1.2);
}

static void test_what_is_no_number_is_refused(void)
{
    static const char *const texts[] = {"",    "-",  ".",   "e5",   "1e",    "1e+", "1.2.3",
                                        "--1", "1x", "0x",  "0xg",  "0x1p",  "nan", "inf",
                                        "1 ",  " 1", "1,5", "1e5.", "0x.p1", "+-1", "1e-+2"};

    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        refuses(texts[i], NUMBER_TEXT_MALFORMED);
    }
}

static void test_whole_numbers_have_32_bits(void)
{
    uint32_t value = 7;

    TEST_ASSERT_TRUE(unsigned_from_text("4294967295", 10, &value));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, value);
    TEST_ASSERT_TRUE(unsigned_from_text("0", 1, &value));
    TEST_ASSERT_EQUAL_UINT32(0, value);
    TEST_ASSERT_FALSE(unsigned_from_text("4294967296", 10, &value));
    TEST_ASSERT_FALSE(unsigned_from_text("99999999999999999999", 20, &value));
    TEST_ASSERT_FALSE(unsigned_from_text("", 0, &value));
    TEST_ASSERT_FALSE(unsigned_from_text("-1", 2, &value));
    TEST_ASSERT_FALSE(unsigned_from_text("1a", 2, &value));
    TEST_ASSERT_EQUAL_UINT32(0, value);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_decimal_number_is_the_nearest_double);
    RUN_TEST(test_a_hexadecimal_number_is_exact);
    RUN_TEST(test_what_one_rounding_cannot_give_is_refused);
    RUN_TEST(test_a_number_ends_with_its_length);
    RUN_TEST(test_what_is_no_number_is_refused);
    RUN_TEST(test_whole_numbers_have_32_bits);
    return UNITY_END();
}
