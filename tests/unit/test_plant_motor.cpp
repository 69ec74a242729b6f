/* The motor: signs, statics and dynamics that can be said in closed form. */
#include <initializer_list>

#include <unity.h>

#include "sil/plant/elementary.h"
#include "sil/plant/motor.h"
#include "tests/unit/plant_bench.h"

void setUp()
{
}

void tearDown()
{
}

namespace
{

plant::Config locked(plant::Config config)
{
    config.motor.inertia_kgm2 = 1e9;
    return config;
}

void test_current_in_phase_b_at_angle_zero_turns_the_rotor_forward()
{
    plant::Plant plant(bench::ideal());
    bench::run(plant, bench::voltages(0.0, 2.0), 10);
    TEST_ASSERT_TRUE(plant.state().i_b_A > 0.0);
    TEST_ASSERT_TRUE(plant.state().torque_Nm > 0.0);
    TEST_ASSERT_TRUE(plant.state().omega_rad_s > 0.0);
    TEST_ASSERT_TRUE(plant.state().theta_rad > 0.0);
}

void test_angle_zero_is_the_rest_angle_of_current_in_phase_a()
{
    plant::Config config = bench::ideal();
    config.initial_theta_rad = 0.01; /* 29 degrees electrical */
    config.motor.viscous_friction_Nms_rad = 0.02;
    plant::Plant plant(config);
    bench::run(plant, bench::voltages(1.0, 0.0), 5000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, plant.state().theta_rad);
}

void test_back_emf_of_a_forward_turning_rotor_leads_by_a_quarter_turn()
{
    plant::Config config = locked(bench::config());
    config.initial_omega_rad_s = 10.0;
    for (int eighth = 0; eighth < 8; eighth++) {
        config.initial_theta_rad = 2.0 * bench::pi / bench::rotor_teeth * eighth / 8.0;
        plant::Plant plant(config);
        plant.step(bench::off()); /* open circuit: the phase voltage is the back-EMF */
        const double middle =
            bench::rotor_teeth * (config.initial_theta_rad + 0.5 * 10.0 * bench::period_s);
        const double half = 0.5 * bench::rotor_teeth * 10.0 * bench::period_s;
        const double emf_V = bench::torque_constant_Nm_A * 10.0 * std::sin(half) / half;
        TEST_ASSERT_DOUBLE_WITHIN(1e-8, -emf_V * std::sin(middle), plant.state().u_a_V);
        TEST_ASSERT_DOUBLE_WITHIN(1e-8, emf_V * std::cos(middle), plant.state().u_b_V);
    }
}

void test_current_of_a_locked_rotor_rises_as_the_exponential()
{
    plant::Plant plant(locked(bench::ideal()));
    const plant::Duties duties = bench::voltages(2.4, -4.8); /* whole counts */
    for (int k = 1; k <= 200; k++) {
        plant.step(duties);
        const double time_constant_s = bench::inductance_H / bench::resistance_ohm;
        const double rise = 1.0 - std::exp(-k * bench::period_s / time_constant_s);
        TEST_ASSERT_DOUBLE_WITHIN(1e-8, 2.4 / bench::resistance_ohm * rise, plant.state().i_a_A);
        TEST_ASSERT_DOUBLE_WITHIN(1e-8, -4.8 / bench::resistance_ohm * rise, plant.state().i_b_A);
    }
}

/* Steady state of R, L and a rotating back-EMF, phase a: i = Re(I e^(j N theta)). */
void test_a_short_circuited_winding_at_constant_speed_carries_the_phasor_current()
{
    plant::Config config = locked(bench::ideal());
    const double omega_rad_s = 60.0;
    config.initial_omega_rad_s = omega_rad_s;
    plant::Plant plant(config);
    bench::run(plant, bench::voltages(0.0, 0.0), 1000); /* 41 time constants */
    const double reactance_ohm = bench::rotor_teeth * omega_rad_s * bench::inductance_H;
    const double emf_V = bench::torque_constant_Nm_A * omega_rad_s;
    const double z2 = bench::resistance_ohm * bench::resistance_ohm + reactance_ohm * reactance_ohm;
    const double i_d_A = -emf_V * reactance_ohm / z2;
    const double i_q_A = -emf_V * bench::resistance_ohm / z2;
    const double angle = bench::rotor_teeth * plant.state().theta_rad;
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, i_d_A * std::cos(angle) - i_q_A * std::sin(angle),
                              plant.state().i_a_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, i_d_A * std::sin(angle) + i_q_A * std::cos(angle),
                              plant.state().i_b_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, bench::torque_constant_Nm_A * i_q_A, plant.state().torque_Nm);
}

void test_under_load_the_rotor_rests_at_the_arcsine_of_load_over_holding_torque()
{
    plant::Config config = bench::ideal();
    config.motor.viscous_friction_Nms_rad = 0.02; /* so that it comes to rest soon */
    plant::Plant plant(config);
    const plant::Duties duties = bench::voltages(0.6, 0.0);
    bench::run(plant, duties, 1000);
    plant.set_load_torque(0.1);
    bench::run(plant, duties, 10000);
    const double holding_Nm = bench::torque_constant_Nm_A * plant.state().i_a_A;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -std::asin(0.1 / holding_Nm) / bench::rotor_teeth,
                              plant.state().theta_rad);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.1, plant.state().torque_Nm);
}

void test_a_free_rotor_slows_down_as_friction_over_inertia()
{
    plant::Config config = bench::config();
    config.initial_omega_rad_s = 30.0; /* 4.7 V: no diode conducts, no current flows */
    plant::Plant plant(config);
    bench::run(plant, bench::off(), 1000);
    const double decay = bench::friction_Nms_rad / bench::inertia_kgm2;
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, 30.0 * std::exp(-0.1 * decay), plant.state().omega_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-11, 30.0 / decay * (1.0 - std::exp(-0.1 * decay)),
                              plant.state().theta_rad);
    TEST_ASSERT_TRUE(plant.state().i_a_A == 0.0 && plant.state().i_b_A == 0.0);
}

void test_a_long_way_does_not_coarsen_the_angle()
{
    plant::Config near = bench::ideal();
    near.initial_omega_rad_s = 10.0;
    plant::Config far = near;
    far.initial_theta_rad = 2.0 * bench::pi * 1e6;
    plant::Plant here(near);
    plant::Plant there(far);
    bench::run(here, bench::voltages(1.0, 0.5), 100);
    bench::run(there, bench::voltages(1.0, 0.5), 100);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, here.state().i_a_A, there.state().i_a_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, here.state().theta_rad,
                              there.state().theta_rad - far.initial_theta_rad);
}

plant::MotorState after_one_millisecond(int parts)
{
    const plant::Config config = bench::config();
    plant::Motor motor(config.motor, 0.01, 80.0, false);
    plant::Timetable timetable;
    timetable.count = 1;
    const plant::Phases voltage_V = {12.0, -7.0};
    const plant::BridgeOutput output = {voltage_V, voltage_V, plant::Phases(), false, true};
    timetable.segments[0] = {1e-3 / parts, &output};
    for (int part = 0; part < parts; part++) {
        motor.begin_period();
        motor.advance(timetable);
    }
    return motor.state();
}

double difference_A(const plant::MotorState &x, const plant::MotorState &y)
{
    return std::fabs(x.current_A[0] - y.current_A[0]);
}

void test_shorter_steps_converge_to_the_same_end()
{
    const plant::MotorState finest = after_one_millisecond(120); /* still of order 5 */
    const double coarse_A = difference_A(after_one_millisecond(60), finest);
    const double fine_A = difference_A(after_one_millisecond(90), finest);
    TEST_ASSERT_TRUE(coarse_A < 1e-7);
    TEST_ASSERT_TRUE(fine_A < coarse_A / 5.0); /* 1.5^5 in the limit, less what the finest lacks */
}

/* Segments so short that they are crossed with order 4 and 3, from the greatest reach of each on.
 */
void test_shorter_segments_are_as_exact_with_a_lower_order()
{
    const plant::MotorState finest = after_one_millisecond(120);
    for (const int parts : {140, 160, 200, 400, 550, 600, 1500, 6000}) {
        TEST_ASSERT_TRUE(difference_A(after_one_millisecond(parts), finest) < 1e-7);
    }
}

void test_sine_cosine_and_logarithm_are_those_of_the_library()
{
    for (int n = -6283; n <= 6283; n++) {
        const double angle = 1e-3 * n;
        const plant::Phases vector = plant::unit_vector(angle);
        TEST_ASSERT_DOUBLE_WITHIN(4e-16, std::cos(angle), vector[0]);
        TEST_ASSERT_DOUBLE_WITHIN(4e-16, std::sin(angle), vector[1]);
    }
    for (double x = 1e-16; x < 1e16; x *= 1.1) {
        const double expected = std::log(x);
        TEST_ASSERT_DOUBLE_WITHIN(4e-15 * std::fabs(expected) + 1e-16, expected,
                                  plant::natural_logarithm(x));
    }
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_current_in_phase_b_at_angle_zero_turns_the_rotor_forward);
    RUN_TEST(test_angle_zero_is_the_rest_angle_of_current_in_phase_a);
    RUN_TEST(test_back_emf_of_a_forward_turning_rotor_leads_by_a_quarter_turn);
    RUN_TEST(test_current_of_a_locked_rotor_rises_as_the_exponential);
    RUN_TEST(test_a_short_circuited_winding_at_constant_speed_carries_the_phasor_current);
    RUN_TEST(test_under_load_the_rotor_rests_at_the_arcsine_of_load_over_holding_torque);
    RUN_TEST(test_a_free_rotor_slows_down_as_friction_over_inertia);
    RUN_TEST(test_a_long_way_does_not_coarsen_the_angle);
    RUN_TEST(test_shorter_steps_converge_to_the_same_end);
    RUN_TEST(test_shorter_segments_are_as_exact_with_a_lower_order);
    RUN_TEST(test_sine_cosine_and_logarithm_are_those_of_the_library);
    return UNITY_END();
}
