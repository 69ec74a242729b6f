/* From converter codes to per-unit, less the offsets. */
#include "firmware/drive/measurement.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

/* Per-unit. */
static const double current_per_code = 12.0 / 4096.0 / 6.0;
static const double voltage_per_code = 62.4 / 4096.0 / 24.0;

static struct per_unit base;
static struct measurement_params params;
static struct measurement measurement;

void setUp(void)
{
    base = per_unit_base(&bench_params, PERIOD_S);
    params = measurement_design(&bench_facts, &base);
    measurement_reset(&measurement, &params);
}

void tearDown(void)
{
}

static const struct hal_samples nothing_flows = {
    .current_a = 2048, .current_b = 2048, .bus_voltage = 3151};

static struct sample_set measured(const struct hal_samples *samples)
{
    return measurement_step(&measurement, &params, samples);
}

static void test_codes_become_currents_and_voltages(void)
{
    const struct hal_samples samples = {.current_a = 3048,
                                        .current_b = 1048,
                                        .bus_voltage = 3000,
                                        .phase_voltage_a = 1000,
                                        .phase_voltage_b = -2048};
    const struct sample_set now = measured(&samples);
    const double rounding = 2.0 * (NUM_ROUNDING + COEF_ROUNDING);

    TEST_ASSERT_NUM_WITHIN(rounding, 1000.0 * 12.0 / 4096.0 / 6.0, now.winding.current.a);
    TEST_ASSERT_NUM_WITHIN(rounding, -1000.0 * 12.0 / 4096.0 / 6.0, now.winding.current.b);
    TEST_ASSERT_NUM_WITHIN(rounding, 3000.0 * 31.2 / 4096.0 / 24.0, now.bus);
    TEST_ASSERT_NUM_WITHIN(rounding, 1000.0 * 62.4 / 4096.0 / 24.0, now.winding.voltage.a);
    TEST_ASSERT_NUM_WITHIN(rounding * 2.0, -1.3, now.winding.voltage.b);
}

static void test_the_ends_of_the_converters_are_measured_too(void)
{
    const struct hal_samples lowest = {.current_a = 0, .current_b = 4095, .bus_voltage = 4095};
    const struct sample_set now = measured(&lowest);

    TEST_ASSERT_NUM_WITHIN(1e-4, -1.0, now.winding.current.a);
    TEST_ASSERT_NUM_WITHIN(1e-4, 2047.0 / 2048.0, now.winding.current.b);
    TEST_ASSERT_NUM_WITHIN(1e-4, 4095.0 / 4096.0 * 1.3, now.bus);
}

static void test_an_offset_is_taken_off_every_sample(void)
{
    const struct hal_samples shifted = {.current_a = 2048 + 20,
                                        .current_b = 2048 - 10,
                                        .phase_voltage_a = 30,
                                        .phase_voltage_b = -40};

    measurement_set_offset(&measurement, (struct channels){
                                             .current = {num_from_double(20.0 * current_per_code),
                                                         num_from_double(-10.0 * current_per_code)},
                                             .voltage = {num_from_double(25.0 * voltage_per_code),
                                                         num_from_double(-30.0 * voltage_per_code)},
                                         });
    measurement_add_voltage_offset(&measurement,
                                   (struct phases){num_from_double(5.0 * voltage_per_code),
                                                   num_from_double(-10.0 * voltage_per_code)});
    const struct sample_set now = measured(&shifted);

    TEST_ASSERT_NUM_WITHIN(0.01 * current_per_code, 0.0, now.winding.current.a);
    TEST_ASSERT_NUM_WITHIN(0.01 * current_per_code, 0.0, now.winding.current.b);
    TEST_ASSERT_NUM_WITHIN(0.01 * voltage_per_code, 0.0, now.winding.voltage.a);
    TEST_ASSERT_NUM_WITHIN(0.01 * voltage_per_code, 0.0, now.winding.voltage.b);
}

static void test_without_calibration_nothing_is_taken_off(void)
{
    const struct sample_set now = measured(&nothing_flows);

    TEST_ASSERT_TRUE(now.winding.current.a == NUM(0.0));
    TEST_ASSERT_TRUE(now.winding.voltage.b == NUM(0.0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_codes_become_currents_and_voltages);
    RUN_TEST(test_the_ends_of_the_converters_are_measured_too);
    RUN_TEST(test_an_offset_is_taken_off_every_sample);
    RUN_TEST(test_without_calibration_nothing_is_taken_off);
    return UNITY_END();
}
