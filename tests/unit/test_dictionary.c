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

static void test_every_signal_has_an_index_of_its_own_and_shows_its_member(void)
{
    struct drive_signals signals = {.state = DRIVE_FAULT, .theta_est_rad = 0.5, .period = 70000};

    signals.holding = true;
    for (int i = 0; i < SIGNALS; i++) {
        for (int j = 0; j < i; j++) {
            TEST_ASSERT_NOT_EQUAL(signal_at((enum drive_signal)i)->index,
                                  signal_at((enum drive_signal)j)->index);
        }
    }
    TEST_ASSERT_TRUE(signal_get(&signals, signal_at(SIGNAL_theta_est_rad)) == 0.5);
    TEST_ASSERT_TRUE(signal_get(&signals, signal_at(SIGNAL_period)) == 70000.0);
    TEST_ASSERT_EQUAL_STRING("fault", signal_word(signal_at(SIGNAL_state), DRIVE_FAULT));
    TEST_ASSERT_EQUAL_STRING("yes", signal_word(signal_at(SIGNAL_holding), 1.0));
    TEST_ASSERT_NULL(signal_word(signal_at(SIGNAL_i_d_A), 1.0));
    TEST_ASSERT_EQUAL_HEX16(0x603f, signal_at(SIGNAL_fault)->index);
}

static void test_every_fault_has_a_name_and_a_code_of_its_own(void)
{
    for (int i = 0; i < DRIVE_FAULTS; i++) {
        for (int j = 0; j < i; j++) {
            TEST_ASSERT_NOT_EQUAL(fault_at((enum drive_fault)i)->code,
                                  fault_at((enum drive_fault)j)->code);
            TEST_ASSERT_NOT_EQUAL(0, strcmp(drive_fault_name((enum drive_fault)i),
                                            drive_fault_name((enum drive_fault)j)));
        }
    }
    TEST_ASSERT_EQUAL_HEX16(0x0000, fault_at(DRIVE_FAULT_NONE)->code);
    TEST_ASSERT_EQUAL_HEX16(0x2310, fault_at(DRIVE_FAULT_OVERCURRENT)->code);
}

static void test_every_command_has_a_name_and_a_number_of_its_own(void)
{
    for (int i = 0; i < DRIVE_COMMANDS; i++) {
        const struct command_row *row = command_at((enum drive_command_kind)i);

        TEST_ASSERT_EQUAL_STRING(row->name, drive_command_name((enum drive_command_kind)i));
        for (int j = 0; j < i; j++) {
            const struct command_row *other = command_at((enum drive_command_kind)j);

            TEST_ASSERT_NOT_EQUAL(row->number, other->number);
            TEST_ASSERT_NOT_EQUAL(0, strcmp(row->name, other->name));
        }
    }
}

static void test_a_command_has_its_parameters_in_the_order_of_the_table(void)
{
    static const char *const names[] = {"ramp_s", "amplitude_rad", "frequency_Hz", "cycles"};

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        TEST_ASSERT_NOT_NULL(parameter_of(DRIVE_COMMAND_SINE, i));
        TEST_ASSERT_EQUAL_STRING(names[i], parameter_of(DRIVE_COMMAND_SINE, i)->name);
    }
    TEST_ASSERT_NULL(parameter_of(DRIVE_COMMAND_SINE, 4));
    TEST_ASSERT_NULL(parameter_of(DRIVE_COMMAND_STOP, 0));
}

static void test_a_parameter_is_put_where_the_drive_reads_it(void)
{
    struct drive_command command = {.kind = DRIVE_COMMAND_VELOCITY};

    parameter_put(&command, parameter_at(DRIVE_PARAMETER_speed_rad_s), 3.0);
    TEST_ASSERT_TRUE(command.speed_rad_s == 3.0);
    TEST_ASSERT_TRUE(parameter_get(&command, parameter_at(DRIVE_PARAMETER_speed_rad_s)) == 3.0);
}

static void test_no_command_has_more_parameters_than_it_names(void)
{
    for (int kind = 0; kind < DRIVE_COMMANDS; kind++) {
        const struct command_row *row = command_at((enum drive_command_kind)kind);
        const unsigned all = (unsigned)row->required | row->optional;
        size_t count = 0;

        for (unsigned left = all; left != 0u; left &= left - 1u) {
            count++;
        }
        for (size_t i = 0; i < 20; i++) {
            TEST_ASSERT_EQUAL(i < count, parameter_of((enum drive_command_kind)kind, i) != NULL);
        }
    }
}

/* What the interrupt asks of a command. */
static void test_a_command_is_planned_in_one_way(void)
{
    for (int i = 0; i < DRIVE_COMMANDS; i++) {
        const enum drive_command_kind kind = (enum drive_command_kind)i;

        TEST_ASSERT_EQUAL(
            1, drive_command_is(kind, DRIVE_AT_ONCE) + drive_command_is(kind, DRIVE_URGENT) +
                   drive_command_is(kind, DRIVE_IN_TURN) + drive_command_is(kind, DRIVE_PROFILE) +
                   drive_command_is(kind, DRIVE_AHEAD));
    }
}

static void test_a_fault_names_the_setting_that_limits(void)
{
    TEST_ASSERT_NOT_NULL(fault_limit(DRIVE_FAULT_BUS_VOLTAGE));
    TEST_ASSERT_EQUAL_STRING("supply_V", fault_limit(DRIVE_FAULT_BUS_VOLTAGE)->name);
    TEST_ASSERT_NULL(fault_limit(DRIVE_FAULT_STALLED));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_signal_has_an_index_of_its_own_and_shows_its_member);
    RUN_TEST(test_every_fault_has_a_name_and_a_code_of_its_own);
    RUN_TEST(test_every_command_has_a_name_and_a_number_of_its_own);
    RUN_TEST(test_a_command_has_its_parameters_in_the_order_of_the_table);
    RUN_TEST(test_no_command_has_more_parameters_than_it_names);
    RUN_TEST(test_a_parameter_is_put_where_the_drive_reads_it);
    RUN_TEST(test_a_command_is_planned_in_one_way);
    RUN_TEST(test_a_fault_names_the_setting_that_limits);
    return UNITY_END();
}
