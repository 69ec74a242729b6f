/* What the bridge takes away, and the period of delay between command and voltage. */
#include "firmware/motor/actuation.h"
#include "tests/unit/num_assert.h"

static struct actuation actuation;

void setUp(void)
{
    actuation_reset(&actuation);
}

void tearDown(void)
{
}

static struct phases voltage(double a, double b)
{
    return (struct phases){num_from_double(a), num_from_double(b)};
}

static void is_voltage(double a, double b, struct phases actual)
{
    TEST_ASSERT_NUM_WITHIN(4.0 * NUM_ROUNDING, a, actual.a);
    TEST_ASSERT_NUM_WITHIN(4.0 * NUM_ROUNDING, b, actual.b);
}

/* The voltage of a bridge that loses 0.02 of phase a and 0.03 of phase b, whatever the command. */
static struct phases bridge(struct phases command)
{
    return (struct phases){command.a - NUM(0.02), command.b + NUM(0.03)};
}

static void test_a_constant_loss_is_made_up_for_once_it_has_been_measured(void)
{
    const struct phases wanted = voltage(0.4, -0.2);
    struct phases in_force = voltage(0.0, 0.0); /* by the bridge, S(k-1)...S(k) */
    struct phases command = voltage(0.0, 0.0);

    for (int k = 0; k < 4; k++) {
        const struct phases measured = bridge(in_force);

        (void)actuation_observe(&actuation, measured);
        (void)actuation_act(&actuation);
        in_force = command;
        command = actuation_compensate(&actuation, wanted);
        actuation_commit(&actuation, command);
    }
    is_voltage(0.4, -0.2, bridge(command));
}

static void test_the_voltage_in_force_is_the_last_command_less_the_loss(void)
{
    actuation_commit(&actuation, voltage(0.1, 0.1));
    (void)actuation_act(&actuation);
    actuation_commit(&actuation, voltage(0.3, -0.3));
    is_voltage(-0.02, 0.03, actuation_observe(&actuation, bridge(voltage(0.1, 0.1))));
    is_voltage(0.3 - 0.02, -0.3 + 0.03, actuation_act(&actuation));
    is_voltage(0.3, -0.3, actuation_commanded(&actuation));
    is_voltage(0.0, 0.0, actuation_observe(&actuation, bridge(voltage(0.3, -0.3))));
}

/* The mean measured at S(k) belongs to the command of S(k-2), not to the one before. */
static void test_commands_that_change_every_period_are_no_loss(void)
{
    static const double commands[] = {0.0, 0.0, 0.5, -0.7, 0.2, 0.9, -0.9, 0.1};

    for (int k = 2; k < 8; k++) {
        (void)actuation_observe(&actuation, voltage(commands[k - 2], -commands[k - 2]));
        is_voltage(0.0, 0.0, actuation.loss);
        (void)actuation_act(&actuation);
        actuation_commit(&actuation, voltage(commands[k], -commands[k]));
    }
}

static void test_a_failed_voltage_sensor_shifts_the_command_by_a_tenth_at_most(void)
{
    const struct phases wanted = voltage(0.5, 0.5);

    (void)actuation_observe(&actuation, voltage(5.0, -5.0));
    is_voltage(0.5 - 0.1, 0.5 + 0.1, actuation_compensate(&actuation, wanted));
}

static void test_after_a_reset_nothing_is_in_force(void)
{
    actuation_commit(&actuation, voltage(0.3, 0.3));
    (void)actuation_observe(&actuation, voltage(0.1, 0.1));
    actuation_reset(&actuation);
    is_voltage(0.0, 0.0, actuation_observe(&actuation, voltage(0.0, 0.0)));
    is_voltage(0.0, 0.0, actuation_act(&actuation));
    is_voltage(0.0, 0.0, actuation.loss);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_constant_loss_is_made_up_for_once_it_has_been_measured);
    RUN_TEST(test_the_voltage_in_force_is_the_last_command_less_the_loss);
    RUN_TEST(test_commands_that_change_every_period_are_no_loss);
    RUN_TEST(test_a_failed_voltage_sensor_shifts_the_command_by_a_tenth_at_most);
    RUN_TEST(test_after_a_reset_nothing_is_in_force);
    return UNITY_END();
}
