/* From phase voltages to the times high of four legs. */
#include "firmware/control/modulation_limit.h"
#include "firmware/control/modulator.h"
#include "tests/unit/num_assert.h"

#define HALF_PERIOD 8500
#define MAX         modulation_max(4e-6, 100e-6)

static struct modulator_params params;
static struct modulator modulator;

void setUp(void)
{
    params = modulator_design(HALF_PERIOD, MAX);
    modulator_reset(&modulator);
}

void tearDown(void)
{
}

static struct modulation modulate(double a, double b)
{
    const struct phases voltage = {num_from_double(a), num_from_double(b)};

    return modulator_step(&modulator, &params, voltage);
}

static void settle_at_bus(double bus)
{
    for (int k = 0; k < 10; k++) {
        modulator_track_bus(&modulator, num_from_double(bus));
    }
}

/* Mean voltage of a phase, per-unit, as the bridge makes it. */
static double mean_voltage(struct leg_pair legs, double bus)
{
    return (double)(legs.plus - legs.minus) / HALF_PERIOD * bus;
}

static void test_the_legs_switch_evenly_around_the_middle(void)
{
    for (int i = -100; i <= 100; i++) {
        const struct modulation out = modulate(0.0137 * i, -0.0093 * i);

        TEST_ASSERT_EQUAL_INT(HALF_PERIOD, out.a.plus + out.a.minus);
        TEST_ASSERT_EQUAL_INT(HALF_PERIOD, out.b.plus + out.b.minus);
    }
}

/* Both legs move by the same whole count: to one count in 8500. */
static void test_the_legs_give_the_voltage_asked_for(void)
{
    for (int i = -90; i <= 90; i++) {
        const double u = 0.01 * i;
        const struct modulation out = modulate(u, -u);

        TEST_ASSERT_DOUBLE_WITHIN(1.0 / HALF_PERIOD + 1e-4, u, mean_voltage(out.a, 1.0));
        TEST_ASSERT_DOUBLE_WITHIN(1.0 / HALF_PERIOD + 1e-4, -u, mean_voltage(out.b, 1.0));
    }
}

/* What the rest of the drive takes for commanded is what the whole counts give. */
static void test_the_voltage_reported_is_that_of_the_legs(void)
{
    settle_at_bus(1.1);
    for (int i = -110; i <= 110; i++) {
        const struct modulation out = modulate(0.01 * i, -0.0087 * i);

        TEST_ASSERT_NUM_WITHIN(1e-4, mean_voltage(out.a, 1.1), out.voltage.a);
        TEST_ASSERT_NUM_WITHIN(1e-4, mean_voltage(out.b, 1.1), out.voltage.b);
    }
}

static void test_no_voltage_is_half_time_on_every_leg(void)
{
    const struct modulation out = modulate(0.0, 0.0);

    TEST_ASSERT_EQUAL_UINT16(HALF_PERIOD / 2, out.a.plus);
    TEST_ASSERT_EQUAL_UINT16(HALF_PERIOD / 2, out.a.minus);
    TEST_ASSERT_EQUAL_UINT16(HALF_PERIOD / 2, out.b.plus);
    TEST_ASSERT_EQUAL_UINT16(HALF_PERIOD / 2, out.b.minus);
}

/* 2 x (8500 - counts) at 170 MHz. */
static void test_any_voltage_leaves_four_microseconds_with_all_low_sides_on(void)
{
    static const double asked[] = {0.92, 0.95, 1.0, 2.0, 20.0};

    for (unsigned i = 0; i < sizeof asked / sizeof asked[0]; i++) {
        const struct modulation out = modulate(asked[i], -asked[i]);

        TEST_ASSERT_TRUE(2 * (HALF_PERIOD - out.a.plus) >= 680);
        TEST_ASSERT_TRUE(2 * (HALF_PERIOD - out.b.minus) >= 680);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, MAX, mean_voltage(out.a, 1.0));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, -MAX, mean_voltage(out.b, 1.0));
    }
}

/* Without division; the square of an error of a quarter is a sixteenth, 4e-3, 2e-5. */
static void test_the_reciprocal_of_the_bus_follows_within_four_periods(void)
{
    static const double buses[] = {1.2, 1.0, 0.75, 0.9, 1.0};

    for (unsigned i = 0; i < sizeof buses / sizeof buses[0]; i++) {
        for (int k = 0; k < 4; k++) {
            modulator_track_bus(&modulator, num_from_double(buses[i]));
        }
        TEST_ASSERT_NUM_WITHIN(1e-4, 1.0 / buses[i], modulator.bus_reciprocal);
    }
}

/* 24 V to 18 V in one period: the Newton steps leave 1/16, 1/256, ... of the voltage. */
static void test_a_bus_that_sags_by_a_quarter_keeps_the_phase_voltage(void)
{
    static const double left[] = {0.0626, 0.0041, 0.0004, 0.0002};

    TEST_ASSERT_DOUBLE_WITHIN(2e-4, 0.5, mean_voltage(modulate(0.5, 0.0).a, 1.0));
    for (int k = 0; k < 4; k++) {
        modulator_track_bus(&modulator, NUM(0.75));
        const struct modulation out = modulate(0.5, 0.0);

        TEST_ASSERT_DOUBLE_WITHIN(0.5 * left[k], 0.5, mean_voltage(out.a, 0.75));
    }
}

static void test_the_voltage_limit_follows_the_bus(void)
{
    settle_at_bus(0.75);
    TEST_ASSERT_NUM_WITHIN(1e-4, 0.92 * 0.75, modulator_voltage_limit(&modulator, &params));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.92 * 0.75, mean_voltage(modulate(0.9, 0.0).a, 0.75));
}

/* A supply switched from any voltage to any other; what a broken sensor shows opens the bridge
   before it is tracked, and if it were not, it would be forgotten. */
static void test_no_jump_of_the_bus_makes_the_reciprocal_diverge(void)
{
    static const double buses[] = {0.5, 0.75, 1.0, 1.29, 1.9};
    static const double broken[] = {0.0, -1.0, 30.0};

    for (unsigned i = 0; i < sizeof buses / sizeof buses[0]; i++) {
        for (unsigned j = 0; j < sizeof buses / sizeof buses[0]; j++) {
            settle_at_bus(buses[i]);
            settle_at_bus(buses[j]);
            TEST_ASSERT_NUM_WITHIN(1e-4, 1.0 / buses[j], modulator.bus_reciprocal);
        }
    }
    for (unsigned i = 0; i < sizeof broken / sizeof broken[0]; i++) {
        modulator_see_bus(&modulator, num_from_double(broken[i]));
        settle_at_bus(1.0);
        TEST_ASSERT_NUM_WITHIN(1e-4, 1.0, modulator.bus_reciprocal);
        modulator_track_bus(&modulator, num_from_double(fmin(broken[i], 9.0)));
        settle_at_bus(1.0);
        TEST_ASSERT_NUM_WITHIN(1e-4, 1.0, modulator.bus_reciprocal);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_legs_switch_evenly_around_the_middle);
    RUN_TEST(test_the_legs_give_the_voltage_asked_for);
    RUN_TEST(test_the_voltage_reported_is_that_of_the_legs);
    RUN_TEST(test_no_voltage_is_half_time_on_every_leg);
    RUN_TEST(test_any_voltage_leaves_four_microseconds_with_all_low_sides_on);
    RUN_TEST(test_the_reciprocal_of_the_bus_follows_within_four_periods);
    RUN_TEST(test_a_bus_that_sags_by_a_quarter_keeps_the_phase_voltage);
    RUN_TEST(test_the_voltage_limit_follows_the_bus);
    RUN_TEST(test_no_jump_of_the_bus_makes_the_reciprocal_diverge);
    return UNITY_END();
}
