/* Energy: what the bus supplies is found again, to 1e-6, whatever the motor does. */
#include <unity.h>

#include "tests/unit/plant_bench.h"

void setUp()
{
}

void tearDown()
{
}

namespace
{

double sum_of_uses(const plant::Energy &e)
{
    return e.copper + e.magnetic + e.kinetic + e.friction + e.load + e.diode;
}

/* `turnover_J`: the energy that changed hands, for runs in which the bus supplies next to none. */
void balances(const plant::Plant &plant, double turnover_J)
{
    const plant::Energy &e = plant.energy();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * turnover_J, e.supplied, sum_of_uses(e));
}

void accelerates_against_a_load(plant::Config config)
{
    plant::Plant plant(config);
    plant.set_load_torque(0.1);
    for (int k = 0; k < 3000; k++) {
        plant.step(bench::rotor_voltages(plant, -1.0, 9.0));
    }
    TEST_ASSERT_TRUE(plant.state().omega_rad_s > 20.0);
    TEST_ASSERT_TRUE(plant.energy().load > 0.1);
    balances(plant, plant.energy().supplied);
}

void test_balances_while_a_switched_bridge_drives_a_load()
{
    accelerates_against_a_load(bench::config());
}

void test_balances_while_an_averaged_bridge_drives_a_load()
{
    accelerates_against_a_load(bench::ideal());
}

void test_a_switched_bridge_loses_energy_in_its_diodes_an_averaged_one_does_not()
{
    plant::Plant switched(bench::config());
    plant::Plant averaged(bench::ideal());
    bench::run(switched, bench::voltages(2.0, 0.0), 500);
    bench::run(averaged, bench::voltages(2.0, 0.0), 500);
    TEST_ASSERT_TRUE(switched.energy().diode > 1e-3 * switched.energy().supplied);
    TEST_ASSERT_TRUE(averaged.energy().diode == 0.0);
}

void test_balances_at_small_currents_that_the_dead_time_interrupts()
{
    plant::Config config = bench::config();
    config.initial_omega_rad_s = 1.0;
    plant::Plant plant(config);
    bench::run(plant, bench::voltages(0.3, 0.1), 500);
    balances(plant, plant.energy().supplied);
}

void test_balances_while_the_current_freewheels_after_the_bridge_opens()
{
    plant::Plant plant(bench::config());
    bench::run(plant, bench::voltages(1.5, 1.0), 200);
    bench::run(plant, bench::off(), 20);
    TEST_ASSERT_TRUE(plant.state().i_a_A == 0.0);
    balances(plant, plant.energy().copper);
}

void test_balances_while_a_driven_rotor_feeds_the_bus()
{
    plant::Config config = bench::config();
    config.initial_omega_rad_s = 300.0; /* 47 V of back-EMF against 24 V and two diodes */
    plant::Plant plant(config);
    plant.set_load_torque(-0.3);
    bench::run(plant, bench::off(), 1000);
    TEST_ASSERT_TRUE(plant.energy().supplied < -0.1);
    TEST_ASSERT_TRUE(plant.energy().diode > 0.0);
    balances(plant, -plant.energy().supplied);
}

void test_without_losses_the_supplied_energy_is_all_stored()
{
    plant::Config config = bench::ideal();
    config.motor.resistance_ohm = 0.0;
    config.motor.viscous_friction_Nms_rad = 0.0;
    plant::Plant plant(config);
    for (int k = 0; k < 40; k++) {
        plant.step(bench::rotor_voltages(plant, 0.0, 3.0));
    }
    const plant::Energy &e = plant.energy();
    TEST_ASSERT_TRUE(e.supplied > 1e-3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * e.supplied, e.supplied, e.magnetic + e.kinetic);
}

void test_a_shorted_lossless_motor_exchanges_energy_and_keeps_it()
{
    plant::Config config = bench::ideal();
    config.motor.resistance_ohm = 0.0;
    config.motor.viscous_friction_Nms_rad = 0.0;
    config.initial_omega_rad_s = 20.0;
    plant::Plant plant(config);
    const double all_J = 0.5 * bench::inertia_kgm2 * 20.0 * 20.0;
    bool exchanged = false;
    for (int k = 0; k < 2000; k++) {
        plant.step(bench::voltages(0.0, 0.0));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6 * all_J, 0.0,
                                  plant.energy().magnetic + plant.energy().kinetic);
        exchanged = exchanged || plant.energy().magnetic > 0.02 * all_J;
    }
    TEST_ASSERT_TRUE(exchanged);
}

void test_a_change_of_inductance_or_inertia_does_not_enter_the_balance()
{
    plant::Config config = bench::config();
    plant::Plant plant(config);
    for (int k = 0; k < 500; k++) {
        plant.step(bench::rotor_voltages(plant, 1.0, 6.0));
    }
    plant::MotorConfig other = config.motor;
    other.inductance_H *= 1.1;
    other.inertia_kgm2 *= 1.3;
    const double omega_rad_s = plant.state().omega_rad_s;
    plant.set_motor(other);
    TEST_ASSERT_TRUE(plant.state().omega_rad_s == omega_rad_s);
    for (int k = 0; k < 500; k++) {
        plant.step(bench::rotor_voltages(plant, 1.0, 6.0));
    }
    balances(plant, plant.energy().supplied);
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_balances_while_a_switched_bridge_drives_a_load);
    RUN_TEST(test_balances_while_an_averaged_bridge_drives_a_load);
    RUN_TEST(test_a_switched_bridge_loses_energy_in_its_diodes_an_averaged_one_does_not);
    RUN_TEST(test_balances_at_small_currents_that_the_dead_time_interrupts);
    RUN_TEST(test_balances_while_the_current_freewheels_after_the_bridge_opens);
    RUN_TEST(test_balances_while_a_driven_rotor_feeds_the_bus);
    RUN_TEST(test_without_losses_the_supplied_energy_is_all_stored);
    RUN_TEST(test_a_shorted_lossless_motor_exchanges_energy_and_keeps_it);
    RUN_TEST(test_a_change_of_inductance_or_inertia_does_not_enter_the_balance);
    return UNITY_END();
}
