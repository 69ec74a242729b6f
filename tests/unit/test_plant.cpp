/* The plant as the board sees it: when duties act, what changes at once, what is refused. */
#include <cstring>
#include <limits>
#include <stdexcept>
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

plant::Config delayed(plant::BridgeModel model)
{
    plant::Config config = bench::config();
    config.bridge.model = model;
    config.bridge.delay_periods = 1;
    return config;
}

void acts_one_period_late(plant::BridgeModel model)
{
    plant::Plant plant(delayed(model));
    plant.step(bench::voltages(6.0, 0.0)); /* computed from S(0), acts from S(1) to S(2) */
    TEST_ASSERT_TRUE(plant.state().i_a_A == 0.0);
    TEST_ASSERT_TRUE(plant.state().u_a_V == 0.0);
    plant.step(bench::voltages(-6.0, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.6, 6.0, plant.state().u_a_V);
    TEST_ASSERT_TRUE(plant.state().i_a_A > 0.5);
    plant.step(bench::voltages(0.0, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.6, -6.0, plant.state().u_a_V);
}

void test_duties_act_exactly_one_period_late_on_a_switched_bridge()
{
    acts_one_period_late(plant::BridgeModel::switched);
}

void test_duties_act_exactly_one_period_late_on_an_averaged_bridge()
{
    acts_one_period_late(plant::BridgeModel::averaged);
}

void test_without_delay_duties_act_at_once()
{
    plant::Plant plant(bench::ideal());
    plant.step(bench::voltages(4.8, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4.8, plant.state().u_a_V);
}

void test_the_bridge_opens_at_once_and_closes_with_its_duties()
{
    plant::Plant plant(delayed(plant::BridgeModel::switched));
    bench::run(plant, bench::voltages(2.0, 0.0), 50);
    const double before_A = plant.state().i_a_A;
    plant.step(bench::off());
    TEST_ASSERT_TRUE(plant.state().i_a_A < before_A - 1.0);
    bench::run(plant, bench::off(), 10);
    TEST_ASSERT_TRUE(plant.state().i_a_A == 0.0);
    plant.step(bench::voltages(6.0, 0.0));
    TEST_ASSERT_TRUE(plant.state().i_a_A == 0.0);
    plant.step(bench::voltages(6.0, 0.0));
    TEST_ASSERT_TRUE(plant.state().i_a_A > 0.5);
}

void test_a_load_torque_acts_from_the_present_instant()
{
    plant::Plant plant(bench::config());
    plant.set_load_torque(0.1);
    TEST_ASSERT_TRUE(plant.state().load_torque_Nm == 0.1);
    plant.step(bench::off());
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, -0.1 / bench::inertia_kgm2 * bench::period_s,
                              plant.state().omega_rad_s);
}

void test_period_means_agree_with_what_an_averaged_bridge_would_do()
{
    plant::Config config = bench::config();
    config.bridge.dead_time_s = 0.0;
    config.initial_omega_rad_s = 30.0;
    plant::Plant switched(config);
    config.bridge.model = plant::BridgeModel::averaged;
    plant::Plant averaged(config);
    for (int k = 0; k < 500; k++) {
        const plant::Duties duties = bench::rotor_voltages(averaged, 0.0, 6.0);
        switched.step(duties);
        averaged.step(duties);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, averaged.state().u_a_V, switched.state().u_a_V);
        TEST_ASSERT_DOUBLE_WITHIN(3e-3, averaged.state().i_a_A, switched.state().i_a_A);
    }
}

void test_currents_are_sampled_at_the_instant_and_voltages_as_means()
{
    plant::Plant plant(bench::config());
    bench::run(plant, bench::voltages(3.0, -2.0), 30);
    const plant::State &state = plant.state();
    const plant::Samples &samples = plant.samples();
    TEST_ASSERT_INT_WITHIN(1, 32768 + std::lround(state.i_a_A * 65536 / 12.0), samples.current_a);
    TEST_ASSERT_INT_WITHIN(1, 32768 + std::lround(state.i_b_A * 65536 / 12.0), samples.current_b);
    TEST_ASSERT_INT_WITHIN(1, std::lround(state.u_a_V * 65536 / 62.4), samples.phase_voltage_a);
    TEST_ASSERT_INT_WITHIN(1, std::lround(state.u_b_V * 65536 / 62.4), samples.phase_voltage_b);
}

void test_a_runaway_motor_does_not_hang_the_simulation()
{
    plant::Config config = bench::config();
    config.motor.inertia_kgm2 = 1e-9;
    plant::Plant plant(config);
    plant.set_load_torque(-1000.0);
    bench::run(plant, bench::voltages(6.0, 0.0), 2);
}

template <typename Change> void refuses(const char *field, Change change)
{
    plant::Config config = bench::config();
    change(config);
    try {
        plant::Plant plant(config);
    } catch (const std::invalid_argument &error) {
        TEST_ASSERT_NOT_NULL_MESSAGE(std::strstr(error.what(), field), error.what());
        return;
    }
    TEST_FAIL_MESSAGE(field);
}

void test_impossible_configurations_are_refused_by_the_name_of_the_field()
{
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr double inf = std::numeric_limits<double>::infinity();
    refuses("inductance_H", [](plant::Config &c) { c.motor.inductance_H = -1e-3; });
    refuses("inductance_H", [](plant::Config &c) { c.motor.inductance_H = 0.0; });
    refuses("resistance_ohm", [](plant::Config &c) { c.motor.resistance_ohm = nan; });
    refuses("torque_constant_Nm_A", [](plant::Config &c) { c.motor.torque_constant_Nm_A = inf; });
    refuses("viscous_friction_Nms_rad",
            [](plant::Config &c) { c.motor.viscous_friction_Nms_rad = -1.0; });
    refuses("inertia_kgm2", [](plant::Config &c) { c.motor.inertia_kgm2 = 0.0; });
    refuses("rotor_teeth", [](plant::Config &c) { c.motor.rotor_teeth = 0; });
    refuses("bus_V", [](plant::Config &c) { c.bridge.bus_V = 0.0; });
    refuses("period_s", [](plant::Config &c) { c.bridge.period_s = 0.0; });
    refuses("half_period_counts", [](plant::Config &c) { c.bridge.half_period_counts = 70000; });
    refuses("dead_time_s", [](plant::Config &c) { c.bridge.dead_time_s = 1e-4; });
    refuses("diode_drop_V", [](plant::Config &c) { c.bridge.diode_drop_V = -0.1; });
    refuses("delay_periods", [](plant::Config &c) { c.bridge.delay_periods = 2; });
    refuses("current_range_A", [](plant::Config &c) { c.sensors.current_range_A = 0.0; });
    refuses("current_noise_rms_A", [](plant::Config &c) { c.sensors.current_noise_rms_A = -1.0; });
    refuses("converter_crosstalk_codes",
            [](plant::Config &c) { c.sensors.converter_crosstalk_codes = -1.0; });
    refuses("phase_voltage_offset_a_V",
            [](plant::Config &c) { c.sensors.phase_voltage_offset_a_V = nan; });
    refuses("initial_theta_rad", [](plant::Config &c) { c.initial_theta_rad = nan; });
    refuses("initial_omega_rad_s", [](plant::Config &c) { c.initial_omega_rad_s = inf; });
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_duties_act_exactly_one_period_late_on_a_switched_bridge);
    RUN_TEST(test_duties_act_exactly_one_period_late_on_an_averaged_bridge);
    RUN_TEST(test_without_delay_duties_act_at_once);
    RUN_TEST(test_the_bridge_opens_at_once_and_closes_with_its_duties);
    RUN_TEST(test_a_load_torque_acts_from_the_present_instant);
    RUN_TEST(test_period_means_agree_with_what_an_averaged_bridge_would_do);
    RUN_TEST(test_currents_are_sampled_at_the_instant_and_voltages_as_means);
    RUN_TEST(test_a_runaway_motor_does_not_hang_the_simulation);
    RUN_TEST(test_impossible_configurations_are_refused_by_the_name_of_the_field);
    return UNITY_END();
}
