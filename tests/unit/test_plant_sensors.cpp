/* The sensors: codes, saturation, and noise that is Gaussian, independent and repeatable. */
#include <unity.h>

#include "sil/plant/gaussian.h"
#include "sil/plant/sensors.h"
#include "tests/unit/plant_bench.h"

void setUp()
{
}

void tearDown()
{
}

namespace
{

constexpr int draws = 200000;

plant::Samples sampled(const plant::SensorConfig &config, double i_a_A, double u_a_V, double bus_V)
{
    return plant::Sensors(config, 1).sample(
        7, {plant::Phases{i_a_A, 0.0}, plant::Phases{u_a_V, 0.0}, bus_V, 0.0, false});
}

plant::SensorConfig noiseless()
{
    plant::SensorConfig config;
    config.current_noise_rms_A = 0.0;
    config.phase_voltage_noise_rms_V = 0.0;
    return config;
}

/* Twelve bits. */
plant::Samples codes(double i_a_A, double u_a_V, double bus_V)
{
    return sampled(noiseless(), i_a_A, u_a_V, bus_V);
}

void test_zero_is_the_middle_code()
{
    const plant::Samples samples = codes(0.0, 0.0, 0.0);
    TEST_ASSERT_EQUAL_UINT16(2048, samples.current_a);
    TEST_ASSERT_EQUAL_UINT16(2048, samples.current_b);
    TEST_ASSERT_EQUAL_INT16(0, samples.phase_voltage_a);
    TEST_ASSERT_EQUAL_UINT16(0, samples.bus_voltage);
}

void test_codes_are_rounded_to_the_nearest()
{
    const double current_lsb_A = 12.0 / 4096.0;
    const double voltage_lsb_V = 62.4 / 4096.0;
    TEST_ASSERT_EQUAL_UINT16(2048 + 341, codes(341.49 * current_lsb_A, 0.0, 24.0).current_a);
    TEST_ASSERT_EQUAL_UINT16(2048 + 342, codes(341.51 * current_lsb_A, 0.0, 24.0).current_a);
    TEST_ASSERT_EQUAL_UINT16(2048 - 341, codes(-341.49 * current_lsb_A, 0.0, 24.0).current_a);
    TEST_ASSERT_EQUAL_INT16(-100, codes(0.0, -100.4 * voltage_lsb_V, 24.0).phase_voltage_a);
    TEST_ASSERT_EQUAL_UINT16(3151, codes(0.0, 0.0, 24.0).bus_voltage); /* 24 / 31.2 x 4096 */
}

void test_codes_clamp_at_the_ends_of_their_range()
{
    TEST_ASSERT_EQUAL_UINT16(4095, codes(6.0, 0.0, 24.0).current_a);
    TEST_ASSERT_EQUAL_UINT16(4095, codes(1e300, 0.0, 24.0).current_a);
    TEST_ASSERT_EQUAL_UINT16(0, codes(-6.1, 0.0, 24.0).current_a);
    TEST_ASSERT_EQUAL_INT16(2047, codes(0.0, 40.0, 24.0).phase_voltage_a);
    TEST_ASSERT_EQUAL_INT16(-2048, codes(0.0, -40.0, 24.0).phase_voltage_a);
    TEST_ASSERT_EQUAL_UINT16(4095, codes(0.0, 0.0, 50.0).bus_voltage);
}

void test_exact_codes_have_sixteen_bits_and_no_noise()
{
    plant::SensorConfig config;
    config.exact = true;
    TEST_ASSERT_EQUAL_INT(32768, plant::current_zero_code(config));
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 12.0 / 65536.0, plant::current_A_per_code(config));
    const plant::Samples samples =
        sampled(config, 1000.4 * 12.0 / 65536.0, -2000.4 * 62.4 / 65536.0, 24.0);
    TEST_ASSERT_EQUAL_UINT16(32768 + 1000, samples.current_a);
    TEST_ASSERT_EQUAL_UINT16(32768, samples.current_b);
    TEST_ASSERT_EQUAL_INT16(-2000, samples.phase_voltage_a);
    TEST_ASSERT_EQUAL_UINT16(50412, samples.bus_voltage); /* 24 / 31.2 x 65536 */
    const plant::Samples ends = sampled(config, 6.0, -40.0, 40.0);
    TEST_ASSERT_EQUAL_UINT16(65535, ends.current_a);
    TEST_ASSERT_EQUAL_INT16(-32768, ends.phase_voltage_a);
    TEST_ASSERT_EQUAL_UINT16(65535, ends.bus_voltage);
}

std::int32_t count_at(const plant::SensorConfig &config, double theta_rad)
{
    return plant::Sensors(config, 1)
        .sample(0, {plant::Phases(), plant::Phases(), 24.0, theta_rad, false})
        .encoder_count;
}

void test_an_encoder_counts_whole_steps_from_angle_zero()
{
    plant::SensorConfig config;
    TEST_ASSERT_EQUAL_INT32(0, count_at(config, 1.0)); /* none fitted */
    config.encoder_counts_per_turn = 16384;
    const double count_rad = 2.0 * bench::pi / 16384;
    TEST_ASSERT_EQUAL_INT32(0, count_at(config, 0.0));
    TEST_ASSERT_EQUAL_INT32(0, count_at(config, 0.999 * count_rad));
    TEST_ASSERT_EQUAL_INT32(1, count_at(config, 1.001 * count_rad));
    TEST_ASSERT_EQUAL_INT32(-1, count_at(config, -0.001 * count_rad));
    TEST_ASSERT_EQUAL_INT32(16384 * 3 + 100, count_at(config, 6.0 * bench::pi + 100.5 * count_rad));
    TEST_ASSERT_EQUAL_INT32(-100 - 1, count_at(config, -100.5 * count_rad));
}

void test_the_count_of_an_encoder_wraps_at_32_bits()
{
    plant::SensorConfig config;
    config.encoder_counts_per_turn = 1 << 30;
    const double turn_rad = 2.0 * bench::pi;
    TEST_ASSERT_INT32_WITHIN(1, (1 << 30) + (1 << 29), count_at(config, 1.5 * turn_rad));
    TEST_ASSERT_INT32_WITHIN(1, -(1 << 30) - (1 << 29), count_at(config, 2.5 * turn_rad));
    TEST_ASSERT_INT32_WITHIN(1, 1 << 29, count_at(config, 4.5 * turn_rad));
}

void test_an_eccentric_encoder_errs_once_per_turn()
{
    plant::SensorConfig config;
    config.encoder_counts_per_turn = 1 << 30;
    config.encoder_eccentricity_rad = 3e-4;
    config.encoder_phase_rad = 0.7;
    const double count_rad = 2.0 * bench::pi / (1 << 30);
    TEST_ASSERT_EQUAL_INT32(0, count_at(config, 0.0));
    for (int n = -20; n <= 20; n++) {
        const double theta = 0.15 * n; /* -3...3 rad */
        const double error = 3e-4 * (std::sin(theta + 0.7) - std::sin(0.7));
        TEST_ASSERT_DOUBLE_WITHIN(1.001 * count_rad, theta + error,
                                  count_rad * count_at(config, theta));
    }
}

/* What is seen of the index on the way from one angle to another. */
plant::Samples passage(const plant::SensorConfig &config, double from_rad, double to_rad)
{
    plant::Sensors sensors(config, 1);
    (void)sensors.sample(0, {plant::Phases(), plant::Phases(), 24.0, from_rad, false});
    return sensors.sample(1, {plant::Phases(), plant::Phases(), 24.0, to_rad, false});
}

void expect_edge(bool passed, std::int32_t count, const plant::IndexEdge &edge)
{
    TEST_ASSERT_EQUAL(passed, edge.passed);
    TEST_ASSERT_EQUAL_INT32(count, edge.count);
}

void test_the_edges_of_an_index_change_places_with_the_direction()
{
    plant::SensorConfig config;
    config.encoder_counts_per_turn = 1000;
    const double count_rad = 2.0 * bench::pi / 1000, turn_rad = 2.0 * bench::pi;
    config.encoder_index_rad = 100.5 * count_rad;
    const plant::Samples up = passage(config, 99.0 * count_rad, 110.0 * count_rad);
    expect_edge(true, 100, up.index_rise);
    expect_edge(true, 101, up.index_fall);
    const plant::Samples down = passage(config, 110.0 * count_rad, 99.0 * count_rad);
    expect_edge(true, 101, down.index_rise);
    expect_edge(true, 100, down.index_fall);
    const plant::Samples within = passage(config, 100.6 * count_rad, 101.4 * count_rad);
    expect_edge(false, 0, within.index_rise);
    expect_edge(false, 0, within.index_fall);
    const plant::Samples onto = passage(config, 100.4 * count_rad, 100.6 * count_rad);
    expect_edge(true, 100, onto.index_rise);
    expect_edge(false, 0, onto.index_fall);
    const plant::Samples before =
        passage(config, 99.0 * count_rad - 3.0 * turn_rad, 110.0 * count_rad - 3.0 * turn_rad);
    expect_edge(true, 100 - 3000, before.index_rise);
}

void test_an_encoder_without_an_index_has_no_edges()
{
    plant::SensorConfig config;
    config.encoder_counts_per_turn = 1000;
    config.encoder_index_rad = -1.0;
    const plant::Samples samples = passage(config, -7.0, 7.0);
    expect_edge(false, 0, samples.index_rise);
    expect_edge(false, 0, samples.index_fall);
}

void test_offsets_shift_the_codes_of_their_own_channel()
{
    plant::SensorConfig config = noiseless();
    config.current_offset_a_A = 3 * plant::current_A_per_code(config);
    config.current_offset_b_A = -2 * plant::current_A_per_code(config);
    config.phase_voltage_offset_b_V = 5 * plant::phase_voltage_V_per_code(config);
    const plant::Samples samples = sampled(config, 0.0, 0.0, 24.0);
    TEST_ASSERT_EQUAL_UINT16(2051, samples.current_a);
    TEST_ASSERT_EQUAL_UINT16(2046, samples.current_b);
    TEST_ASSERT_EQUAL_INT16(0, samples.phase_voltage_a);
    TEST_ASSERT_EQUAL_INT16(5, samples.phase_voltage_b);
}

void test_noise_in_the_codes_has_the_stated_rms()
{
    plant::SensorConfig config;
    config.current_noise_rms_A = 0.1; /* 34 codes: rounding adds little */
    plant::Sensors sensors(config, 5);
    double sum = 0.0, square = 0.0;
    for (std::uint64_t k = 0; k < draws; k++) {
        const double code =
            sensors.sample(k, {plant::Phases(), plant::Phases(), 24.0, 0.0, false}).current_b;
        const double current_A = (code - 2048) * plant::current_A_per_code(config);
        sum += current_A;
        square += current_A * current_A;
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.0, sum / draws);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.1, std::sqrt(square / draws));
}

void test_converters_disturb_each_others_currents_by_the_stated_codes()
{
    plant::SensorConfig config = noiseless();
    const plant::True still = {plant::Phases(), plant::Phases(), 24.0, 0.0, false};
    TEST_ASSERT_EQUAL_UINT16(2048, plant::Sensors(config, 5).sample(7, still).current_a);
    config.converter_crosstalk_codes = 10.0;
    plant::Sensors sensors(config, 5);
    double square = 0.0, product = 0.0;
    for (std::uint64_t k = 0; k < draws; k++) {
        const plant::Samples samples = sensors.sample(k, still);
        const double a = samples.current_a - 2048, b = samples.current_b - 2048;
        square += a * a + b * b;
        product += a * b;
        TEST_ASSERT_EQUAL_INT16(0, samples.phase_voltage_a);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 10.0, std::sqrt(square / (2.0 * draws)));
    TEST_ASSERT_DOUBLE_WITHIN(2.0, 0.0, product / draws);
}

void test_noise_is_standard_normal()
{
    double moment[5] = {0.0, 0.0, 0.0, 0.0, 0.0};
    int beyond_two = 0, beyond_three = 0;
    const std::uint64_t key = plant::gaussian_key(3, 1);
    for (std::uint64_t k = 0; k < draws; k++) {
        const plant::Phases noise = plant::gaussian_pair(key, k);
        for (int lane = 0; lane < 2; lane++) {
            double power = 1.0;
            for (int n = 1; n <= 4; n++) {
                power *= noise[lane];
                moment[n] += power / (2.0 * draws);
            }
            beyond_two += std::fabs(noise[lane]) > 2.0 ? 1 : 0;
            beyond_three += std::fabs(noise[lane]) > 3.0 ? 1 : 0;
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.008, 0.0, moment[1]); /* five standard errors */
    TEST_ASSERT_DOUBLE_WITHIN(0.012, 1.0, moment[2]);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.0, moment[3]);
    TEST_ASSERT_DOUBLE_WITHIN(0.08, 3.0, moment[4]);
    TEST_ASSERT_DOUBLE_WITHIN(0.0017, 0.045500, beyond_two / (2.0 * draws));
    TEST_ASSERT_DOUBLE_WITHIN(0.00042, 0.0027, beyond_three / (2.0 * draws));
}

double correlation(std::uint64_t other_seed, std::uint64_t other_channel, std::uint64_t lag,
                   int lane, int other_lane)
{
    const std::uint64_t key = plant::gaussian_key(3, 1);
    const std::uint64_t other = plant::gaussian_key(other_seed, other_channel);
    double sum = 0.0;
    for (std::uint64_t k = 0; k < draws; k++) {
        sum +=
            plant::gaussian_pair(key, k)[lane] * plant::gaussian_pair(other, k + lag)[other_lane];
    }
    return sum / draws;
}

void test_channels_periods_and_seeds_are_independent()
{
    const double five_standard_errors = 5.0 / std::sqrt(draws);
    TEST_ASSERT_DOUBLE_WITHIN(five_standard_errors, 0.0, correlation(3, 1, 0, 0, 1)); /* a and b */
    TEST_ASSERT_DOUBLE_WITHIN(five_standard_errors, 0.0, correlation(3, 2, 0, 0, 0));
    TEST_ASSERT_DOUBLE_WITHIN(five_standard_errors, 0.0, correlation(3, 1, 1, 0, 0));
    TEST_ASSERT_DOUBLE_WITHIN(five_standard_errors, 0.0, correlation(3, 1, 1, 1, 1));
    TEST_ASSERT_DOUBLE_WITHIN(five_standard_errors, 0.0, correlation(4, 1, 0, 0, 0));
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 1.0, correlation(3, 1, 0, 0, 0)); /* the test can see it */
}

void test_the_same_seed_repeats_a_run_and_another_does_not()
{
    plant::Config config = bench::config();
    config.sensors.exact = false;
    config.seed = 11;
    plant::Plant first(config);
    plant::Plant again(config);
    config.seed = 12;
    plant::Plant other(config);
    int different = 0;
    for (int k = 0; k < 200; k++) {
        const plant::Duties duties = bench::voltages(1.0, 0.5);
        first.step(duties);
        again.step(duties);
        other.step(duties);
        TEST_ASSERT_EQUAL_UINT16(first.samples().current_a, again.samples().current_a);
        TEST_ASSERT_EQUAL_INT16(first.samples().phase_voltage_b, again.samples().phase_voltage_b);
        TEST_ASSERT_TRUE(first.state().i_a_A == other.state().i_a_A); /* noise is not physics */
        different += first.samples().current_a != other.samples().current_a ? 1 : 0;
    }
    TEST_ASSERT_TRUE(different > 50);
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_zero_is_the_middle_code);
    RUN_TEST(test_codes_are_rounded_to_the_nearest);
    RUN_TEST(test_codes_clamp_at_the_ends_of_their_range);
    RUN_TEST(test_exact_codes_have_sixteen_bits_and_no_noise);
    RUN_TEST(test_an_encoder_counts_whole_steps_from_angle_zero);
    RUN_TEST(test_the_count_of_an_encoder_wraps_at_32_bits);
    RUN_TEST(test_an_eccentric_encoder_errs_once_per_turn);
    RUN_TEST(test_the_edges_of_an_index_change_places_with_the_direction);
    RUN_TEST(test_an_encoder_without_an_index_has_no_edges);
    RUN_TEST(test_offsets_shift_the_codes_of_their_own_channel);
    RUN_TEST(test_noise_in_the_codes_has_the_stated_rms);
    RUN_TEST(test_converters_disturb_each_others_currents_by_the_stated_codes);
    RUN_TEST(test_noise_is_standard_normal);
    RUN_TEST(test_channels_periods_and_seeds_are_independent);
    RUN_TEST(test_the_same_seed_repeats_a_run_and_another_does_not);
    return UNITY_END();
}
