/* The offsets of the converters, with the bridge off and on. */
#include "firmware/drive/offset_calibration.h"

#include <string.h>

#include "tests/unit/bench.h"
#include "tests/unit/emulated.h"
#include "tests/unit/num_assert.h"

/* Per-unit. */
static const double current_per_code = 12.0 / 4096.0 / 6.0;
static const double voltage_per_code = 62.4 / 4096.0 / 24.0;

/* A small motor on the board of the bench: 20 ns of 24 V over 6.8 ohm are a quarter of a code. */
static const struct motor_params small_motor = {
    .resistance_ohm = 6.8, .torque_constant_Nm_A = 0.1, .supply_V = 24.0};

static struct per_unit base;
static struct measurement_params scales;
static struct offset_calibration_params params;
static struct offset_calibration calibration;
static struct channels offset;

/* What the channels read in codes: currents, voltages; with the bridge on as much more. */
static struct {
    double off[OFFSET_CHANNELS], more_on[OFFSET_CHANNELS];
    double noise_codes;
    double turning_codes, electrical_rad_s; /* current of a rotor that is turned, bridge on */
    uint32_t seed;
} world;

void setUp(void)
{
    base = per_unit_base(&bench_params, PERIOD_S);
    scales = measurement_design(&bench_facts, &base);
    params = offset_calibration_design(&bench_facts, &small_motor, &base);
    memset(&world, 0, sizeof world);
    world.seed = 1;
}

void tearDown(void)
{
}

/* Sum of twelve uniform numbers less six: nearly Gaussian, 1 rms. */
static double noise(void)
{
    double sum = -6.0;

    for (int i = 0; i < 12; i++) {
        world.seed = world.seed * 1664525u + 1013904223u;
        sum += (double)(world.seed >> 8) / 16777216.0;
    }
    return world.noise_codes * sum;
}

/* Rounded to nearest. */
static int32_t code_of(double x)
{
    return (int32_t)(x + 4096.5) - 4096;
}

static int32_t code(int channel, double current)
{
    const double more = calibration.bridge_on ? world.more_on[channel] + current : 0.0;

    return code_of(world.off[channel] + more + noise());
}

static struct hal_samples sampled(int period)
{
    const double angle = world.electrical_rad_s * PERIOD_S * period;

    return (struct hal_samples){
        .current_a = (uint16_t)(2048 + code(0, world.turning_codes * sin(angle))),
        .current_b = (uint16_t)(2048 + code(1, world.turning_codes * cos(angle))),
        .phase_voltage_a = (int16_t)code(2, 0.0),
        .phase_voltage_b = (int16_t)code(3, 0.0),
    };
}

static int periods;

static enum offset_result calibrate(void)
{
    enum offset_result result = OFFSETS_PENDING;

    offset_calibration_reset(&calibration);
    for (periods = 0; result == OFFSETS_PENDING; periods++) {
        const struct hal_samples samples = sampled(periods);

        TEST_ASSERT_FALSE(offset_calibration_is_done(&calibration));
        result = offset_calibration_step(&calibration, &params, &scales, &samples, &offset);
    }
    if (result == OFFSETS_FOUND) { /* and a period behind that it is done */
        TEST_ASSERT_TRUE(offset_calibration_is_done(&calibration));
        periods++;
    }
    return result;
}

/* Error of what has been found against the codes given, currents and voltages. */
static void found(double a, double b, double voltage_a, double voltage_b, double tolerance_codes)
{
    TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate());
    TEST_ASSERT_EQUAL_INT(OFFSET_PERIODS, periods);
    TEST_ASSERT_NUM_WITHIN(tolerance_codes * current_per_code, a * current_per_code,
                           offset.current.a);
    TEST_ASSERT_NUM_WITHIN(tolerance_codes * current_per_code, b * current_per_code,
                           offset.current.b);
    TEST_ASSERT_NUM_WITHIN(tolerance_codes * voltage_per_code, voltage_a * voltage_per_code,
                           offset.voltage.a);
    TEST_ASSERT_NUM_WITHIN(tolerance_codes * voltage_per_code, voltage_b * voltage_per_code,
                           offset.voltage.b);
}

static void offsets(double a, double b, double voltage_a, double voltage_b)
{
    world.off[0] = a;
    world.off[1] = b;
    world.off[2] = voltage_a;
    world.off[3] = voltage_b;
}

static void switching_shifts(double a, double b, double voltage_a, double voltage_b)
{
    world.more_on[0] = a;
    world.more_on[1] = b;
    world.more_on[2] = voltage_a;
    world.more_on[3] = voltage_b;
}

static double square(double x)
{
    return x * x;
}

/* u - R i of what the second stage has read, in codes of the voltage. */
static double back_emf_left(const struct motor_params *motor, double current_codes,
                            double voltage_codes, num_t current, num_t voltage)
{
    const double i = current_codes - num_to_double(current) / current_per_code;
    const double u = voltage_codes - num_to_double(voltage) / voltage_per_code;

    return u - i * motor->resistance_ohm * 12.0 / 62.4;
}

/* 512 samples: 1/22.6 of the noise and the quantisation of a sample. */
static void test_offsets_are_found_to_a_twentieth_of_the_noise(void)
{
    const double sample_noise = sqrt(1.0 + 1.0 / 12.0);
    const int calibrations = 25;
    double sum_of_squares = 0.0;

    params = offset_calibration_design(&bench_facts, &bench_params, &base);
    offsets(12.37, -8.81, 3.14, -30.59);
    world.noise_codes = 1.0;
    for (int i = 0; i < calibrations; i++) {
        TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate());
        sum_of_squares += square(num_to_double(offset.current.a) / current_per_code - 12.37);
        sum_of_squares += square(num_to_double(offset.current.b) / current_per_code + 8.81);
        sum_of_squares += square(num_to_double(offset.voltage.a) / voltage_per_code - 3.14);
        sum_of_squares += square(num_to_double(offset.voltage.b) / voltage_per_code + 30.59);
    }
    TEST_ASSERT_TRUE(sqrt(sum_of_squares / (4.0 * calibrations)) < sample_noise / 20.0);
}

/* Plant `real`: +3 and -2 codes, 5 mV; leg dividers that differ by 1 % make 120 mV, 8 codes. */
static void test_what_the_switching_adds_is_found_with_the_bridge_on(void)
{
    offsets(12.0, -9.0, 3.0, -30.0);
    switching_shifts(3.0, -2.0, 8.0, -8.0);
    found(15.0, -11.0, 11.0, -38.0, 0.01);
}

/* 20 ns of 24 V over 0.37 ohm are 13 mA, 4.4 codes, which may be real currents; then the voltage
   at the winding is as real. */
static void test_a_current_that_delays_between_legs_explain_is_no_offset(void)
{
    const double drop_codes = 4.0 * 0.37 * bench_facts.current_A_per_code * 4096.0 / 62.4;

    params = offset_calibration_design(&bench_facts, &bench_params, &base);
    offsets(12.0, -9.0, 3.0, -30.0);
    switching_shifts(4.0, -5.0, 8.0, -8.0);
    found(12.0, -14.0, 11.0 - drop_codes, -38.0, 0.01);
}

static void test_offset_or_delay_nothing_is_left_that_looks_like_back_emf(void)
{
    params = offset_calibration_design(&bench_facts, &bench_params, &base);
    for (int shift = -10; shift <= 10; shift++) {
        switching_shifts(shift, 2 * shift, 8.0, -2.0 * shift);
        TEST_ASSERT_EQUAL(shift > -9 && shift < 9 ? OFFSETS_FOUND : OFFSETS_OUT_OF_RANGE,
                          calibrate());
        if (shift > -9 && shift < 9) {
            TEST_ASSERT_DOUBLE_WITHIN(
                0.01, 0.0,
                back_emf_left(&bench_params, shift, 8.0, offset.current.a, offset.voltage.a));
            TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.0,
                                      back_emf_left(&bench_params, 2 * shift, -2.0 * shift,
                                                    offset.current.b, offset.voltage.b));
        }
    }
}

/* A code of current is 1.31 codes of voltage: the noise of one stage, not of both. */
static void test_a_large_resistance_leaves_no_more_than_the_noise_of_both_sensors(void)
{
    const double drop_codes = small_motor.resistance_ohm * 12.0 / 62.4;
    const double sample_noise = sqrt((1.0 + 1.0 / 12.0) * (1.0 + square(drop_codes)));
    const int calibrations = EMULATED ? 60 : 100;
    double sum_of_squares = 0.0;

    offsets(12.37, -8.81, 3.14, -30.59);
    world.noise_codes = 1.0;
    for (int i = 0; i < calibrations; i++) {
        TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate());
        sum_of_squares +=
            square(back_emf_left(&small_motor, 12.37, 3.14, offset.current.a, offset.voltage.a));
        sum_of_squares +=
            square(back_emf_left(&small_motor, -8.81, -30.59, offset.current.b, offset.voltage.b));
    }
    TEST_ASSERT_TRUE(sqrt(sum_of_squares / (2.0 * calibrations)) < sample_noise / 20.0);
}

/* 60 ns make 13.3 codes: as much may flow beside the 12 codes of an amplifier. */
static void test_what_delays_make_is_no_rotor_that_turns(void)
{
    struct hal_facts slow_drivers = bench_facts;

    slow_drivers.leg_delay_s = 60e-9;
    params = offset_calibration_design(&slow_drivers, &bench_params, &base);
    switching_shifts(13.0, 25.0, 0.0, 0.0);
    found(0.0, 25.0, -13.0 * 0.37 * 12.0 / 62.4, 0.0, 0.01);
    switching_shifts(13.0, 26.0, 0.0, 0.0);
    TEST_ASSERT_EQUAL(OFFSETS_OUT_OF_RANGE, calibrate());
}

static void test_the_back_emf_of_a_rotor_that_turns_with_the_bridge_off_is_no_offset(void)
{
    offsets(0.0, 0.0, 20.0, -15.0);
    switching_shifts(0.0, 0.0, -20.0, 15.0);
    found(0.0, 0.0, 0.0, 0.0, 0.01);
}

/* Some channel reads that much, with the bridge off and on. */
static enum offset_result calibrate_channel(int channel, double codes)
{
    offsets(0.0, 0.0, 0.0, 0.0);
    world.off[channel] = codes;
    return calibrate();
}

static void test_an_offset_too_large_to_be_one_is_a_fault(void)
{
    for (int channel = 0; channel < OFFSET_CHANNELS; channel++) {
        TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate_channel(channel, OFFSET_CODES_MAX));
        TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate_channel(channel, -OFFSET_CODES_MAX));
        TEST_ASSERT_EQUAL(OFFSETS_OUT_OF_RANGE, calibrate_channel(channel, OFFSET_CODES_MAX + 1));
        TEST_ASSERT_EQUAL(OFFSETS_OUT_OF_RANGE, calibrate_channel(channel, -OFFSET_CODES_MAX - 1));
        TEST_ASSERT_EQUAL(OFFSETS_OUT_OF_RANGE, calibrate_channel(channel, 2047));
        TEST_ASSERT_EQUAL_INT(OFFSET_SAMPLES, periods);
    }
}

/* A user sees which sensor it is, and by how much: within half a code, up to the end of its range.
 */
static void test_what_is_too_large_is_shown(void)
{
    const double current_per_code = 12.0 / 4096.0 / 6.0, voltage_per_code = 62.4 / 4096.0 / 24.0;

    TEST_ASSERT_EQUAL(OFFSETS_OUT_OF_RANGE, calibrate_channel(1, 2047));
    TEST_ASSERT_NUM_WITHIN(0.5 * current_per_code, 2047 * current_per_code, offset.current.b);
    TEST_ASSERT_NUM_WITHIN(0.5 * current_per_code, 0.0, offset.current.a);
    TEST_ASSERT_EQUAL(OFFSETS_OUT_OF_RANGE, calibrate_channel(2, -1500));
    TEST_ASSERT_NUM_WITHIN(0.5 * voltage_per_code, -1500 * voltage_per_code, offset.voltage.a);
}

/* A voltage of 60 codes with the bridge off, 65 with it on. */
static void test_an_offset_that_only_switching_makes_too_large_is_a_fault(void)
{
    for (int channel = 0; channel < OFFSET_CHANNELS; channel++) {
        memset(world.more_on, 0, sizeof world.more_on);
        world.more_on[channel] = 5.0;
        TEST_ASSERT_EQUAL(OFFSETS_OUT_OF_RANGE, calibrate_channel(channel, 60.0));
        TEST_ASSERT_EQUAL_INT(OFFSET_PERIODS - 1, periods);
    }
}

/* The largest offset is 64 codes: 0.19 A and 1 V. It must not leave the number range on the way. */
static void test_the_largest_offset_is_found_to_its_full_size(void)
{
    TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate_channel(2, OFFSET_CODES_MAX));
    TEST_ASSERT_NUM_WITHIN(1e-5, 64.0 * 62.4 / 4096.0 / 24.0, offset.voltage.a);
    TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate_channel(0, -OFFSET_CODES_MAX));
    TEST_ASSERT_NUM_WITHIN(1e-5, -64.0 * 12.0 / 4096.0 / 6.0, offset.current.a);
}

/* The bench's motor makes 2.9 codes for each electrical rad/s, the small one 0.1. Slow ones are
   noticed by what they add, fast ones by how it changes. */
static void test_a_rotor_that_is_turned_is_noticed_by_its_currents(void)
{
    static const struct {
        double electrical_rad_s, codes;
    } turned[] = {{0.0, 13.0}, {5.0, 14.5},   {20.0, 58.0},
                  {50.0, 5.0}, {160.0, 16.0}, {1000.0, 100.0}};

    world.noise_codes = 1.0;
    for (size_t i = 0; i < sizeof turned / sizeof turned[0]; i++) {
        world.electrical_rad_s = turned[i].electrical_rad_s;
        world.turning_codes = turned[i].codes;
        TEST_ASSERT_EQUAL(OFFSETS_OUT_OF_RANGE, calibrate());
    }
}

/* 1 code of bench_facts is 3 mA; the same noise on a range of 0.9 A is 7 codes. */
static void test_noise_alone_is_no_rotor_that_turns(void)
{
    for (int i = 0; i < (EMULATED ? 40 : 400); i++) {
        world.noise_codes = i % 2 == 0 ? 1.0 : 7.0;
        TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate());
    }
}

/* 16 bits: sixteen codes where the real ones have one. */
static void test_finer_converters_have_as_many_more_codes(void)
{
    struct hal_facts fine = bench_facts;

    fine.converter_codes = 65536;
    fine.current_A_per_code /= 16.0;
    params = offset_calibration_design(&fine, &small_motor, &base);
    switching_shifts(30.0, 0.0, 0.0, 0.0);
    TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate());
    offsets(0.0, OFFSET_CODES_MAX * 16.0, 0.0, 0.0);
    TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate());
    offsets(0.0, OFFSET_CODES_MAX * 16.0 + 1.0, 0.0, 0.0);
    TEST_ASSERT_EQUAL(OFFSETS_OUT_OF_RANGE, calibrate());
    offsets(0.0, 0.0, 0.0, 0.0);
    params = offset_calibration_design(&bench_facts, &small_motor, &base);
    TEST_ASSERT_EQUAL(OFFSETS_OUT_OF_RANGE, calibrate());
}

/* Of one code more in each sample. The largest that passes is the whole number below the limit. */
static void test_a_shift_passes_up_to_its_limit_and_not_beyond(void)
{
    for (int channel = 0; channel < 2; channel++) {
        setUp();
        const int limit = params.shift_max / OFFSET_SAMPLES;

        world.more_on[channel] = limit;
        TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate());
        params.shift_max = limit * OFFSET_SAMPLES;
        TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate());
        world.more_on[channel] = -limit;
        TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate());
        params.shift_max -= 1;
        TEST_ASSERT_EQUAL(OFFSETS_OUT_OF_RANGE, calibrate());
    }
}

static void test_what_settles_takes_as_long_at_any_rate(void)
{
    struct hal_facts faster = bench_facts;

    faster.control_period_s = PERIOD_S / 2.0;
    params = offset_calibration_design(&faster, &small_motor, &base);
    TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate());
    TEST_ASSERT_EQUAL_INT(OFFSET_PERIODS + 200, periods);
}

/* Of seeds and places between two codes, how many times channel 0 and 1 are called noisy. */
static int called_noisy(double noise_codes)
{
    int times = 0;

    world.noise_codes = noise_codes;
    for (int n = 0; n < 40; n++) {
        world.seed = (uint32_t)n + 1u;
        offsets(0.05 * n - 1.0, 1.5 - 0.05 * n, 0.0, 0.0);
        TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate());
        times += (calibration.noisy & 1) + (calibration.noisy >> 1 & 1);
    }
    return times;
}

/* Of one within which a code may well stand for 112 looks none, wherever it lies. */
static void test_a_current_whose_codes_scatter_is_noisy(void)
{
    TEST_ASSERT_EQUAL_INT(80, called_noisy(1.1));
    TEST_ASSERT_EQUAL_INT(80, called_noisy(0.8));
    TEST_ASSERT_EQUAL_INT(0, called_noisy(0.45));
    TEST_ASSERT_EQUAL_INT(0, called_noisy(0.3));
    TEST_ASSERT_EQUAL_INT(0, called_noisy(0.0));
    world.noise_codes = 0.1;
    world.turning_codes = 1.35; /* a current in stage 2 is no noise */
    world.electrical_rad_s = 300.0;
    TEST_ASSERT_EQUAL(OFFSETS_FOUND, calibrate());
    TEST_ASSERT_EQUAL_UINT8(0, calibration.noisy);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_offsets_are_found_to_a_twentieth_of_the_noise);
    RUN_TEST(test_what_the_switching_adds_is_found_with_the_bridge_on);
    RUN_TEST(test_a_current_that_delays_between_legs_explain_is_no_offset);
    RUN_TEST(test_offset_or_delay_nothing_is_left_that_looks_like_back_emf);
    RUN_TEST(test_a_large_resistance_leaves_no_more_than_the_noise_of_both_sensors);
    RUN_TEST(test_what_delays_make_is_no_rotor_that_turns);
    RUN_TEST(test_the_back_emf_of_a_rotor_that_turns_with_the_bridge_off_is_no_offset);
    RUN_TEST(test_an_offset_too_large_to_be_one_is_a_fault);
    RUN_TEST(test_what_is_too_large_is_shown);
    RUN_TEST(test_an_offset_that_only_switching_makes_too_large_is_a_fault);
    RUN_TEST(test_the_largest_offset_is_found_to_its_full_size);
    RUN_TEST(test_a_rotor_that_is_turned_is_noticed_by_its_currents);
    RUN_TEST(test_noise_alone_is_no_rotor_that_turns);
    RUN_TEST(test_finer_converters_have_as_many_more_codes);
    RUN_TEST(test_a_shift_passes_up_to_its_limit_and_not_beyond);
    RUN_TEST(test_what_settles_takes_as_long_at_any_rate);
    RUN_TEST(test_a_current_whose_codes_scatter_is_noisy);
    return UNITY_END();
}
