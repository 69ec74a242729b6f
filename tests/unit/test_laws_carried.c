/* An image that names its laws has these and no others. */
#define STEADYSTEP_LAWS LAW_BIT(STATE_FEEDBACK) + LAW_BIT(FOC)

#include "firmware/control/laws_carried.h"

#include <unity.h>

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_the_laws_that_are_named_are_carried_and_no_others(void)
{
    for (int law = 0; law < POSITION_LAW_COUNT; law++) {
        const bool named = law == POSITION_LAW_STATE_FEEDBACK || law == POSITION_LAW_FOC;

        TEST_ASSERT_EQUAL(named, position_law_is_carried((enum position_law)law));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_laws_that_are_named_are_carried_and_no_others);
    return UNITY_END();
}
