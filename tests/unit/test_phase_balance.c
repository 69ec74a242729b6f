/* The ratio of the two phases, found by a hold between them. */
#include "firmware/estimator/estimate.h"
#include "firmware/drive/phase_balance.h"

#include <string.h>

#include "firmware/drive/measurement.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

static const double hold_current_A = 1.5;

static struct per_unit base;
static struct phase_balance_params params;
static struct phase_balance balance;

/* The phases as they are and as they are measured. */
static struct {
    double resistance_a, resistance_b; /* ohm */
    double gain_a, gain_b;
    double offset_V;
    double current_A; /* of the hold */
    double noise_codes;
    uint32_t seed;
} world;

static angle_t final_angle;
static uint32_t taken; /* periods */

void setUp(void)
{
    const struct phase_balance_task task = {.base = &base,
                                            .motor = &bench_params,
                                            .period_s = PERIOD_S,
                                            .hold_current_A = hold_current_A};

    base = per_unit_base(&bench_params, PERIOD_S);
    params = phase_balance_design(&task);
    memset(&world, 0, sizeof world);
    world.resistance_a = world.resistance_b = 0.37;
    world.gain_a = world.gain_b = 1.0;
    world.current_A = hold_current_A;
    world.seed = 1;
    final_angle = 0;
}

void tearDown(void)
{
}

static double noise(double code)
{
    world.seed = world.seed * 1664525u + 1013904223u;
    return code * world.noise_codes * ((double)(world.seed >> 8) / 8388608.0 - 1.0);
}

static num_t measured(double value, double code, double in)
{
    return num_from_double(code * floor((value + noise(code)) / code + 0.5) / in);
}

/* What the converters make of the current that the hold has at this angle. */
static struct channels samples(void)
{
    const double angle =
        TWO_PI * (double)(angle_t)(final_angle + (angle_t)balance.held.offset) / 4294967296.0;
    const struct bench_vector i = bench_to_phases(world.current_A, 0.0, angle);
    const double A = bench_facts.current_A_per_code, V = bench_facts.phase_voltage_V_per_code;

    return (struct channels){
        .current = {measured(world.gain_a * i.a, A, base.current_A),
                    measured(world.gain_b * i.b, A, base.current_A)},
        .voltage = {measured(world.resistance_a * i.a + world.offset_V, V, base.voltage_V),
                    measured(world.resistance_b * i.b, V, base.voltage_V)},
    };
}

/* Until the phases have been compared, or to the end. */
static enum phase_balance_event run_to(enum phase_balance_event end)
{
    enum phase_balance_event event;

    do {
        const struct channels now = samples();

        event = phase_balance_step(&balance, &params, &now);
        taken++;
    } while (event != end && event != PHASES_TOO_DIFFERENT && event != PHASES_AT_FINAL);
    return event;
}

static enum phase_balance_event compare(void)
{
    taken = 0;
    phase_balance_start(&balance, final_angle);
    return run_to(PHASES_COMPARED);
}

/* Half the logarithm of the ratio of what the phases show as resistance, less what it has been
 * found to be. */
static double error_of(double imbalance)
{
    const double shown_a = world.resistance_a / world.gain_a;
    const double shown_b = world.resistance_b / world.gain_b;
    const double right = 0.5 * log(shown_a / shown_b);

    return imbalance - tanh(right);
}

/* Three standard deviations of the means: a code of uniform noise over the voltage's codes. */
static double noise_of_the_means(void)
{
    const double codes =
        world.resistance_b * world.current_A * sqrt(0.5) / bench_facts.phase_voltage_V_per_code;

    return 3.0 * sqrt(1.0 / 3.0 / (double)params.look) / codes;
}

static void finds_it(void)
{
    TEST_ASSERT_EQUAL(PHASES_COMPARED, compare());
    TEST_ASSERT_DOUBLE_WITHIN(noise_of_the_means(), 0.0,
                              error_of(num_to_double(balance.imbalance)));
}

static void test_phases_that_are_alike_have_no_imbalance(void)
{
    world.noise_codes = 1.0;
    finds_it();
}

static void test_a_difference_of_resistances_or_of_gains_is_found(void)
{
    world.noise_codes = 1.0;
    world.resistance_a = 0.39;
    finds_it();
    world.gain_a = 0.985;
    world.gain_b = 1.015;
    finds_it();
    world.resistance_b = 0.41;
    finds_it();
}

static void test_it_is_found_from_wherever_the_rotor_is_held(void)
{
    world.noise_codes = 1.0;
    world.gain_a = 1.02;
    for (uint32_t sixteenth = 0; sixteenth < 16; sixteenth++) {
        final_angle = sixteenth << 28 | 0x1234567u;
        finds_it();
    }
}

static void test_a_motor_of_little_resistance_and_one_of_much_are_compared_alike(void)
{
    world.noise_codes = 1.0;
    world.resistance_a = 10.4;
    world.resistance_b = 10.0;
    finds_it();
    world.resistance_a = 0.052;
    world.resistance_b = 0.050;
    finds_it();
}

static void test_scaled_by_it_both_phases_show_one_resistance(void)
{
    const struct measurement_params scales = measurement_design(&bench_facts, &base);
    struct measurement measurement;

    world.noise_codes = 1.0;
    world.resistance_a = 0.40;
    finds_it();
    measurement_reset(&measurement, &scales);
    measurement.offset.current.a = NUM(0.5);
    measurement.offset.current.b = NUM(-0.5);
    measurement_balance(&measurement, balance.imbalance);

    const double code_a = coef_to_double(measurement.current_a) / coef_to_double(scales.current);
    const double code_b = coef_to_double(measurement.current_b) / coef_to_double(scales.current);

    TEST_ASSERT_DOUBLE_WITHIN(2.0 * noise_of_the_means(), 0.40 / 0.37, code_a / code_b);
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, 1.0, code_a * code_b);
    TEST_ASSERT_NUM_WITHIN(1e-4, 0.5 * code_a, measurement.offset.current.a);
    TEST_ASSERT_NUM_WITHIN(1e-4, -0.5 * code_b, measurement.offset.current.b);
}

static void test_what_no_sound_board_shows_is_refused(void)
{
    world.noise_codes = 1.0;
    world.resistance_a = 0.37 * 1.14;
    TEST_ASSERT_EQUAL(PHASES_COMPARED, compare());
    world.resistance_a = 0.37 * 1.18;
    TEST_ASSERT_EQUAL(PHASES_TOO_DIFFERENT, compare());
    world.resistance_a = 0.37 / 1.18;
    TEST_ASSERT_EQUAL(PHASES_TOO_DIFFERENT, compare());
    world.resistance_a = -0.37;
    TEST_ASSERT_EQUAL(PHASES_TOO_DIFFERENT, compare());
}

static void test_a_phase_without_current_is_refused(void)
{
    world.gain_b = 0.1; /* and what follows the same, so that the ratio is right */
    world.resistance_b = 0.037;
    TEST_ASSERT_EQUAL(PHASES_TOO_DIFFERENT, compare());
    setUp();
    world.current_A = 0.0;
    TEST_ASSERT_EQUAL(PHASES_TOO_DIFFERENT, compare());
}

static void test_the_rotor_is_led_by_half_a_step_at_most_and_to_its_final_angle(void)
{
    int32_t furthest = 0;

    phase_balance_start(&balance, final_angle);
    while (balance.stage != PHASES_BALANCED) {
        const struct channels now = samples();

        (void)phase_balance_step(&balance, &params, &now);
        furthest = balance.held.offset > furthest ? balance.held.offset : furthest;
    }
    TEST_ASSERT_EQUAL_INT32(0x20000000, furthest);
    TEST_ASSERT_EQUAL_INT32(0, balance.held.offset);
    TEST_ASSERT_TRUE(phase_balance_speed(&balance, &params) == NUM(0.0));
    TEST_ASSERT_FALSE(phase_balance_leads(&balance));
}

static void test_it_takes_no_longer_than_it_says(void)
{
    for (uint32_t sixteenth = 0; sixteenth < 16; sixteenth++) {
        final_angle = sixteenth << 28;
        TEST_ASSERT_EQUAL(PHASES_COMPARED, compare());
        TEST_ASSERT_EQUAL(PHASES_AT_FINAL, run_to(PHASES_AT_FINAL));
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(phase_balance_periods(&params), taken);
    }
    TEST_ASSERT_LESS_THAN_UINT32(2500u, phase_balance_periods(&params)); /* 0.25 s */
}

/* Those of the sample and of the next one alike. */
static void test_estimated_currents_follow_the_balanced_sensors(void)
{
    struct estimate estimate = {.current = {NUM(0.5), NUM(0.25)},
                                .next = {.current = {NUM(-0.25), NUM(0.5)}}};

    estimate_balance_currents(&estimate, NUM(0.125));
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.5 * 1.125, estimate.current.a);
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.25 * 0.875, estimate.current.b);
    TEST_ASSERT_NUM_WITHIN(1e-6, -0.25 * 1.125, estimate.next.current.a);
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.5 * 0.875, estimate.next.current.b);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_estimated_currents_follow_the_balanced_sensors);
    RUN_TEST(test_phases_that_are_alike_have_no_imbalance);
    RUN_TEST(test_a_difference_of_resistances_or_of_gains_is_found);
    RUN_TEST(test_it_is_found_from_wherever_the_rotor_is_held);
    RUN_TEST(test_a_motor_of_little_resistance_and_one_of_much_are_compared_alike);
    RUN_TEST(test_scaled_by_it_both_phases_show_one_resistance);
    RUN_TEST(test_what_no_sound_board_shows_is_refused);
    RUN_TEST(test_a_phase_without_current_is_refused);
    RUN_TEST(test_the_rotor_is_led_by_half_a_step_at_most_and_to_its_final_angle);
    RUN_TEST(test_it_takes_no_longer_than_it_says);
    return UNITY_END();
}
