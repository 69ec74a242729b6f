/* Commands on their way to the control interrupt. */
#include <unity.h>

#include "firmware/drive/command_queue.h"

static struct command_queue queue;

void setUp(void)
{
    static const struct command_queue empty;

    queue = empty;
}

void tearDown(void)
{
}

/* A move whose profile's jerk distinguishes it from the others. */
static bool put(int64_t mark, uint32_t at_period)
{
    const struct queued_command command = {
        .kind = DRIVE_COMMAND_MOVE_TRAPEZOID, .at_period = at_period, .profile = {.jerk = mark}};

    return command_queue_put(&queue, &command);
}

static struct queued_command *due(uint32_t period)
{
    uint32_t wait = COMMAND_QUEUE_NEVER;

    return command_queue_due(&queue, period, &wait);
}

static bool takes(struct urgent_command *urgent, uint32_t period)
{
    uint32_t wait = COMMAND_QUEUE_NEVER;

    return command_queue_take_urgent(&queue, urgent, period, &wait);
}

static bool is_due(int64_t mark, uint32_t period)
{
    const struct queued_command *command = due(period);

    return command != NULL && command->kind == DRIVE_COMMAND_MOVE_TRAPEZOID &&
           command->profile.jerk == mark;
}

static bool nothing_is_due(uint32_t period)
{
    return due(period) == NULL;
}

static void test_an_empty_queue_has_nothing_due(void)
{
    TEST_ASSERT_TRUE(nothing_is_due(0));
    TEST_ASSERT_TRUE(nothing_is_due(UINT32_MAX));
    TEST_ASSERT_FALSE(takes(&queue.stop, 0));
    TEST_ASSERT_FALSE(takes(&queue.disable, 0));
}

static void test_a_command_is_due_from_its_period_on_until_it_is_dropped(void)
{
    put(1, 100);
    TEST_ASSERT_TRUE(nothing_is_due(99));
    TEST_ASSERT_TRUE(is_due(1, 100));
    TEST_ASSERT_TRUE(is_due(1, 101));
    command_queue_drop(&queue);
    TEST_ASSERT_TRUE(nothing_is_due(102));
}

static void test_a_command_whose_period_has_passed_is_due_at_once(void)
{
    put(1, 5);
    TEST_ASSERT_TRUE(is_due(1, 1000000));
}

/* The first one posted holds the others back, even those of an earlier period. */
static void test_commands_act_in_the_order_they_were_posted(void)
{
    put(1, 200);
    put(2, 100);
    TEST_ASSERT_TRUE(nothing_is_due(150));
    TEST_ASSERT_TRUE(is_due(1, 200));
    command_queue_drop(&queue);
    TEST_ASSERT_TRUE(is_due(2, 200));
    command_queue_drop(&queue);
    TEST_ASSERT_TRUE(nothing_is_due(200));
}

/* One entry less than its length: the last may be the profile that is being moved along. */
#define CAPACITY (COMMAND_QUEUE_LENGTH - 1u)

static void test_a_full_queue_refuses_and_loses_nothing(void)
{
    for (uint32_t i = 0; i < CAPACITY; i++) {
        TEST_ASSERT_TRUE(put(i, 0));
    }
    TEST_ASSERT_FALSE(put(99, 0));
    for (uint32_t i = 0; i < CAPACITY; i++) {
        TEST_ASSERT_TRUE(is_due(i, 0));
        command_queue_drop(&queue);
    }
    TEST_ASSERT_TRUE(nothing_is_due(0));
    TEST_ASSERT_TRUE(put(100, 0));
    TEST_ASSERT_TRUE(is_due(100, 0));
}

static void test_the_queue_goes_round_for_ever(void)
{
    for (int64_t i = 0; i < 1000; i++) {
        TEST_ASSERT_TRUE(put(2 * i, 0));
        TEST_ASSERT_TRUE(put(2 * i + 1, 0));
        TEST_ASSERT_TRUE(is_due(2 * i, 0));
        command_queue_drop(&queue);
        TEST_ASSERT_TRUE(is_due(2 * i + 1, 0));
        command_queue_drop(&queue);
    }
}

/* Its own counters pass 2^32, too. */
static void test_the_queue_goes_on_when_its_counters_wrap(void)
{
    queue.written = UINT32_MAX - 1u;
    queue.read = UINT32_MAX - 1u;
    for (uint32_t i = 0; i < CAPACITY; i++) {
        TEST_ASSERT_TRUE(put(i, 0));
    }
    TEST_ASSERT_FALSE(put(99, 0));
    command_queue_put_urgent(&queue, &queue.stop, 0);
    command_queue_drop(&queue);
    TEST_ASSERT_TRUE(is_due(1, 0));
    TEST_ASSERT_TRUE(takes(&queue.stop, 0));
    TEST_ASSERT_TRUE(nothing_is_due(0));
}

/* After 5 days at 10 kHz the period index passes 2^32. */
static void test_a_command_addressed_across_the_wrap_of_the_period_waits_for_it(void)
{
    put(1, 3);
    TEST_ASSERT_TRUE(nothing_is_due(UINT32_MAX - 10u));
    TEST_ASSERT_TRUE(nothing_is_due(UINT32_MAX));
    TEST_ASSERT_TRUE(nothing_is_due(2));
    TEST_ASSERT_TRUE(is_due(1, 3));
    command_queue_drop(&queue);

    put(2, UINT32_MAX - 1u);
    TEST_ASSERT_TRUE(nothing_is_due(UINT32_MAX - 2u));
    TEST_ASSERT_TRUE(is_due(2, 5));

    command_queue_put_urgent(&queue, &queue.stop, 7);
    TEST_ASSERT_FALSE(takes(&queue.stop, UINT32_MAX));
    TEST_ASSERT_TRUE(takes(&queue.stop, 7));
}

static void test_a_stop_overtakes_the_commands_before_it_and_flushes_them(void)
{
    put(1, 1000);
    put(2, 1000);
    command_queue_put_urgent(&queue, &queue.stop, 50);
    put(3, 60);
    TEST_ASSERT_FALSE(takes(&queue.stop, 49));
    TEST_ASSERT_TRUE(takes(&queue.stop, 50));
    TEST_ASSERT_TRUE(is_due(3, 60));
}

static void test_an_urgent_command_is_taken_once(void)
{
    command_queue_put_urgent(&queue, &queue.disable, 10);
    TEST_ASSERT_TRUE(takes(&queue.disable, 12));
    TEST_ASSERT_FALSE(takes(&queue.disable, 13));
}

/* One for later does not withdraw the one that waits. */
static void test_of_two_disables_the_earlier_period_counts(void)
{
    command_queue_put_urgent(&queue, &queue.disable, 10);
    command_queue_put_urgent(&queue, &queue.disable, 20);
    TEST_ASSERT_FALSE(takes(&queue.disable, 9));
    TEST_ASSERT_TRUE(takes(&queue.disable, 10));
    TEST_ASSERT_FALSE(takes(&queue.disable, 20));

    command_queue_put_urgent(&queue, &queue.stop, UINT32_MAX);
    command_queue_put_urgent(&queue, &queue.stop, 3); /* behind the wrap */
    TEST_ASSERT_TRUE(takes(&queue.stop, UINT32_MAX));
    command_queue_put_urgent(&queue, &queue.stop, 40);
    command_queue_put_urgent(&queue, &queue.stop, 30);
    TEST_ASSERT_TRUE(takes(&queue.stop, 30));
    TEST_ASSERT_FALSE(takes(&queue.stop, 40));
}

/* What the second one was to flush acts after neither. */
static void test_of_two_disables_all_that_was_posted_before_is_flushed(void)
{
    put(1, 1000);
    command_queue_put_urgent(&queue, &queue.disable, 10);
    put(2, 11);
    command_queue_put_urgent(&queue, &queue.disable, 20);
    put(3, 12);
    TEST_ASSERT_TRUE(takes(&queue.disable, 10));
    TEST_ASSERT_TRUE(is_due(3, 12));
}

static void test_stop_and_disable_do_not_stand_in_each_others_way(void)
{
    command_queue_put_urgent(&queue, &queue.stop, 10);
    command_queue_put_urgent(&queue, &queue.disable, 20);
    TEST_ASSERT_FALSE(takes(&queue.disable, 10));
    TEST_ASSERT_TRUE(takes(&queue.stop, 10));
    TEST_ASSERT_TRUE(takes(&queue.disable, 20));
}

/* What had been posted before the stop has acted meanwhile: nothing behind it is lost. */
static void test_a_flush_never_brings_commands_back(void)
{
    put(1, 0);
    command_queue_put_urgent(&queue, &queue.stop, 50);
    command_queue_drop(&queue);
    put(2, 0);
    command_queue_drop(&queue);
    put(3, 0);
    TEST_ASSERT_TRUE(takes(&queue.stop, 50));
    TEST_ASSERT_TRUE(is_due(3, 50));
}

/* Periods from `from` on in which the queue calls while nothing acts, up to `to`; -1: none. */
static int calls_from(uint32_t from, uint32_t to)
{
    for (uint32_t period = from; period <= to; period++) {
        if (command_queue_is_due(&queue, period)) {
            return (int)period;
        }
    }
    return -1;
}

/* As the interrupt does, where nothing that is due in the period can act. */
static void look(uint32_t period)
{
    uint32_t wait = COMMAND_QUEUE_NEVER;
    const struct queued_command *command;

    command_queue_look(&queue, period);
    (void)command_queue_take_urgent(&queue, &queue.disable, period, &wait);
    (void)command_queue_take_urgent(&queue, &queue.stop, period, &wait);
    command = command_queue_due(&queue, period + 1u, &wait);
    wait = command_queue_wait_of(command, period + 1u, wait);
    (void)command_queue_preemption(&queue, period, &wait);
    command_queue_rest(&queue, period, wait);
}

/* What lets the interrupt pass the queue by. */
static void test_the_queue_is_due_when_something_was_posted_and_when_its_period_comes(void)
{
    const struct preemption preemption = {.at_period = 130};

    look(10);
    TEST_ASSERT_EQUAL_INT(-1, calls_from(11, 200));
    put(1, 100);
    TEST_ASSERT_EQUAL_INT(11, calls_from(11, 200));
    look(11);
    TEST_ASSERT_EQUAL_INT(99, calls_from(12, 200)); /* a move is loaded a period ahead */
    look(99);
    TEST_ASSERT_EQUAL_INT(100, calls_from(100, 200)); /* all else acts in its period */
    command_queue_drop(&queue);

    command_queue_put_urgent(&queue, &queue.disable, 120);
    command_queue_put_urgent(&queue, &queue.stop, 110);
    command_queue_put_preemption(&queue, &preemption);
    look(100);
    TEST_ASSERT_EQUAL_INT(110, calls_from(101, 200));
    look(110);
    TEST_ASSERT_EQUAL_INT(120, calls_from(111, 200));
    look(120);
    TEST_ASSERT_EQUAL_INT(130, calls_from(121, 200));
    command_queue_withdraw_preemption(&queue);
    look(130);
    TEST_ASSERT_EQUAL_INT(-1, calls_from(131, 200));
}

/* A move whose period has passed waits for the one before it; the queue calls when that is done. */
static void test_a_command_that_is_overdue_is_looked_at_when_the_reference_rests(void)
{
    put(1, 50);
    look(60);
    TEST_ASSERT_EQUAL_INT(-1, calls_from(61, 200));
    command_queue_look_next(&queue);
    TEST_ASSERT_EQUAL_INT(61, calls_from(61, 200));
}

/* A queue that nothing is posted to for 30 hours is looked at, and passed by again. */
static void test_a_queue_at_rest_is_passed_by_across_the_wrap_of_the_period(void)
{
    look(UINT32_MAX - 5u);
    TEST_ASSERT_FALSE(command_queue_is_due(&queue, UINT32_MAX));
    TEST_ASSERT_FALSE(command_queue_is_due(&queue, 0));
    TEST_ASSERT_FALSE(command_queue_is_due(&queue, COMMAND_QUEUE_NEVER - 7u));
    TEST_ASSERT_TRUE(command_queue_is_due(&queue, COMMAND_QUEUE_NEVER - 6u));
    put(1, 5);
    TEST_ASSERT_TRUE(command_queue_is_due(&queue, 0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_an_empty_queue_has_nothing_due);
    RUN_TEST(test_a_command_is_due_from_its_period_on_until_it_is_dropped);
    RUN_TEST(test_a_command_whose_period_has_passed_is_due_at_once);
    RUN_TEST(test_commands_act_in_the_order_they_were_posted);
    RUN_TEST(test_a_full_queue_refuses_and_loses_nothing);
    RUN_TEST(test_the_queue_goes_round_for_ever);
    RUN_TEST(test_the_queue_goes_on_when_its_counters_wrap);
    RUN_TEST(test_a_command_addressed_across_the_wrap_of_the_period_waits_for_it);
    RUN_TEST(test_a_stop_overtakes_the_commands_before_it_and_flushes_them);
    RUN_TEST(test_an_urgent_command_is_taken_once);
    RUN_TEST(test_of_two_disables_the_earlier_period_counts);
    RUN_TEST(test_of_two_disables_all_that_was_posted_before_is_flushed);
    RUN_TEST(test_stop_and_disable_do_not_stand_in_each_others_way);
    RUN_TEST(test_a_flush_never_brings_commands_back);
    RUN_TEST(test_the_queue_is_due_when_something_was_posted_and_when_its_period_comes);
    RUN_TEST(test_a_command_that_is_overdue_is_looked_at_when_the_reference_rests);
    RUN_TEST(test_a_queue_at_rest_is_passed_by_across_the_wrap_of_the_period);
    return UNITY_END();
}
