/* The bridge: when its legs switch, what dead time does, and what a phase without current sees. */
#include <unity.h>

#include "sil/plant/bridge.h"
#include "tests/unit/plant_bench.h"

void setUp()
{
}

void tearDown()
{
}

namespace
{

constexpr double count_s = bench::period_s / (2 * bench::half_counts);
constexpr int dead_counts = 170; /* 1 us */

plant::Config with_dead_time(double dead_time_s)
{
    plant::Config config = bench::config();
    config.bridge.dead_time_s = dead_time_s;
    return config;
}

plant::Duties high_counts(int a_plus, int a_minus, int b_plus, int b_minus)
{
    plant::Duties duties;
    duties.bridge_on = true;
    const int counts[4] = {a_plus, a_minus, b_plus, b_minus};
    for (int leg = 0; leg < 4; leg++) {
        duties.high_counts[leg] = static_cast<std::uint16_t>(counts[leg]);
    }
    return duties;
}

/* Voltage of phase a, for a positive current, at a time in the middle of a count. */
double voltage_at(const plant::Timetable &timetable, int count)
{
    double end_s = 0.0;
    for (const plant::Segment &segment : timetable) {
        end_s += segment.duration_s;
        if ((count + 0.5) * count_s < end_s) {
            return segment.output->if_positive_V[0];
        }
    }
    return -1e9;
}

void test_a_leg_is_high_around_the_middle_of_the_period()
{
    plant::Bridge bridge(with_dead_time(0.0).bridge);
    const plant::Timetable &timetable = bridge.period(high_counts(3000, 0, 0, 0));
    TEST_ASSERT_EQUAL_INT(3, timetable.count);
    TEST_ASSERT_TRUE(voltage_at(timetable, 5499) == 0.0);
    TEST_ASSERT_TRUE(voltage_at(timetable, 5500) == 24.0);
    TEST_ASSERT_TRUE(voltage_at(timetable, 11499) == 24.0);
    TEST_ASSERT_TRUE(voltage_at(timetable, 11500) == 0.0);
    TEST_ASSERT_TRUE(voltage_at(timetable, 16999) == 0.0);
}

void test_turn_on_waits_for_the_dead_time_turn_off_does_not()
{
    plant::Bridge bridge(with_dead_time(1e-6).bridge);
    const plant::Timetable &timetable = bridge.period(high_counts(3000, 0, 0, 0));
    TEST_ASSERT_EQUAL_INT(5, timetable.count);
    TEST_ASSERT_TRUE(voltage_at(timetable, 5499) == 0.0);
    TEST_ASSERT_TRUE(voltage_at(timetable, 5500) == -1.0);
    TEST_ASSERT_TRUE(voltage_at(timetable, 5500 + dead_counts - 1) == -1.0);
    TEST_ASSERT_TRUE(voltage_at(timetable, 5500 + dead_counts) == 24.0);
    TEST_ASSERT_TRUE(voltage_at(timetable, 11499) == 24.0);
    TEST_ASSERT_TRUE(voltage_at(timetable, 11500) == -1.0);
    TEST_ASSERT_TRUE(voltage_at(timetable, 11500 + dead_counts) == 0.0);
}

void test_a_pulse_shorter_than_the_dead_time_never_appears()
{
    plant::Bridge bridge(with_dead_time(1e-6).bridge);
    const int half_pulse = dead_counts / 2 - 5;
    const plant::Timetable &timetable = bridge.period(high_counts(half_pulse, 0, 0, 0));
    for (const plant::Segment &segment : timetable) {
        TEST_ASSERT_TRUE(segment.output->if_positive_V[0] <= 0.0);
    }
    TEST_ASSERT_TRUE(voltage_at(timetable, 8500 - half_pulse) == -1.0);
    TEST_ASSERT_TRUE(voltage_at(timetable, 8500 + half_pulse + dead_counts - 1) == -1.0);
    TEST_ASSERT_TRUE(voltage_at(timetable, 8500 + half_pulse + dead_counts) == 0.0);
}

void test_a_low_gap_shorter_than_the_dead_time_never_appears_either()
{
    plant::Bridge bridge(with_dead_time(1e-6).bridge);
    const plant::Duties duties = high_counts(8500 - 40, 0, 0, 0);
    bridge.period(duties);
    const plant::Timetable &timetable = bridge.period(duties);
    /* Off at 16960, on again 170 counts after 40 of the next period. */
    TEST_ASSERT_TRUE(voltage_at(timetable, 0) == -1.0);
    TEST_ASSERT_TRUE(voltage_at(timetable, 40 + dead_counts - 1) == -1.0);
    TEST_ASSERT_TRUE(voltage_at(timetable, 40 + dead_counts) == 24.0);
}

void test_dead_time_reaches_over_the_end_of_the_period()
{
    plant::Bridge bridge(with_dead_time(1e-6).bridge);
    bridge.period(high_counts(8400, 0, 0, 0)); /* off at 16900, low on at 17070 */
    const plant::Timetable &timetable = bridge.period(high_counts(100, 0, 0, 0));
    TEST_ASSERT_TRUE(voltage_at(timetable, 69) == -1.0);
    TEST_ASSERT_TRUE(voltage_at(timetable, 70) == 0.0);
}

void test_full_duty_has_no_edge()
{
    plant::Bridge bridge(with_dead_time(1e-6).bridge);
    const plant::Duties duties = high_counts(8500, 0, 0, 0);
    bridge.period(duties);
    const plant::Timetable &timetable = bridge.period(duties);
    TEST_ASSERT_EQUAL_INT(1, timetable.count);
    TEST_ASSERT_TRUE(voltage_at(timetable, 0) == 24.0);
}

void test_the_segments_fill_the_period()
{
    plant::Bridge bridge(with_dead_time(0.7e-6).bridge); /* not whole counts */
    std::uint32_t draw = 1;
    for (int k = 0; k < 2000; k++) {
        int counts[4];
        for (int &count : counts) {
            draw = draw * 1664525u + 1013904223u;
            count = static_cast<int>((draw >> 16) % 8600u); /* beyond full now and then */
        }
        double sum_s = 0.0;
        for (const plant::Segment &segment :
             bridge.period(high_counts(counts[0], counts[1], counts[2], counts[3]))) {
            TEST_ASSERT_TRUE(segment.duration_s > 0.0);
            sum_s += segment.duration_s;
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, bench::period_s, sum_s);
    }
}

void test_without_dead_time_the_mean_voltage_is_the_commanded_one()
{
    plant::Plant plant(with_dead_time(0.0));
    plant.step(high_counts(5100, 3400, 850, 7650));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 24.0 * 0.2, plant.state().u_a_V);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -24.0 * 0.8, plant.state().u_b_V);
}

/* Per period and phase: two edges at which dead time costs bus + 2 drops against the current. */
void test_dead_time_costs_voltage_against_the_current()
{
    plant::Config config = bench::config();
    config.motor.inertia_kgm2 = 1e9;
    plant::Plant plant(config);
    const plant::Duties duties = high_counts(5100, 3400, 3400, 5100);
    bench::run(plant, duties, 200);
    TEST_ASSERT_TRUE(plant.state().i_a_A > 5.0 && plant.state().i_b_A < -5.0);
    const double lost_V = 2.0 * (24.0 + 2.0 * 1.0) * 1e-6 / bench::period_s;
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, 4.8 - lost_V, plant.state().u_a_V);
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, -4.8 + lost_V, plant.state().u_b_V);
}

void test_an_open_bridge_brings_the_current_to_zero_and_keeps_it_there()
{
    plant::Plant plant(bench::config());
    bench::run(plant, bench::voltages(1.5, -1.5), 100);
    TEST_ASSERT_TRUE(plant.state().i_a_A > 1.0);
    double last_A = plant.state().i_a_A;
    while (plant.state().i_a_A != 0.0) {
        plant.step(bench::off());
        TEST_ASSERT_TRUE(plant.state().i_a_A < last_A);
        TEST_ASSERT_TRUE(plant.state().i_a_A >= 0.0);
        last_A = plant.state().i_a_A;
    }
    for (int k = 0; k < 100; k++) {
        plant.step(bench::off());
        TEST_ASSERT_TRUE(plant.state().i_a_A == 0.0);
    }
}

/* Locked, from i0 through both diodes: i = (i0 + U/R) exp(-R t / L) - U/R, U = bus + 2 drops. */
void test_freewheeling_takes_the_time_of_the_exponential()
{
    plant::Config config = bench::config();
    config.motor.inertia_kgm2 = 1e9;
    plant::Plant plant(config);
    bench::run(plant, bench::voltages(3.0, 0.0), 300);
    const double start_A = plant.state().i_a_A;
    plant.step(bench::off());
    const double against_A = 26.0 / bench::resistance_ohm;
    const double decay = std::exp(-bench::period_s * bench::resistance_ohm / bench::inductance_H);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, (start_A + against_A) * decay - against_A, plant.state().i_a_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -26.0, plant.state().u_a_V);
}

/* All legs alike: zero volts, and in dead time nothing drives a current. */
void test_a_phase_without_current_stays_without_current_through_the_dead_times()
{
    plant::Plant plant(bench::config());
    for (int k = 0; k < 100; k++) {
        plant.step(high_counts(4250, 4250, 3000, 3000));
        TEST_ASSERT_TRUE(plant.state().i_a_A == 0.0 && plant.state().i_b_A == 0.0);
        TEST_ASSERT_TRUE(plant.state().u_a_V == 0.0 && plant.state().u_b_V == 0.0);
    }
}

void test_an_open_bridge_conducts_only_for_a_back_emf_above_bus_and_diodes()
{
    const double threshold_rad_s = (24.0 + 2.0) / bench::torque_constant_Nm_A;
    plant::Config config = bench::config();
    config.motor.inertia_kgm2 = 1e9;
    config.initial_omega_rad_s = 0.999 * threshold_rad_s;
    plant::Plant below(config);
    config.initial_omega_rad_s = 1.01 * threshold_rad_s;
    plant::Plant above(config);
    double below_A = 0.0, above_A = 0.0;
    for (int k = 0; k < 100; k++) {
        below.step(bench::off());
        above.step(bench::off());
        below_A = std::fmax(below_A, std::fabs(below.state().i_a_A));
        above_A = std::fmax(above_A, std::fabs(above.state().i_a_A));
    }
    TEST_ASSERT_TRUE(below_A == 0.0);
    TEST_ASSERT_TRUE(above_A > 1e-3);
    TEST_ASSERT_TRUE(above.energy().supplied < 0.0); /* into the bus */
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_a_leg_is_high_around_the_middle_of_the_period);
    RUN_TEST(test_turn_on_waits_for_the_dead_time_turn_off_does_not);
    RUN_TEST(test_a_pulse_shorter_than_the_dead_time_never_appears);
    RUN_TEST(test_a_low_gap_shorter_than_the_dead_time_never_appears_either);
    RUN_TEST(test_dead_time_reaches_over_the_end_of_the_period);
    RUN_TEST(test_full_duty_has_no_edge);
    RUN_TEST(test_the_segments_fill_the_period);
    RUN_TEST(test_without_dead_time_the_mean_voltage_is_the_commanded_one);
    RUN_TEST(test_dead_time_costs_voltage_against_the_current);
    RUN_TEST(test_an_open_bridge_brings_the_current_to_zero_and_keeps_it_there);
    RUN_TEST(test_freewheeling_takes_the_time_of_the_exponential);
    RUN_TEST(test_a_phase_without_current_stays_without_current_through_the_dead_times);
    RUN_TEST(test_an_open_bridge_conducts_only_for_a_back_emf_above_bus_and_diodes);
    return UNITY_END();
}
