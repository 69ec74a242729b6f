/* The plant `real`: detent, flux harmonic, Coulomb friction and the bus in closed form, and the
   energy of all of it. */
#include <cstring>
#include <stdexcept>
#include <unity.h>

#include "sil/plant/motor.h"
#include "sil/plant/real_motor.h"
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

plant::Config real()
{
    plant::Config config = bench::config();
    config.imperfections = {rated_A, 0.10, 0.02, 0.05, 0.015, 0.0075, 0.015, 0.22};
    config.supply = {0.1, 470e-6, 10.0, 30.0};
    return config;
}

/* One effect alone, on a motor without friction. */
plant::Config frictionless()
{
    plant::Config config = bench::config();
    config.motor.viscous_friction_Nms_rad = 0.0;
    config.imperfections.rated_current_A = rated_A;
    return config;
}

/* ---- against the plain motor ---- */

struct Pair {
    explicit Pair(const plant::Config &config)
        : bridge(config.bridge), unit_bridge(of_one_volt(config.bridge)),
          plain(config.motor, config.initial_theta_rad, config.initial_omega_rad_s, true),
          real(config)
    {
    }

    static plant::BridgeConfig of_one_volt(plant::BridgeConfig config)
    {
        config.bus_V = 1.0;
        config.diode_drop_V = 1.0;
        return config;
    }

    void step(const plant::Duties &duties)
    {
        plain.begin_period();
        plain.advance(bridge.period(duties));
        real.begin_period();
        real.advance(unit_bridge.period(duties));
    }

    plant::Bridge bridge, unit_bridge;
    plant::Motor plain;
    plant::RealMotor real;
};

void moves_as_the_plain_motor(const plant::Config &config, double voltage_V, int off_from,
                              double tolerance)
{
    Pair motors(config);
    motors.plain.set_load_torque(0.05);
    motors.real.set_load_torque(0.05);
    for (int k = 0; k < 300; k++) {
        const double angle = bench::rotor_teeth * motors.plain.theta_rad() + 1.5;
        motors.step(k < off_from
                        ? bench::voltages(voltage_V * std::cos(angle), voltage_V * std::sin(angle))
                        : bench::off());
        const plant::Phases current_A = motors.plain.current_A() - motors.real.current_A();
        const plant::Phases voltage_Vs =
            motors.plain.integrals().voltage_Vs - motors.real.integrals().voltage_Vs;
        TEST_ASSERT_DOUBLE_WITHIN(tolerance, 0.0, current_A[0]);
        TEST_ASSERT_DOUBLE_WITHIN(tolerance, 0.0, current_A[1]);
        TEST_ASSERT_DOUBLE_WITHIN(10.0 * tolerance, motors.plain.omega_rad_s(),
                                  motors.real.omega_rad_s());
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * tolerance, motors.plain.theta_rad(),
                                  motors.real.theta_rad());
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * tolerance, 0.0, voltage_Vs[0]);
    }
    TEST_ASSERT_DOUBLE_WITHIN(tolerance,
                              motors.plain.magnetic_J() + motors.plain.integrals().copper_J,
                              motors.real.magnetic_J() + motors.real.integrals().copper_J);
}

void test_with_every_effect_off_it_is_the_plain_motor()
{
    plant::Config config = bench::config();
    config.bridge.period_s = 1e-5; /* the lower orders of the series show in 100 us */
    config.bridge.dead_time_s = 1e-7;
    moves_as_the_plain_motor(config, 9.0, 300, 1e-6);
    config.initial_omega_rad_s = 45.0;
    moves_as_the_plain_motor(config, 9.0, 100, 1e-6);
    config.bridge.model = plant::BridgeModel::averaged;
    moves_as_the_plain_motor(config, 9.0, 300, 1e-6);
}

void test_in_periods_of_100_us_the_lower_orders_cost_ten_microamperes()
{
    plant::Config config = bench::config();
    moves_as_the_plain_motor(config, 9.0, 300, 1e-5);
    moves_as_the_plain_motor(config, 0.4, 300, 1e-5);
    config.initial_omega_rad_s = 45.0;
    moves_as_the_plain_motor(config, 9.0, 100, 1e-5);
}

/* ---- magnetic circuit ---- */

void test_open_circuit_voltage_has_the_third_harmonic()
{
    plant::Config config = frictionless();
    config.imperfections.flux_harmonic_3 = 0.1;
    config.motor.inertia_kgm2 = 1e6;
    config.initial_omega_rad_s = 10.0;
    plant::Plant plant(config);
    const auto flux_linkage_Vs = [](double angle, int phase) {
        const double peak_Vs = bench::torque_constant_Nm_A / bench::rotor_teeth;
        return phase == 0 ? peak_Vs * (std::cos(angle) + 0.1 / 3.0 * std::cos(3.0 * angle))
                          : peak_Vs * (std::sin(angle) - 0.1 / 3.0 * std::sin(3.0 * angle));
    };
    for (int k = 0; k < 200; k++) {
        const double from = bench::rotor_teeth * 10.0 * bench::period_s * k;
        const double to = from + bench::rotor_teeth * 10.0 * bench::period_s;
        plant.step(bench::off());
        TEST_ASSERT_DOUBLE_WITHIN(
            1e-6, (flux_linkage_Vs(to, 0) - flux_linkage_Vs(from, 0)) / bench::period_s,
            plant.state().u_a_V);
        TEST_ASSERT_DOUBLE_WITHIN(
            1e-6, (flux_linkage_Vs(to, 1) - flux_linkage_Vs(from, 1)) / bench::period_s,
            plant.state().u_b_V);
    }
}

void test_the_rotor_swings_about_a_detent_at_its_natural_frequency()
{
    plant::Config config = frictionless();
    config.imperfections.detent_4 = 0.05;
    config.initial_theta_rad = 1e-5; /* 4 N theta = 2 mrad */
    plant::Plant plant(config);
    const double stiffness_Nm_rad = 4.0 * bench::rotor_teeth * 0.05 * holding_Nm;
    const double natural_rad_s = std::sqrt(stiffness_Nm_rad / bench::inertia_kgm2);
    for (int k = 1; k <= 2000; k++) { /* six swings */
        plant.step(bench::off());
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, 1e-5 * std::cos(natural_rad_s * bench::period_s * k),
                                  plant.state().theta_rad);
    }
}

/* ---- Coulomb friction ---- */

void test_a_free_rotor_slows_down_evenly_and_stays_where_it_stops()
{
    plant::Config config = frictionless();
    config.imperfections.coulomb_friction = 0.015;
    config.initial_omega_rad_s = 5.0;
    plant::Plant plant(config);
    const double deceleration = 0.015 * holding_Nm / bench::inertia_kgm2;
    for (int k = 1; k <= 1200; k++) {
        plant.step(bench::off());
        const double time_s = std::fmin(bench::period_s * k, 5.0 / deceleration);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 5.0 - deceleration * time_s, plant.state().omega_rad_s);
        TEST_ASSERT_DOUBLE_WITHIN(1e-11, (5.0 - 0.5 * deceleration * time_s) * time_s,
                                  plant.state().theta_rad);
    }
    TEST_ASSERT_TRUE(plant.state().omega_rad_s == 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.5 * bench::inertia_kgm2 * 25.0, plant.energy().coulomb);
}

void test_it_sticks_below_the_friction_torque_and_breaks_away_above()
{
    plant::Config config = frictionless();
    config.imperfections.coulomb_friction = 0.015;
    const double friction_Nm = 0.015 * holding_Nm;
    for (const double sign : {1.0, -1.0}) {
        plant::Plant plant(config);
        plant.set_load_torque(sign * 0.999 * friction_Nm);
        bench::run(plant, bench::off(), 100);
        TEST_ASSERT_TRUE(plant.state().theta_rad == 0.0 && plant.state().omega_rad_s == 0.0);
        plant.set_load_torque(sign * 1.5 * friction_Nm);
        bench::run(plant, bench::off(), 100);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, -sign * 0.5 * friction_Nm / bench::inertia_kgm2 * 1e-2,
                                  plant.state().omega_rad_s);
    }
}

void test_a_rising_current_breaks_the_rotor_away_where_its_torque_passes_friction()
{
    plant::Config config = frictionless();
    config.bridge.model = plant::BridgeModel::averaged;
    config.imperfections.coulomb_friction = 0.015;
    const double friction_A = 0.015 * holding_Nm / bench::torque_constant_Nm_A; /* in phase b */
    plant::Plant plant(config);
    double last_A = 0.0;
    while (plant.state().omega_rad_s == 0.0) {
        last_A = plant.state().i_b_A;
        plant.step(bench::voltages(0.0, 0.1));
    }
    TEST_ASSERT_TRUE(last_A <= friction_A && plant.state().i_b_A > friction_A);
}

/* ---- bus ---- */

void test_an_unloaded_bus_returns_to_the_source_as_the_exponential()
{
    plant::Config config = real();
    config.motor.inertia_kgm2 = 1e6;
    plant::Plant plant(config);
    bench::run(plant, bench::voltages(23.0, 0.0), 3);
    plant.step(bench::voltages(0.0, 0.0)); /* whatever the dead times leave */
    plant::Duties low;
    low.bridge_on = true;
    plant.step(low);
    double below_V = 24.0 - plant.state().bus_V;
    TEST_ASSERT_TRUE(below_V > 1e-4);
    for (int k = 0; k < 5; k++) {
        plant.step(low);
        below_V *= std::exp(-bench::period_s / 47e-6);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, below_V, 24.0 - plant.state().bus_V);
    }
}

void test_a_steady_current_sags_the_bus_by_the_source_resistance()
{
    plant::Config config = real();
    config.bridge.model = plant::BridgeModel::averaged;
    config.motor.inertia_kgm2 = 1e6;
    plant::Plant plant(config);
    bench::run(plant, bench::voltages(2.4, 0.0), 500); /* a tenth of the bus, whatever it is */
    const double resistance_ohm = bench::resistance_ohm + 0.22;
    /* V = 24 - 0.1 x (i / 10), i = V / 10 / R */
    const double bus_V = 24.0 / (1.0 + 0.1 * 0.1 * 0.1 / resistance_ohm);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, bus_V, plant.state().bus_V);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1 * bus_V, plant.state().u_a_V);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1 * bus_V / resistance_ohm, plant.state().i_a_A);
}

double highest_bus_V(plant::Config config)
{
    config.initial_omega_rad_s = 120.0;
    plant::Plant plant(config);
    double highest_V = 0.0;
    double supplied_J = 0.0;
    for (int k = 0; k < 300; k++) {
        plant.step(bench::rotor_voltages(plant, 0.0, 10.0));
        highest_V = std::fmax(highest_V, plant.state().bus_V);
        TEST_ASSERT_TRUE(plant.energy().supplied >= supplied_J); /* the source takes none back */
        supplied_J = plant.energy().supplied;
    }
    return highest_V;
}

void test_braking_lifts_the_bus_to_the_brake_and_no_further()
{
    plant::Config config = real();
    const double clamped_V = highest_bus_V(config);
    TEST_ASSERT_TRUE(clamped_V > 29.5 && clamped_V < 30.1);
    config.supply.brake_ohm = 0.0;
    TEST_ASSERT_TRUE(highest_bus_V(config) > 35.0);
}

void test_the_bus_charges_by_what_the_source_gives_less_what_the_bridge_takes()
{
    plant::Config config = real();
    config.bridge.model = plant::BridgeModel::averaged;
    config.motor.inertia_kgm2 = 1e6;
    plant::Plant plant(config);
    bench::run(plant, bench::voltages(12.0, 0.0), 3);
    const plant::Energy &e = plant.energy();
    const double source_C = e.supplied / 24.0;
    const double capacitor_C = 470e-6 * (plant.state().bus_V - 24.0);
    /* the bridge's power over the bus voltage: between its bounds */
    const double bridge_J = e.copper + e.magnetic;
    TEST_ASSERT_TRUE(source_C - capacitor_C > bridge_J / 24.0);
    TEST_ASSERT_TRUE(source_C - capacitor_C < bridge_J / plant.state().bus_V);
}

/* ---- energy ---- */

double sum_of_uses(const plant::Energy &e)
{
    return e.copper + e.magnetic + e.kinetic + e.friction + e.load + e.diode + e.coulomb +
           e.source + e.brake + e.capacitor;
}

void balances(const plant::Plant &plant, double turnover_J, double share = 1e-6)
{
    TEST_ASSERT_DOUBLE_WITHIN(share * turnover_J, plant.energy().supplied,
                              sum_of_uses(plant.energy()));
}

/* Short runs at rest are all dead time, in which the series have their lowest order. */
constexpr double share_at_rest = 2e-6;

void test_balances_with_everything_on_while_it_drives_a_load()
{
    for (const plant::BridgeModel model :
         {plant::BridgeModel::switched, plant::BridgeModel::averaged}) {
        plant::Config config = real();
        config.bridge.model = model;
        plant::Plant plant(config);
        plant.set_load_torque(0.1);
        for (int k = 0; k < 3000; k++) {
            plant.step(bench::rotor_voltages(plant, -1.0, 9.0));
        }
        TEST_ASSERT_TRUE(plant.state().omega_rad_s > 15.0);
        TEST_ASSERT_TRUE(plant.energy().coulomb > 1e-3 && plant.energy().source > 1e-3);
        balances(plant, plant.energy().supplied);
    }
}

void test_balances_while_it_brakes_into_the_brake_resistor()
{
    plant::Config config = real();
    config.initial_omega_rad_s = 120.0;
    plant::Plant plant(config);
    for (int k = 0; k < 1000; k++) {
        plant.step(bench::rotor_voltages(plant, 0.0, 10.0));
    }
    TEST_ASSERT_TRUE(plant.energy().brake > 0.01);
    balances(plant, 0.5 * bench::inertia_kgm2 * 120.0 * 120.0);
}

void test_balances_at_rest_with_small_interrupted_currents_and_freewheeling()
{
    plant::Plant plant(real());
    bench::run(plant, bench::voltages(0.7, 0.4), 500);
    balances(plant, plant.energy().supplied, share_at_rest);
    bench::run(plant, bench::voltages(2.0, 1.0), 500);
    bench::run(plant, bench::off(), 100);
    TEST_ASSERT_TRUE(plant.state().i_a_A == 0.0 && plant.state().i_b_A == 0.0);
    balances(plant, plant.energy().supplied, share_at_rest);
}

void test_a_change_of_the_motor_keeps_currents_angle_and_balance()
{
    plant::Config config = real();
    plant::Plant plant(config);
    for (int k = 0; k < 500; k++) {
        plant.step(bench::rotor_voltages(plant, 1.0, 6.0));
    }
    const plant::State before = plant.state();
    plant::MotorConfig other = config.motor;
    other.inductance_H *= 1.1;
    other.torque_constant_Nm_A *= 0.95;
    other.inertia_kgm2 *= 1.3;
    other.resistance_ohm *= 1.4;
    plant.set_motor(other);
    TEST_ASSERT_TRUE(plant.state().omega_rad_s == before.omega_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, before.theta_rad, plant.state().theta_rad);
    for (int k = 0; k < 500; k++) {
        plant.step(bench::rotor_voltages(plant, 1.0, 6.0));
    }
    balances(plant, plant.energy().supplied, share_at_rest);
}

/* ---- sensors ---- */

void test_residual_offsets_appear_with_the_bridge_and_gains_scale_the_current()
{
    plant::Config config = bench::config();
    config.sensors.exact = false;
    config.sensors.current_noise_rms_A = 0.0;
    config.sensors.phase_voltage_noise_rms_V = 0.0;
    config.sensors.current_offset_on_a_A = 30 * 12.0 / 4096.0;
    config.sensors.phase_voltage_offset_on_b_V = 20 * 62.4 / 4096.0;
    config.sensors.current_gain_b = 1.25;
    plant::Plant plant(config);
    plant.step(bench::off());
    TEST_ASSERT_EQUAL_UINT16(2048, plant.samples().current_a);
    TEST_ASSERT_EQUAL_INT16(0, plant.samples().phase_voltage_b);
    plant.step(bench::voltages(0.0, 0.0));
    TEST_ASSERT_EQUAL_UINT16(2048 + 30, plant.samples().current_a);
    TEST_ASSERT_EQUAL_INT16(20, plant.samples().phase_voltage_b);
    bench::run(plant, bench::voltages(0.0, 1.0), 100);
    const double code_A = 12.0 / 4096.0;
    TEST_ASSERT_INT_WITHIN(1, 2048 + std::lround(1.25 * plant.state().i_b_A / code_A),
                           plant.samples().current_b);
}

void refuses(const plant::Config &config, const char *field)
{
    try {
        plant::Plant plant(config);
        TEST_FAIL_MESSAGE("accepted");
    } catch (const std::invalid_argument &refusal) {
        TEST_ASSERT_NOT_NULL(std::strstr(refusal.what(), field));
    }
}

void test_nonsense_is_refused_by_name()
{
    plant::Config config = real();
    config.imperfections.saturation_depth = 0.6;
    refuses(config, "saturation_depth");
    config = real();
    config.imperfections.rated_current_A = 0.0;
    refuses(config, "rated_current_A");
    config = real();
    config.supply.bus_capacitance_F = 1e-9;
    refuses(config, "bus_capacitance_F");
    config = real();
    config.supply.brake_V = 24.0;
    refuses(config, "brake_V");
    config = real();
    config.bridge.bus_V = 0.0;
    refuses(config, "bus_V");
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_with_every_effect_off_it_is_the_plain_motor);
    RUN_TEST(test_in_periods_of_100_us_the_lower_orders_cost_ten_microamperes);
    RUN_TEST(test_open_circuit_voltage_has_the_third_harmonic);
    RUN_TEST(test_the_rotor_swings_about_a_detent_at_its_natural_frequency);
    RUN_TEST(test_a_free_rotor_slows_down_evenly_and_stays_where_it_stops);
    RUN_TEST(test_it_sticks_below_the_friction_torque_and_breaks_away_above);
    RUN_TEST(test_a_rising_current_breaks_the_rotor_away_where_its_torque_passes_friction);
    RUN_TEST(test_an_unloaded_bus_returns_to_the_source_as_the_exponential);
    RUN_TEST(test_a_steady_current_sags_the_bus_by_the_source_resistance);
    RUN_TEST(test_braking_lifts_the_bus_to_the_brake_and_no_further);
    RUN_TEST(test_the_bus_charges_by_what_the_source_gives_less_what_the_bridge_takes);
    RUN_TEST(test_balances_with_everything_on_while_it_drives_a_load);
    RUN_TEST(test_balances_while_it_brakes_into_the_brake_resistor);
    RUN_TEST(test_balances_at_rest_with_small_interrupted_currents_and_freewheeling);
    RUN_TEST(test_a_change_of_the_motor_keeps_currents_angle_and_balance);
    RUN_TEST(test_residual_offsets_appear_with_the_bridge_and_gains_scale_the_current);
    RUN_TEST(test_nonsense_is_refused_by_name);
    return UNITY_END();
}
