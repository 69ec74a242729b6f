/* The magnetic circuit: what is measured at its terminals, and that one energy gives it all. */
#include <initializer_list>
#include <unity.h>

#include "sil/plant/elementary.h"
#include "sil/plant/magnetics.h"
#include "tests/unit/plant_bench.h"

void setUp()
{
}

void tearDown()
{
}

namespace
{

constexpr double rated_A = 3.0;
const double holding_Nm = std::sqrt(2.0) * bench::torque_constant_Nm_A * rated_A;

plant::Axes axes_at(double electrical_rad)
{
    return plant::axes_of(plant::unit_vector(electrical_rad));
}

plant::Magnetics magnetics(const plant::ImperfectionConfig &imperfections)
{
    return plant::magnetics_of(bench::config().motor, imperfections);
}

plant::ImperfectionConfig everything()
{
    plant::ImperfectionConfig all;
    all.rated_current_A = rated_A;
    all.saturation_depth = 0.1;
    all.flux_harmonic_3 = 0.02;
    all.detent_4 = 0.05;
    all.detent_2 = 0.015;
    all.detent_1 = 0.0075;
    return all;
}

/* dlambda_a / di_a at a current in phase a, by central differences. */
double incremental_inductance_H(const plant::Magnetics &motor, double current_A,
                                double electrical_rad)
{
    const double step_A = 1e-4;
    const plant::Axes axes = axes_at(electrical_rad);
    const double more = motor.flux(plant::Phases{current_A + step_A, 0.0}, axes)[0];
    const double less = motor.flux(plant::Phases{current_A - step_A, 0.0}, axes)[0];
    return motor.inductance * (more - less) / (2.0 * step_A);
}

void test_inductance_falls_by_the_depth_where_magnet_and_rated_current_align()
{
    for (const double depth : {0.02, 0.05, 0.1, 0.2, 0.4}) {
        plant::ImperfectionConfig saturated;
        saturated.rated_current_A = rated_A;
        saturated.saturation_depth = depth;
        const plant::Magnetics motor = magnetics(saturated);
        const double aligned_H = incremental_inductance_H(motor, rated_A, 0.0);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, 1.0 - depth, aligned_H / motor.inductance);
    }
}

void test_the_motor_file_holds_what_is_measured_at_zero_current()
{
    const plant::Magnetics motor = magnetics(everything());
    double inductance_H = 0.0;
    double fundamental_Vs = 0.0;
    constexpr int angles = 360;
    for (int n = 0; n < angles; n++) {
        const double angle = 2.0 * bench::pi * n / angles;
        const plant::Phases flux = motor.flux(plant::Phases{0.0, 0.0}, axes_at(angle));
        inductance_H += incremental_inductance_H(motor, 0.0, angle) / angles;
        fundamental_Vs += 2.0 * motor.inductance * flux[0] * std::cos(angle) / angles;
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-7 * bench::inductance_H, bench::inductance_H, inductance_H);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, bench::torque_constant_Nm_A,
                              bench::rotor_teeth * fundamental_Vs);
    TEST_ASSERT_TRUE(motor.inductance > 1.01 * bench::inductance_H);
}

void test_without_imperfections_it_is_the_plain_motor()
{
    const plant::Magnetics motor = magnetics(plant::ImperfectionConfig());
    TEST_ASSERT_TRUE(motor.inductance == bench::inductance_H && motor.saturation == 0.0);
    for (int n = 0; n < 12; n++) {
        const double angle = 0.5 * n;
        const plant::Axes axes = axes_at(angle);
        const plant::Phases current_A = {1.5, -2.5};
        const double expected_Nm =
            bench::torque_constant_Nm_A * (-1.5 * std::sin(angle) - 2.5 * std::cos(angle));
        TEST_ASSERT_DOUBLE_WITHIN(1e-14, expected_Nm,
                                  motor.torque_Nm(motor.flux(current_A, axes), axes));
    }
}

void test_current_and_torque_are_the_slopes_of_one_energy()
{
    const plant::Magnetics motor = magnetics(everything());
    for (int n = 0; n < 40; n++) {
        const double angle = 0.16 * n;
        const plant::Phases flux = {4.0 * std::cos(1.3 * n), 4.0 * std::sin(1.7 * n)};
        const auto energy_J = [&](double a, double b, double more_rad) {
            return motor.energy_J(flux + plant::Phases{a, b}, axes_at(angle + more_rad));
        };
        const double by = 1e-5;
        const double slope_a = (energy_J(by, 0.0, 0.0) - energy_J(-by, 0.0, 0.0)) / (2.0 * by);
        const double slope_b = (energy_J(0.0, by, 0.0) - energy_J(0.0, -by, 0.0)) / (2.0 * by);
        const double slope = (energy_J(0.0, 0.0, by) - energy_J(0.0, 0.0, -by)) / (2.0 * by);
        const plant::Phases current_A = motor.current_A(flux, axes_at(angle));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, current_A[0], slope_a / motor.inductance);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, current_A[1], slope_b / motor.inductance);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, -bench::rotor_teeth * slope,
                                  motor.torque_Nm(flux, axes_at(angle)));
    }
}

void test_without_current_the_torque_is_the_detent_as_declared()
{
    plant::ImperfectionConfig unsaturated = everything();
    unsaturated.saturation_depth = 0.0;
    const plant::Magnetics motor = magnetics(unsaturated);
    for (int n = 0; n < 40; n++) {
        const double angle = 0.16 * n;
        const plant::Axes axes = axes_at(angle);
        const double expected_Nm =
            -holding_Nm * (0.05 * std::sin(4.0 * angle) + 0.015 * std::sin(2.0 * angle) +
                           0.0075 * std::sin(angle));
        const plant::Phases open = motor.flux(plant::Phases{0.0, 0.0}, axes);
        TEST_ASSERT_DOUBLE_WITHIN(1e-14, expected_Nm, motor.torque_Nm(open, axes));
    }
}

void test_saturation_brings_a_small_detent_of_its_own()
{
    plant::ImperfectionConfig saturated;
    saturated.rated_current_A = rated_A;
    saturated.saturation_depth = 0.1;
    const plant::Magnetics motor = magnetics(saturated);
    const plant::Axes axes = axes_at(bench::pi / 8.0); /* where sin 4 phi = 1 */
    const double detent_Nm = motor.torque_Nm(motor.flux(plant::Phases{0.0, 0.0}, axes), axes);
    TEST_ASSERT_DOUBLE_WITHIN(0.1e-3, 1.5e-3, detent_Nm);
}

void test_the_flux_of_a_current_gives_that_current_back()
{
    const plant::Magnetics motor = magnetics(everything());
    for (int n = -20; n <= 20; n++) {
        const plant::Phases current_A = {0.7 * n, -0.3 * n};
        const plant::Axes axes = axes_at(0.3 * n);
        const plant::Phases again_A = motor.current_A(motor.flux(current_A, axes), axes);
        TEST_ASSERT_DOUBLE_WITHIN(1e-13, current_A[0], again_A[0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-13, current_A[1], again_A[1]);
    }
}

void test_the_exponential_and_the_small_turn_are_those_of_the_library()
{
    for (double x = -700.0; x <= 0.0; x += 0.37) {
        TEST_ASSERT_DOUBLE_WITHIN(4e-15 * std::exp(x), std::exp(x), plant::falling_exponential(x));
    }
    for (double x = -0.7; x <= 0.0; x += 0.01) {
        TEST_ASSERT_DOUBLE_WITHIN(4e-15, std::exp(x), plant::falling_exponential(x));
    }
    const plant::Phases before = {0.6, 0.8};
    const double before_rad = std::atan2(0.8, 0.6);
    for (int n = -20; n <= 20; n++) {
        const plant::Phases turned = plant::turned_by_little<3>(before, 0.01 * n);
        const double angle = before_rad + 0.01 * n;
        TEST_ASSERT_DOUBLE_WITHIN(1e-11, std::cos(angle), turned[0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-11, std::sin(angle), turned[1]);
        const plant::Phases turned_less = plant::turned_by_little<2>(before, 0.0003 * n);
        const double lesser_angle = before_rad + 0.0003 * n;
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, std::cos(lesser_angle), turned_less[0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, std::sin(lesser_angle), turned_less[1]);
    }
}

/* Asked again, a span is found among those kept, of which each new one may replace another. */
void test_a_decay_that_is_asked_again_leaves_the_same()
{
    plant::Decay decay(1e5);
    for (int round = 0; round < 3; round++) {
        for (int n = 1; n < 100; n++) {
            const double time_s = 1e-6 * n;
            const plant::Decay::Span span = decay.over(time_s);
            TEST_ASSERT_TRUE(span.left == plant::falling_exponential(-(time_s * 1e5)));
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, 10.0 / n, span.constants);
        }
    }
    TEST_ASSERT_TRUE(decay.over(1e-3).left == 0.0);
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_inductance_falls_by_the_depth_where_magnet_and_rated_current_align);
    RUN_TEST(test_the_motor_file_holds_what_is_measured_at_zero_current);
    RUN_TEST(test_without_imperfections_it_is_the_plain_motor);
    RUN_TEST(test_current_and_torque_are_the_slopes_of_one_energy);
    RUN_TEST(test_without_current_the_torque_is_the_detent_as_declared);
    RUN_TEST(test_saturation_brings_a_small_detent_of_its_own);
    RUN_TEST(test_the_flux_of_a_current_gives_that_current_back);
    RUN_TEST(test_the_exponential_and_the_small_turn_are_those_of_the_library);
    RUN_TEST(test_a_decay_that_is_asked_again_leaves_the_same);
    return UNITY_END();
}
