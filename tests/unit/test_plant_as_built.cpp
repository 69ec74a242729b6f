/* The plant `as-built`: iron, phases that differ, a warm magnet, a belt and the sensing's
   mismatches in closed form, and the energy of all of it. */
#include <stdexcept>
#include <unity.h>

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

constexpr double rated_A = 3.0;
constexpr double magnet_Vs = bench::torque_constant_Nm_A / bench::rotor_teeth;

/* One effect alone, on a rotor that does not turn for what is done to it. */
plant::Config heavy()
{
    plant::Config config = bench::ideal();
    config.motor.inertia_kgm2 = 1e6;
    config.motor.viscous_friction_Nms_rad = 0.0;
    config.imperfections.rated_current_A = rated_A;
    return config;
}

/* ---- iron ---- */

double loop_J(double coercive_A, double turned_by_Vs, double amplitude_Vs)
{
    return 4.0 * coercive_A *
           (amplitude_Vs - turned_by_Vs * std::tanh(amplitude_Vs / turned_by_Vs));
}

/* Phase b of a rotor at angle 0 has none of the magnet's flux. */
void test_a_loop_of_flux_loses_what_hysteresis_encloses()
{
    plant::Config config = heavy();
    config.motor.resistance_ohm = 0.0;
    config.imperfections.iron.hysteresis = 0.04;
    plant::Plant plant(config);
    const double volts = 0.12; /* 2.4 V ms up and down */
    bench::run(plant, bench::voltages(0.0, volts), 100);
    for (int n = 0; n < 3; n++) {
        bench::run(plant, bench::voltages(0.0, -volts), 200);
        bench::run(plant, bench::voltages(0.0, volts), 200);
    }
    const double before_J = plant.energy().iron;
    bench::run(plant, bench::voltages(0.0, -volts), 200);
    bench::run(plant, bench::voltages(0.0, volts), 200);
    const double amplitude_Vs = plant.state().u_b_V * 100 * bench::period_s;
    const double expected_J = loop_J(0.04 * rated_A, 0.32 * magnet_Vs, amplitude_Vs);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * expected_J, expected_J, plant.energy().iron - before_J);
}

void test_iron_keeps_a_current_after_its_voltage()
{
    plant::Config config = heavy();
    config.motor.resistance_ohm = 0.0;
    config.imperfections.iron.hysteresis = 0.04;
    plant::Plant plant(config);
    bench::run(plant, bench::voltages(0.0, 1.0), 50);
    const double full_A = plant.state().i_b_A;
    const double linear_A = plant.state().u_b_V * 50 * bench::period_s / bench::inductance_H;
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, linear_A + 0.04 * rated_A, full_A);
    bench::run(plant, bench::voltages(0.0, -1.0), 50);
    const double least_A = plant.state().i_b_A;
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, -0.04 * rated_A, least_A); /* of no flux, from above */
}

/* The magnet's flux, turned past the iron with no current. */
void test_the_iron_drags_a_rotor_that_is_turned()
{
    plant::Config config = heavy();
    config.imperfections.iron.hysteresis = 0.04;
    config.initial_omega_rad_s = 0.5;
    plant::Plant plant(config);
    const int turn = static_cast<int>(2.0 * bench::pi / bench::rotor_teeth / 0.5 / bench::period_s);
    bench::run(plant, bench::off(), turn);
    double torque_Nm = 0.0;
    for (int k = 0; k < turn; k++) {
        plant.step(bench::off());
        torque_Nm += plant.state().torque_Nm / turn;
    }
    const double expected_Nm = 2.0 * bench::rotor_teeth / (2.0 * bench::pi) *
                               loop_J(0.04 * rated_A, 0.32 * magnet_Vs, magnet_Vs);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * expected_Nm, -expected_Nm, torque_Nm);
}

void test_eddy_currents_follow_the_voltage_with_their_lag()
{
    plant::Config config = heavy();
    config.motor.resistance_ohm = 0.0;
    config.imperfections.iron.eddy_time_s = 6e-6;
    config.imperfections.iron.eddy_lag_s = 1e-3;
    plant::Plant plant(config);
    for (int k = 1; k <= 40; k++) {
        plant.step(bench::voltages(0.0, 3.0));
        const double volts = plant.state().u_b_V;
        const double t = k * bench::period_s;
        const double loss_ohm = bench::inductance_H / 6e-6;
        TEST_ASSERT_DOUBLE_WITHIN(
            1e-9, volts * t / bench::inductance_H + volts / loss_ohm * (1.0 - std::exp(-t / 1e-3)),
            plant.state().i_b_A);
    }
    TEST_ASSERT_TRUE(plant.energy().iron > 0.0);
}

/* ---- phases ---- */

void test_each_phase_has_its_own_resistance_and_inductance()
{
    plant::Config config = heavy();
    config.motor.torque_constant_Nm_A = 0.0;
    config.imperfections.resistance_a_scale = 0.9;
    config.imperfections.resistance_b_scale = 1.2;
    config.imperfections.inductance_a_scale = 1.3;
    config.imperfections.inductance_b_scale = 0.7;
    plant::Plant plant(config);
    const double resistance_ohm[2] = {0.9 * bench::resistance_ohm, 1.2 * bench::resistance_ohm};
    const double inductance_H[2] = {1.3 * bench::inductance_H, 0.7 * bench::inductance_H};
    for (int k = 1; k <= 100; k++) {
        plant.step(bench::voltages(0.6, 0.6));
        const double current_A[2] = {plant.state().i_a_A, plant.state().i_b_A};
        for (int p = 0; p < 2; p++) {
            const double grown =
                1.0 - std::exp(-k * bench::period_s * resistance_ohm[p] / inductance_H[p]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, plant.state().u_a_V / resistance_ohm[p] * grown,
                                      current_A[p]);
        }
    }
}

void test_unlike_inductances_leave_the_open_motor_as_it_is()
{
    plant::Config config = heavy();
    config.imperfections.detent_4 = 0.05;
    config.initial_omega_rad_s = 10.0;
    plant::Config unlike = config;
    unlike.imperfections.inductance_a_scale = 1.1;
    unlike.imperfections.inductance_b_scale = 0.9;
    plant::Plant like(config), other(unlike);
    for (int k = 0; k < 200; k++) {
        like.step(bench::off());
        other.step(bench::off());
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, like.state().u_a_V, other.state().u_a_V);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, like.state().u_b_V, other.state().u_b_V);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, like.state().torque_Nm, other.state().torque_Nm);
    }
}

/* ---- magnet ---- */

void test_a_warm_magnet_has_less_flux_and_less_detent()
{
    plant::Config config = heavy();
    config.imperfections.detent_4 = 0.05;
    config.initial_omega_rad_s = 10.0;
    plant::Config warm = config;
    warm.imperfections.magnet_rise_K = 100.0;
    plant::Plant cold_plant(config), warm_plant(warm);
    for (int k = 0; k < 200; k++) {
        cold_plant.step(bench::off());
        warm_plant.step(bench::off());
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.89 * cold_plant.state().u_a_V, warm_plant.state().u_a_V);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.89 * 0.89 * cold_plant.state().torque_Nm,
                                  warm_plant.state().torque_Nm);
    }
}

void test_a_magnet_that_warms_leaves_the_currents_and_ends_where_a_warm_one_is()
{
    plant::Config config = heavy();
    config.imperfections.saturation_depth = 0.1;
    plant::Plant plant(config);
    bench::run(plant, bench::voltages(0.5, 0.3), 100);
    const plant::State before = plant.state();
    plant.set_magnet_rise(60.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, before.i_a_A, plant.state().i_a_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, before.i_b_A, plant.state().i_b_A);
    TEST_ASSERT_TRUE(plant.state().torque_Nm < 0.97 * before.torque_Nm);
    bench::run(plant, bench::voltages(0.5, 0.3), 400);
    config.imperfections.magnet_rise_K = 60.0;
    plant::Plant warm(config);
    bench::run(warm, bench::voltages(0.5, 0.3), 500);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, warm.state().torque_Nm, plant.state().torque_Nm);
}

/* ---- belt ---- */

void test_two_masses_swing_as_a_damped_oscillator()
{
    constexpr double share = 0.4, frequency_Hz = 80.0, damping = 0.05, load_Nm = 0.2;
    plant::Config config = bench::ideal();
    config.motor.viscous_friction_Nms_rad = 0.0;
    config.motor.torque_constant_Nm_A = 0.0;
    config.imperfections.belt = {share, frequency_Hz, damping};
    plant::Plant plant(config);
    plant.set_load_torque(load_Nm);
    const double rate = 2.0 * bench::pi * frequency_Hz;
    const double damped = rate * std::sqrt(1.0 - damping * damping);
    const double far_kgm2 = share * bench::inertia_kgm2;
    for (int k = 1; k <= 1000; k++) {
        plant.step(bench::off());
        const double t = k * bench::period_s;
        /* of the twist: -T / (J_load w^2) (1 - e^-zwt (cos + z w / w_d sin)), differentiated */
        const double twisting =
            -load_Nm / far_kgm2 / damped * std::exp(-damping * rate * t) * std::sin(damped * t);
        const double together = -load_Nm * t / bench::inertia_kgm2;
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, together - share * twisting, plant.state().omega_rad_s);
    }
}

void test_a_jammed_rotor_leaves_the_load_swinging()
{
    plant::Config config = bench::ideal();
    config.imperfections.belt = {0.5, 80.0, 0.0};
    config.initial_omega_rad_s = 10.0;
    plant::Plant plant(config);
    plant.jam(plant::Plant::held_Nm);
    const double half_J = 0.25 * bench::inertia_kgm2 * 100.0;
    TEST_ASSERT_TRUE(plant.state().omega_rad_s == 0.0);
    bench::run(plant, bench::off(), 300);
    const plant::Energy &energy = plant.energy();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * half_J, half_J, energy.coulomb);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * half_J, -half_J, energy.kinetic + energy.spring);
    TEST_ASSERT_TRUE(energy.spring > 0.0);
}

/* ---- energy ---- */

plant::Config as_built()
{
    plant::Config config = bench::config();
    config.imperfections = {rated_A, 0.10, 0.02, 0.05, 0.015, 0.0075, 0.015, 0.22};
    config.imperfections.iron.hysteresis = 0.04;
    config.imperfections.iron.eddy_time_s = 12e-6;
    config.imperfections.resistance_a_scale = 0.97;
    config.imperfections.inductance_a_scale = 1.06;
    config.imperfections.inductance_b_scale = 0.93;
    config.imperfections.magnet_rise_K = 70.0;
    config.imperfections.belt = {0.5, 100.0, 0.02};
    config.supply = {0.1, 470e-6, 10.0, 30.0};
    return config;
}

void balances(const plant::Plant &plant, double turnover_J)
{
    const plant::Energy &e = plant.energy();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * turnover_J, e.supplied,
                              e.copper + e.magnetic + e.kinetic + e.friction + e.load + e.diode +
                                  e.coulomb + e.arc + e.source + e.brake + e.capacitor + e.iron +
                                  e.spring + e.damping);
}

void test_all_the_energy_is_found_again_in_motion()
{
    plant::Plant plant(as_built());
    plant.set_load_torque(0.1);
    for (int k = 0; k < 3000; k++) {
        plant.step(bench::rotor_voltages(plant, -1.0, 9.0));
    }
    const plant::Energy &energy = plant.energy();
    TEST_ASSERT_TRUE(plant.state().omega_rad_s > 15.0);
    TEST_ASSERT_TRUE(energy.iron > 0.01 * energy.supplied);
    TEST_ASSERT_TRUE(energy.damping > 0.0);
    balances(plant, energy.supplied);
}

void test_and_while_it_coasts_down_and_its_currents_end()
{
    plant::Plant plant(as_built());
    for (int k = 0; k < 1000; k++) {
        plant.step(bench::rotor_voltages(plant, 0.0, 9.0));
    }
    bench::run(plant, bench::off(), 500);
    TEST_ASSERT_TRUE(plant.state().i_a_A == 0.0);
    balances(plant, plant.energy().supplied);
}

/* The current pushes it against the stop, and the bridge then lets go. */
void bounces(plant::Config config)
{
    config.stops = {-0.2, 0.4, 200.0, 0.1};
    plant::Plant plant(config);
    for (int k = 0; k < 1500; k++) {
        plant.step(bench::rotor_voltages(plant, 0.0, 3.0));
    }
    const double held_J = plant.energy().spring;
    TEST_ASSERT_TRUE(plant.state().theta_rad > 0.4);
    TEST_ASSERT_TRUE(held_J > 0.0);
    balances(plant, 2.0 * plant.energy().supplied); /* at rest: all is dead time */
    bench::run(plant, bench::off(), 1500);
    TEST_ASSERT_TRUE(plant.energy().spring < held_J);
    balances(plant, 2.0 * plant.energy().supplied);
}

void test_and_in_stops_of_the_machine_and_of_a_plain_motor()
{
    bounces(as_built());
    plant::Config rigid = as_built();
    rigid.imperfections.belt = {};
    bounces(rigid);
    bounces(bench::config());
}

void test_stops_that_come_where_the_rotor_is_bring_no_energy()
{
    plant::Config config = bench::config();
    config.initial_theta_rad = 0.1;
    plant::Plant plant(config);
    plant.set_stops({-1.0, 0.05, 5.0, 0.1});
    bench::run(plant, bench::off(), 1);
    TEST_ASSERT_TRUE(plant.state().omega_rad_s < 0.0);
    const plant::Energy &energy = plant.energy();
    TEST_ASSERT_TRUE(energy.spring < 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * energy.kinetic, -energy.spring,
                              energy.kinetic + energy.friction + energy.damping + energy.magnetic +
                                  energy.copper + energy.diode - energy.supplied);
}

/* ---- sensing ---- */

plant::Config sensed()
{
    plant::Config config = bench::config();
    config.sensors.exact = false;
    config.sensors.current_noise_rms_A = 0.0;
    config.sensors.phase_voltage_noise_rms_V = 0.0;
    return config;
}

void test_unlike_dividers_show_the_bus_while_the_bridge_is_on()
{
    plant::Config config = sensed();
    config.sensors.divider_mismatch_a = 0.01;
    config.sensors.divider_mismatch_b = -0.02;
    plant::Plant plant(config);
    const double code_V = plant::phase_voltage_V_per_code(config.sensors);
    bench::run(plant, bench::off(), 2);
    TEST_ASSERT_EQUAL_INT(0, plant.samples().phase_voltage_a);
    bench::run(plant, bench::voltages(0.0, 0.0), 2);
    TEST_ASSERT_DOUBLE_WITHIN(0.51 * code_V, 0.24, code_V * plant.samples().phase_voltage_a);
    TEST_ASSERT_DOUBLE_WITHIN(0.51 * code_V, -0.48, code_V * plant.samples().phase_voltage_b);
}

void test_a_residual_comes_with_the_first_voltage_and_goes_with_the_bridge()
{
    plant::Config config = sensed();
    config.motor.torque_constant_Nm_A = 0.0;
    config.sensors.current_residual_a_A = 0.1;
    config.sensors.phase_voltage_residual_b_V = 0.5;
    plant::Plant plant(config);
    const double code_A = plant::current_A_per_code(config.sensors);
    const double code_V = plant::phase_voltage_V_per_code(config.sensors);
    const auto seen_A = [&] { return code_A * (plant.samples().current_a - 2048); };
    bench::run(plant, bench::voltages(0.0, 0.0), 100);
    TEST_ASSERT_EQUAL_INT(2048, plant.samples().current_a);
    TEST_ASSERT_EQUAL_INT(0, plant.samples().phase_voltage_b);
    bench::run(plant, bench::voltages(0.0, 0.1), 1);
    bench::run(plant, bench::voltages(0.0, 0.0), 100);
    TEST_ASSERT_DOUBLE_WITHIN(0.51 * code_A, 0.1, seen_A());
    TEST_ASSERT_DOUBLE_WITHIN(0.51 * code_V, 0.5, code_V * plant.samples().phase_voltage_b);
    bench::run(plant, bench::off(), 100);
    TEST_ASSERT_EQUAL_INT(2048, plant.samples().current_a);
}

/* ---- what is refused ---- */

void refuses(const plant::Config &config, const char *field)
{
    try {
        plant::Plant plant(config);
    } catch (const std::invalid_argument &refusal) {
        TEST_ASSERT_TRUE(std::string(refusal.what()).rfind(field, 0) == 0);
        return;
    }
    TEST_FAIL_MESSAGE(field);
}

void test_what_no_motor_has_is_refused_by_name()
{
    using Imperfections = plant::ImperfectionConfig;
    const auto with = [](double Imperfections::*member, double value) {
        plant::Config config = bench::config();
        config.imperfections.rated_current_A = rated_A;
        config.imperfections.iron.hysteresis = 0.01;
        config.imperfections.*member = value;
        return config;
    };
    refuses(with(&Imperfections::resistance_a_scale, 3.0), "resistance_a_scale");
    refuses(with(&Imperfections::inductance_b_scale, 0.1), "inductance_b_scale");
    refuses(with(&Imperfections::magnet_rise_K, 300.0), "magnet_rise_K");
    refuses(with(&Imperfections::rated_current_A, 0.0), "hysteresis");
    plant::Config config = as_built();
    config.imperfections.belt.inertia_share = 1.0;
    refuses(config, "belt_inertia_share");
    config = as_built();
    config.imperfections.iron.eddy_time_s = 1.0;
    refuses(config, "eddy_time_s");
    config = as_built();
    config.sensors.divider_mismatch_a = 0.2;
    refuses(config, "divider_mismatch_a");
    config = as_built();
    config.stops = {0.1, 0.1, 100.0, 0.1};
    refuses(config, "stop_low_rad");
    config.stops = {-1e8, 0.1, 100.0, 0.1};
    refuses(config, "stop_low_rad");
    config.stops = {-0.1, 1e8, 100.0, 0.1};
    refuses(config, "stop_high_rad");
    config.stops = {-0.1, 0.1, 0.0, 0.1};
    refuses(config, "stop_stiffness_Nm_rad");
    config.stops = {-0.1, 0.1, 100.0, 3.0};
    refuses(config, "stop_damping");
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_a_loop_of_flux_loses_what_hysteresis_encloses);
    RUN_TEST(test_iron_keeps_a_current_after_its_voltage);
    RUN_TEST(test_the_iron_drags_a_rotor_that_is_turned);
    RUN_TEST(test_eddy_currents_follow_the_voltage_with_their_lag);
    RUN_TEST(test_each_phase_has_its_own_resistance_and_inductance);
    RUN_TEST(test_unlike_inductances_leave_the_open_motor_as_it_is);
    RUN_TEST(test_a_warm_magnet_has_less_flux_and_less_detent);
    RUN_TEST(test_a_magnet_that_warms_leaves_the_currents_and_ends_where_a_warm_one_is);
    RUN_TEST(test_two_masses_swing_as_a_damped_oscillator);
    RUN_TEST(test_a_jammed_rotor_leaves_the_load_swinging);
    RUN_TEST(test_all_the_energy_is_found_again_in_motion);
    RUN_TEST(test_and_while_it_coasts_down_and_its_currents_end);
    RUN_TEST(test_and_in_stops_of_the_machine_and_of_a_plain_motor);
    RUN_TEST(test_stops_that_come_where_the_rotor_is_bring_no_energy);
    RUN_TEST(test_unlike_dividers_show_the_bus_while_the_bridge_is_on);
    RUN_TEST(test_a_residual_comes_with_the_first_voltage_and_goes_with_the_bridge);
    RUN_TEST(test_what_no_motor_has_is_refused_by_name);
    return UNITY_END();
}
