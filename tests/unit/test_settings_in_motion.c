/* What acts at once: as if the drive had been designed with it, and no period in between. */
#include "firmware/drive/settings_in_motion.h"

#include <string.h>
#include <unity.h>

#include "tests/unit/console_bench.h"
#include "tests/unit/servo_frequency.h"

static struct drive designed;
static struct drive changed;
static struct hal_facts facts;
static struct hal board;
static struct drive_settings settings;
static char error[DRIVE_ERROR_TEXT];

void setUp(void)
{
    facts = bench_stored_facts();
    board = bench_board(&facts);
    drive_settings_default(&settings, &bench_params);
}

void tearDown(void)
{
}

static void choose_others(struct drive_settings *others)
{
    others->current_limit_A = 1.7;
    others->overcurrent_trip_A = 5.0;
    others->motion_current_A = 0.3;
    others->synchronism_policy = DRIVE_SYNCHRONISM_WARN;
}

static bool change(void)
{
    return settings_in_motion_change(&changed, &settings, error);
}

static void assert_same_constants(void)
{
    const struct drive_params *a = &designed.params;
    const struct drive_params *b = &changed.params;

    TEST_ASSERT_EQUAL_MEMORY(&a->law, &b->law, sizeof a->law);
    TEST_ASSERT_EQUAL_MEMORY(&a->hold, &b->hold, sizeof a->hold);
    TEST_ASSERT_EQUAL_MEMORY(&a->protection, &b->protection, sizeof a->protection);
    TEST_ASSERT_EQUAL_INT(designed.synchronism.policy, changed.synchronism.policy);
    TEST_ASSERT_TRUE(designed.synchronism.params.full_current ==
                     changed.synchronism.params.full_current);
    TEST_ASSERT_TRUE(designed.synchronism.params.standing_speed_at_first ==
                     changed.synchronism.params.standing_speed_at_first);
    TEST_ASSERT_EQUAL_MEMORY(&designed.settings, &changed.settings, sizeof designed.settings);
}

static void test_every_law_gets_the_constants_that_its_design_would_give(void)
{
    for (int law = 0; law < POSITION_LAW_COUNT; law++) {
        if (law == POSITION_LAW_MICROSTEPPING) {
            continue;
        }
        setUp();
        drive_settings_select_law(&settings, (enum position_law)law);
        give_servo_frequency(&settings, 100.0);
        TEST_ASSERT_TRUE_MESSAGE(drive_init(&changed, &board, &settings, error), error);
        choose_others(&settings);
        TEST_ASSERT_TRUE_MESSAGE(drive_init(&designed, &board, &settings, error), error);
        TEST_ASSERT_TRUE_MESSAGE(change(), error);
        assert_same_constants();
    }
}

static void test_nothing_else_changes_in_motion(void)
{
    TEST_ASSERT_TRUE_MESSAGE(drive_init(&designed, &board, &settings, error), error);
    TEST_ASSERT_TRUE_MESSAGE(drive_init(&changed, &board, &settings, error), error);
    settings.hold_current_A = 0.7;
    settings.speed_limit_rad_s = 20.0;
    settings.feed_forward = false;
    TEST_ASSERT_TRUE_MESSAGE(change(), error);
    assert_same_constants();
    TEST_ASSERT_TRUE(changed.params.path.feed_forward);
}

static void refuses(const char *reason)
{
    const struct drive_params before = changed.params;

    TEST_ASSERT_FALSE(change());
    TEST_ASSERT_EQUAL_MEMORY(reason, error, strlen(reason));
    TEST_ASSERT_EQUAL_MEMORY(&before, &changed.params, sizeof before);
}

static void test_what_would_make_a_kink_is_refused(void)
{
    drive_settings_select_law(&settings, POSITION_LAW_MICROSTEPPING);
    TEST_ASSERT_TRUE_MESSAGE(drive_init(&changed, &board, &settings, error), error);
    settings.current_limit_A = 2.0;
    refuses("current_limit_A: it is microstepping's current");
    setUp();
    settings.initial_position = DRIVE_INITIAL_POSITION_IMPULSES;
    settings.standstill_pulses = true;
    TEST_ASSERT_TRUE_MESSAGE(drive_init(&changed, &board, &settings, error), error);
    settings.overcurrent_trip_A = 5.0;
    refuses("overcurrent_trip_A: it sizes standstill_pulses");
    setUp();
    TEST_ASSERT_TRUE_MESSAGE(drive_init(&changed, &board, &settings, error), error);
    settings.synchronism_policy = DRIVE_SYNCHRONISM_OFF;
    refuses("synchronism_policy: to and from off");
    setUp();
    settings.current_limit_A = 5.95; /* within its range, not within the board's */
    refuses("current_limit_A 5.95 A: must be at most 5.8");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_law_gets_the_constants_that_its_design_would_give);
    RUN_TEST(test_nothing_else_changes_in_motion);
    RUN_TEST(test_what_would_make_a_kink_is_refused);
    return UNITY_END();
}
