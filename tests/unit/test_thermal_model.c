/* The winding's heat beside the closed formula, and the code of an NTC beside a data sheet's table.
 */
#include "firmware/drive/thermal_model.h"

#include <math.h>
#include <unity.h>

#include "tests/unit/num_assert.h"

#define SPAN_S (num_real)25.6e-3

static struct winding_heat winding;

void setUp(void)
{
    winding = (struct winding_heat){.looks = 0};
}

void tearDown(void)
{
}

/* A span of these currents, in rated ones. */
static void pass(double a, double b, num_real time_constant_s)
{
    const struct phases current = {num_from_double(0.5 * a), num_from_double(0.5 * b)};

    for (int look = 0; look < WINDING_LOOKS; look++) {
        winding_heat_look(&winding, current);
    }
    winding_heat_pass(&winding, SPAN_S, time_constant_s);
}

static double heat_of(int phase)
{
    return num_to_double(winding.phase[phase]);
}

/* From cold to this heat, by this current in phase b alone. */
static double seconds_until(double heat, double current, num_real time_constant_s)
{
    double time_s = 0.0;

    setUp();
    while (heat_of(1) < heat && time_s < 100.0 * (double)time_constant_s) {
        pass(0.0, current, time_constant_s);
        time_s += (double)SPAN_S;
    }
    TEST_ASSERT_TRUE(heat_of(0) < 1e-6);
    return time_s;
}

static void test_an_overload_comes_to_rated_heat_as_the_closed_formula_says(void)
{
    static const double overloads[] = {1.1, 1.2, 1.5, 2.0, 3.0};
    static const num_real constants[] = {(num_real)5.0, (num_real)60.0, (num_real)600.0};

    for (int c = 0; c < 3; c++) {
        for (int i = 0; i < 5; i++) {
            const double k2 = overloads[i] * overloads[i];
            const double expected_s = (double)constants[c] * log(k2 / (k2 - 1.0));

            TEST_ASSERT_DOUBLE_WITHIN(0.01 * expected_s + 2.0 * (double)SPAN_S, expected_s,
                                      seconds_until(1.0, overloads[i], constants[c]));
        }
    }
}

static void test_rated_current_never_makes_more_than_rated_heat_of_either_phase(void)
{
    for (int n = 0; n < 4000; n++) {
        pass(1.0, -1.0, (num_real)5.0);
        TEST_ASSERT_TRUE(heat_of(0) < 1.001 && heat_of(1) < 1.001);
    }
    TEST_ASSERT_TRUE(heat_of(0) > 0.999 && heat_of(1) > 0.999);
}

static void test_without_current_it_cools_by_the_time_constant(void)
{
    while (heat_of(0) < 1.0) {
        pass(2.0, 0.0, (num_real)5.0);
    }
    const double begin = heat_of(0);

    for (int n = 0; n < 195; n++) { /* 4.99 s */
        pass(0.0, 0.0, (num_real)5.0);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.01, begin * exp(-1.0), heat_of(0));
}

/* The background was busy with something else. */
static void test_what_was_not_looked_at_changes_nothing(void)
{
    pass(2.0, 2.0, (num_real)5.0);
    const double begin = heat_of(0);

    winding_heat_pass(&winding, SPAN_S, (num_real)5.0);
    TEST_ASSERT_TRUE(heat_of(0) == begin);
}

static void test_half_the_looks_are_half_the_span(void)
{
    const struct phases current = {NUM(0.6), NUM(0.0)};

    for (int n = 0; n < 100; n++) {
        pass(1.5, 0.0, (num_real)5.0);
    }
    const double begin = heat_of(0);
    struct winding_heat whole = winding;

    for (int look = 0; look < WINDING_LOOKS; look++) {
        winding_heat_look(&whole, current);
        if (look % 2 == 0) {
            winding_heat_look(&winding, current);
        }
    }
    winding_heat_pass(&whole, SPAN_S, (num_real)5.0);
    winding_heat_pass(&winding, SPAN_S, (num_real)5.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5 * (num_to_double(whole.phase[0]) - begin),
                              heat_of(0) - begin);
}

static void test_copper_that_has_risen_by_40_K_begins_at_half_the_rated_heat(void)
{
    winding_heat_begin(&winding, (num_real)1.0 + (num_real)0.00393 * (num_real)40.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.5, heat_of(0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.5, heat_of(1));
}

/* A cold winding behind a hot one is a wrong cold resistance; so is one that is far too hot. */
static void test_a_resistance_takes_no_heat_away_and_never_derates_by_itself(void)
{
    winding_heat_begin(&winding, (num_real)1.2);
    const double begin = heat_of(0);

    winding_heat_begin(&winding, (num_real)0.9);
    TEST_ASSERT_TRUE(heat_of(0) == begin);
    winding_heat_begin(&winding, (num_real)400.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, heat_of(0));
}

/* 10 kOhm, B 3435 K: the resistances of its table. */
static void test_the_code_is_that_of_the_ntc_in_its_divider(void)
{
    static const struct {
        num_real bridge_C;
        double resistance_kohm;
    } table[] = {{(num_real)0.0, 28.71},
                 {(num_real)25.0, 10.0},
                 {(num_real)50.0, 4.103},
                 {(num_real)80.0, 1.665},
                 {(num_real)100.0, 0.987}};

    for (int i = 0; i < 5; i++) {
        const double share = table[i].resistance_kohm / (10.0 + table[i].resistance_kohm);

        TEST_ASSERT_DOUBLE_WITHIN(
            6.0, 4096.0 * share,
            (double)bridge_temperature_code(table[i].bridge_C, (num_real)3435.0, 4096u));
    }
}

static void test_a_shorted_and_an_open_sensor_are_no_temperature(void)
{
    TEST_ASSERT_TRUE(bridge_temperature_is_implausible(0u, 4096u));
    TEST_ASSERT_TRUE(bridge_temperature_is_implausible(4095u, 4096u));
    for (int bridge_C = -50; bridge_C <= 180; bridge_C++) {
        TEST_ASSERT_FALSE(bridge_temperature_is_implausible(
            bridge_temperature_code((num_real)bridge_C, (num_real)3435.0, 4096u), 4096u));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_an_overload_comes_to_rated_heat_as_the_closed_formula_says);
    RUN_TEST(test_rated_current_never_makes_more_than_rated_heat_of_either_phase);
    RUN_TEST(test_without_current_it_cools_by_the_time_constant);
    RUN_TEST(test_what_was_not_looked_at_changes_nothing);
    RUN_TEST(test_half_the_looks_are_half_the_span);
    RUN_TEST(test_copper_that_has_risen_by_40_K_begins_at_half_the_rated_heat);
    RUN_TEST(test_a_resistance_takes_no_heat_away_and_never_derates_by_itself);
    RUN_TEST(test_the_code_is_that_of_the_ntc_in_its_divider);
    RUN_TEST(test_a_shorted_and_an_open_sensor_are_no_temperature);
    return UNITY_END();
}
