/* From converter codes to per-unit, and the offsets found while enabling. */
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
    measurement_reset(&measurement);
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

/* Sum of twelve uniform numbers less six: nearly Gaussian, 1 rms. */
static double noise(uint32_t *seed)
{
    double sum = -6.0;

    for (int i = 0; i < 12; i++) {
        *seed = *seed * 1664525u + 1013904223u;
        sum += (double)(*seed >> 8) / 16777216.0;
    }
    return sum;
}

static int32_t code(double x)
{
    return (int32_t)(x + 4096.5) - 4096;
}

/* Offsets, in codes, that are no whole number of them. */
static const double offset[] = {12.37, -8.81, 3.14, -30.59};

static struct hal_samples noisy(uint32_t *seed)
{
    return (struct hal_samples){
        .current_a = (uint16_t)code(2048.0 + offset[0] + noise(seed)),
        .current_b = (uint16_t)code(2048.0 + offset[1] + noise(seed)),
        .phase_voltage_a = (int16_t)code(offset[2] + noise(seed)),
        .phase_voltage_b = (int16_t)code(offset[3] + noise(seed)),
    };
}

static enum offset_calibration calibrate_noisy(uint32_t *seed)
{
    enum offset_calibration result = OFFSETS_PENDING;

    measurement_reset(&measurement);
    while (result == OFFSETS_PENDING) {
        const struct hal_samples samples = noisy(seed);

        result = measurement_calibrate(&measurement, &params, &samples);
    }
    return result;
}

static double square(double x)
{
    return x * x;
}

/* 512 samples: 1/22.6 of the noise and the quantisation of a sample. */
static void test_offsets_are_removed_to_a_twentieth_of_the_noise(void)
{
    const double sample_noise = sqrt(1.0 + 1.0 / 12.0);
    const int calibrations = 25;
    double sum_of_squares = 0.0;
    uint32_t seed = 1;

    for (int i = 0; i < calibrations; i++) {
        TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate_noisy(&seed));
        const struct channels *found = &measurement.offset;

        sum_of_squares += square(num_to_double(found->current.a) / current_per_code - offset[0]);
        sum_of_squares += square(num_to_double(found->current.b) / current_per_code - offset[1]);
        sum_of_squares += square(num_to_double(found->voltage.a) / voltage_per_code - offset[2]);
        sum_of_squares += square(num_to_double(found->voltage.b) / voltage_per_code - offset[3]);
    }
    TEST_ASSERT_TRUE(sqrt(sum_of_squares / (4.0 * calibrations)) < sample_noise / 20.0);
}

static void test_what_has_been_found_is_taken_off_every_sample(void)
{
    const struct hal_samples shifted = {.current_a = 2048 + 20,
                                        .current_b = 2048 - 10,
                                        .phase_voltage_a = 30,
                                        .phase_voltage_b = -40};

    for (int i = 1; i < OFFSET_SAMPLES; i++) {
        TEST_ASSERT_EQUAL(OFFSETS_PENDING, measurement_calibrate(&measurement, &params, &shifted));
    }
    TEST_ASSERT_EQUAL(OFFSETS_FOUND, measurement_calibrate(&measurement, &params, &shifted));

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

/* `codes` off on one of the four channels. */
static enum offset_calibration calibrate_channel(int channel, int codes)
{
    struct hal_samples samples = nothing_flows;
    enum offset_calibration result = OFFSETS_PENDING;

    samples.current_a = (uint16_t)(2048 + (channel == 0 ? codes : 0));
    samples.current_b = (uint16_t)(2048 + (channel == 1 ? codes : 0));
    samples.phase_voltage_a = (int16_t)(channel == 2 ? codes : 0);
    samples.phase_voltage_b = (int16_t)(channel == 3 ? codes : 0);
    measurement_reset(&measurement);
    while (result == OFFSETS_PENDING) {
        result = measurement_calibrate(&measurement, &params, &samples);
    }
    return result;
}

static void test_an_offset_too_large_to_be_one_is_a_fault(void)
{
    for (int channel = 0; channel < 4; channel++) {
        TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate_channel(channel, OFFSET_CODES_MAX));
        TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate_channel(channel, -OFFSET_CODES_MAX));
        TEST_ASSERT_EQUAL(OFFSETS_OUT_OF_RANGE, calibrate_channel(channel, OFFSET_CODES_MAX + 1));
        TEST_ASSERT_EQUAL(OFFSETS_OUT_OF_RANGE, calibrate_channel(channel, -OFFSET_CODES_MAX - 1));
        TEST_ASSERT_EQUAL(OFFSETS_OUT_OF_RANGE, calibrate_channel(channel, 2047));
    }
}

/* The largest offset is 64 codes: 0.19 A and 1 V. It must not leave the number range on the way. */
static void test_the_largest_offset_is_found_to_its_full_size(void)
{
    TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate_channel(2, OFFSET_CODES_MAX));
    TEST_ASSERT_NUM_WITHIN(1e-5, 64.0 * 62.4 / 4096.0 / 24.0, measurement.offset.voltage.a);
    TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate_channel(0, -OFFSET_CODES_MAX));
    TEST_ASSERT_NUM_WITHIN(1e-5, -64.0 * 12.0 / 4096.0 / 6.0, measurement.offset.current.a);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_codes_become_currents_and_voltages);
    RUN_TEST(test_the_ends_of_the_converters_are_measured_too);
    RUN_TEST(test_offsets_are_removed_to_a_twentieth_of_the_noise);
    RUN_TEST(test_what_has_been_found_is_taken_off_every_sample);
    RUN_TEST(test_without_calibration_nothing_is_taken_off);
    RUN_TEST(test_an_offset_too_large_to_be_one_is_a_fault);
    RUN_TEST(test_the_largest_offset_is_found_to_its_full_size);
    return UNITY_END();
}
