/* What a drive has by name, as others go by it. */
#include <string.h>

#include "firmware/interface/dictionary.h"
#include "unity.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_every_fault_has_a_name_and_a_code_of_its_own(void)
{
    for (int i = 0; i < DRIVE_FAULTS; i++) {
        for (int j = 0; j < i; j++) {
            TEST_ASSERT_NOT_EQUAL(fault_code((enum drive_fault)i), fault_code((enum drive_fault)j));
            TEST_ASSERT_NOT_EQUAL(0, strcmp(drive_fault_name((enum drive_fault)i),
                                            drive_fault_name((enum drive_fault)j)));
        }
    }
    TEST_ASSERT_EQUAL_HEX16(0x0000, fault_code(DRIVE_FAULT_NONE));
    TEST_ASSERT_EQUAL_HEX16(0x2310, fault_code(DRIVE_FAULT_OVERCURRENT));
}

static void test_a_fault_names_the_setting_that_limits(void)
{
    TEST_ASSERT_EQUAL_STRING("supply_V", fault_limit(DRIVE_FAULT_BUS_VOLTAGE)->name);
    TEST_ASSERT_NULL(fault_limit(DRIVE_FAULT_STALLED));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_fault_has_a_name_and_a_code_of_its_own);
    RUN_TEST(test_a_fault_names_the_setting_that_limits);
    return UNITY_END();
}
