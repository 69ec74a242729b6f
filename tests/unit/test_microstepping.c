/* Open-loop microstepping: a vector along the reference, wherever the rotor is thought to be. */
#include "firmware/control/microstepping.h"
#include "firmware/numeric/angle.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

#define CURRENT_BANDWIDTH 1500.0

enum { CURRENT_GAIN, VOLTAGE_GAIN };

static const double not_given = __builtin_nan("");

/* Of 24 V: two rotations. */
#define ROUNDING_V (24.0 * (4.0 * SINE_ERROR + 2.0 * COEF_ROUNDING + 16.0 * NUM_ROUNDING))

static struct per_unit base;
static double gains[LAW_GAINS_MAX];
static struct position_law_task task;
static struct microstepping_law_params params;
static struct microstepping_law_state state;
static char error[DESIGN_ERROR_TEXT];

void setUp(void)
{
    static const struct microstepping_law_state at_rest;

    base = per_unit_base(&bench_params, PERIOD_S);
    for (int i = 0; i < LAW_GAINS_MAX; i++) {
        gains[i] = not_given;
    }
    task = (struct position_law_task){
        .motor = &bench_params,
        .base = &base,
        .period_s = PERIOD_S,
        .current_bandwidth_rad_s = CURRENT_BANDWIDTH,
        .current_limit_A = 3.0,
        .gains = gains,
    };
    state = at_rest;
}

void tearDown(void)
{
}

static void design(void)
{
    TEST_ASSERT_TRUE_MESSAGE(microstepping_law_design(&params, &task, error), error);
}

/* Electrical angle in turns. */
static angle_t angle(double turns)
{
    return (angle_t)(int64_t)(turns * 4294967296.0);
}

/* What the phases get, turned back from the rotor frame as the drive does it: V. */
static struct bench_vector phases_V(double rotor_turns, double reference_turns, struct dq current,
                                    double limit_V)
{
    const struct voltage_law_input input = {
        .current = current,
        .voltage_limit = num_from_double(limit_V / base.voltage_V),
        .angle = angle(rotor_turns),
        .reference_angle = angle(reference_turns),
    };
    const struct voltage_demand demand = microstepping_law_step(&state, &params, &input);
    const struct phases v = inverse_park(demand.voltage, sincos_of(input.angle));

    return (struct bench_vector){num_to_double(v.a) * base.voltage_V,
                                 num_to_double(v.b) * base.voltage_V};
}

static void is_along(double length_V, double turns, struct bench_vector v)
{
    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, length_V * cos(TWO_PI * turns), v.a);
    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, length_V * sin(TWO_PI * turns), v.b);
}

static const struct dq no_current = {NUM(0.0), NUM(0.0)};

/* Kim 2016 (5). */
static void test_a_given_voltage_lies_along_the_reference_whatever_the_estimate(void)
{
    gains[VOLTAGE_GAIN] = 12.0;
    design();
    for (int reference = 0; reference < 16; reference++) {
        for (int rotor = 0; rotor < 16; rotor++) {
            const double turns = reference / 16.0 + 0.01;

            is_along(12.0, turns, phases_V(rotor / 16.0, turns, no_current, 22.0));
        }
    }
}

static void test_a_voltage_beyond_the_bus_is_shortened_and_keeps_its_direction(void)
{
    gains[VOLTAGE_GAIN] = 30.0;
    design();
    is_along(20.0, 0.3, phases_V(0.1, 0.3, no_current, 20.0));
}

/* The first answer of the current control is Kp = L w_c times what is missing. */
static void test_without_a_voltage_the_current_is_controlled_to_its_limit(void)
{
    design();
    is_along(0.9e-3 * CURRENT_BANDWIDTH * 3.0, 0.3, phases_V(0.7, 0.3, no_current, 22.0));
    setUp();
    gains[CURRENT_GAIN] = 1.5;
    design();
    is_along(0.9e-3 * CURRENT_BANDWIDTH * 1.5, 0.3, phases_V(0.7, 0.3, no_current, 22.0));
}

/* Measured in the rotor frame, compared in the reference's. */
static void test_a_current_that_lies_along_the_reference_asks_for_no_change(void)
{
    const double ahead = 0.3 - 0.7;
    const struct dq current = {num_from_double(3.0 / base.current_A * cos(TWO_PI * ahead)),
                               num_from_double(3.0 / base.current_A * sin(TWO_PI * ahead))};

    design();
    is_along(0.0, 0.3, phases_V(0.7, 0.3, current, 22.0));
}

static void test_a_current_loop_too_quick_for_the_sampling_is_refused(void)
{
    task.current_bandwidth_rad_s = 3500.0;
    TEST_ASSERT_FALSE(microstepping_law_design(&params, &task, error));
    TEST_ASSERT_EQUAL_STRING("current bandwidth 3500 rad/s: must be at most 3000 rad/s, "
                             "0.3 per control period",
                             error);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_given_voltage_lies_along_the_reference_whatever_the_estimate);
    RUN_TEST(test_a_voltage_beyond_the_bus_is_shortened_and_keeps_its_direction);
    RUN_TEST(test_without_a_voltage_the_current_is_controlled_to_its_limit);
    RUN_TEST(test_a_current_that_lies_along_the_reference_asks_for_no_change);
    RUN_TEST(test_a_current_loop_too_quick_for_the_sampling_is_refused);
    return UNITY_END();
}
