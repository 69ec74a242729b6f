/* What drifts and fails in a run: jam, broken lead, bus, converters, and the filter of the phase
   voltages; against closed forms, with the balance of energy. */
#include <stdexcept>
#include <string>
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

constexpr double speed_rad_s = 40.0;
constexpr double L = bench::inductance_H, R = bench::resistance_ohm, T = bench::period_s;
constexpr double code_A = 12.0 / 4096.0;

plant::Config coasting(plant::Config config)
{
    config.motor.viscous_friction_Nms_rad = 0.0;
    config.initial_omega_rad_s = speed_rad_s;
    return config;
}

/* Rotor so heavy that it does not move: windings only. */
plant::Config at_rest(plant::Config config)
{
    config.motor.inertia_kgm2 = 1e6;
    return config;
}

plant::Config noisy()
{
    plant::Config config = at_rest(bench::config());
    config.sensors.exact = false;
    return config;
}

void balances(const plant::Plant &plant, double turnover_J)
{
    const plant::Energy &e = plant.energy();
    const double uses = e.copper + e.magnetic + e.kinetic + e.friction + e.load + e.diode +
                        e.coulomb + e.arc + e.source + e.brake + e.capacitor;
    TEST_ASSERT_DOUBLE_WITHIN(2e-6 * turnover_J, e.supplied, uses);
}

/* ---- jam ---- */

void test_a_jam_stops_the_rotor_within_its_period_and_takes_its_kinetic_energy()
{
    for (const bool real : {false, true}) {
        plant::Config config = coasting(bench::config());
        config.imperfections.bridge_resistance_ohm = real ? 0.2 : 0.0;
        plant::Plant plant(config);
        bench::run(plant, bench::voltages(3.0, 2.0), 7);
        const double before_J =
            0.5 * bench::inertia_kgm2 * plant.state().omega_rad_s * plant.state().omega_rad_s;
        const double theta_rad = plant.state().theta_rad;
        plant.jam(plant::Plant::held_Nm);
        TEST_ASSERT_TRUE(plant.state().omega_rad_s == 0.0);
        bench::run(plant, bench::voltages(3.0, 2.0), 200);
        TEST_ASSERT_TRUE(plant.state().omega_rad_s == 0.0);
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, theta_rad, plant.state().theta_rad);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, before_J, plant.energy().coulomb);
        balances(plant, plant.energy().supplied + before_J);
    }
}

void test_a_jam_of_a_finite_torque_brakes_evenly_and_lets_go_of_the_rotor_when_freed()
{
    constexpr double jam_Nm = 0.5;
    plant::Plant plant(coasting(bench::config()));
    bench::run(plant, bench::off(), 10);
    const double turned_rad = plant.state().theta_rad;
    plant.jam(jam_Nm);
    bench::run(plant, bench::off(), 200);
    const double way_rad = 0.5 * bench::inertia_kgm2 * speed_rad_s * speed_rad_s / jam_Nm;
    TEST_ASSERT_TRUE(plant.state().omega_rad_s == 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, turned_rad + way_rad, plant.state().theta_rad);
    plant.set_load_torque(-0.99 * jam_Nm);
    bench::run(plant, bench::off(), 20);
    TEST_ASSERT_TRUE(plant.state().omega_rad_s == 0.0);
    plant.jam(0.0);
    bench::run(plant, bench::off(), 20);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.99 * jam_Nm / bench::inertia_kgm2 * 20 * T,
                              plant.state().omega_rad_s);
    balances(plant, 0.2);
}

void test_a_jump_of_the_inertia_keeps_the_speed()
{
    plant::Config config = coasting(bench::config());
    plant::Plant plant(config);
    bench::run(plant, bench::off(), 5);
    config.motor.inertia_kgm2 *= 1000.0;
    plant.set_motor(config.motor);
    TEST_ASSERT_TRUE(plant.state().omega_rad_s == speed_rad_s);
    plant.set_load_torque(0.1);
    bench::run(plant, bench::off(), 100);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, speed_rad_s - 0.1 / config.motor.inertia_kgm2 * 100 * T,
                              plant.state().omega_rad_s);
}

/* ---- broken lead ---- */

void test_a_broken_lead_ends_its_current_at_once_and_its_energy_goes_into_the_arc()
{
    for (const plant::BridgeModel model :
         {plant::BridgeModel::switched, plant::BridgeModel::averaged}) {
        plant::Config config = at_rest(bench::config());
        config.bridge.model = model;
        plant::Plant plant(config);
        bench::run(plant, bench::voltages(1.0, 0.8), 300);
        const double i_A = plant.state().i_a_A;
        TEST_ASSERT_TRUE(i_A > 0.5);
        plant.open_phase(0, true);
        for (int k = 0; k < 300; k++) {
            TEST_ASSERT_TRUE(plant.state().i_a_A == 0.0);
            plant.step(bench::voltages(1.0, 0.8));
        }
        TEST_ASSERT_TRUE(plant.state().i_b_A > 0.5);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.5 * L * i_A * i_A, plant.energy().arc);
        balances(plant, plant.energy().supplied);
    }
}

/* The bridge's terminals are measured, which it goes on driving, not what the winding induces. */
void test_the_voltage_of_a_broken_phase_is_that_of_the_bridge()
{
    plant::Config config = coasting(bench::config());
    plant::Plant plant(config);
    plant.open_phase(0, true);
    bench::run(plant, bench::voltages(4.8, 0.0), 3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4.8, plant.state().u_a_V);
    bench::run(plant, bench::off(), 3);
    TEST_ASSERT_TRUE(plant.state().u_a_V == 0.0);
}

/* However fast it turns: the diodes do not brake a rotor whose windings are open. */
void test_a_rotor_with_both_leads_broken_charges_no_bus()
{
    plant::Config config = coasting(bench::config());
    config.initial_omega_rad_s = 260.0;
    plant::Plant plant(config);
    plant.open_phase(0, true);
    plant.open_phase(1, true);
    bench::run(plant, bench::off(), 100);
    TEST_ASSERT_TRUE(plant.state().i_a_A == 0.0 && plant.state().i_b_A == 0.0);
    TEST_ASSERT_TRUE(plant.state().omega_rad_s == 260.0);
}

void test_a_lead_that_is_joined_again_lets_the_current_rise_as_the_exponential()
{
    constexpr double u_V = 4.8;
    plant::Plant plant(at_rest(bench::ideal()));
    plant.open_phase(0, true);
    bench::run(plant, bench::voltages(u_V, 0.0), 50);
    plant.open_phase(0, false);
    bench::run(plant, bench::voltages(u_V, 0.0), 20);
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, u_V / R * (1.0 - std::exp(-20 * T * R / L)),
                              plant.state().i_a_A);
}

/* The first fault makes a real motor of the plain one: nothing else may show it. */
void test_the_plain_motor_goes_on_where_it_was()
{
    plant::Config config = bench::config();
    plant::Plant plain(config);
    plant::Plant changed(config);
    plain.set_load_torque(0.05);
    changed.set_load_torque(0.05);
    for (int k = 0; k < 2000; k++) {
        if (k == 1000) {
            changed.open_phase(1, false);
        }
        const plant::Duties duties = bench::rotor_voltages(plain, -1.0, 9.0);
        plain.step(duties);
        changed.step(duties);
    }
    TEST_ASSERT_DOUBLE_WITHIN(3e-5, plain.state().i_a_A, changed.state().i_a_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, plain.state().omega_rad_s, changed.state().omega_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, plain.state().theta_rad, changed.state().theta_rad);
    balances(changed, changed.energy().supplied);
}

/* ---- bus ---- */

void test_a_stiff_bus_drives_with_its_new_voltage_from_the_same_period_on()
{
    for (const double bridge_ohm : {0.0, 0.2}) {
        plant::Config config = at_rest(bench::config());
        config.imperfections.bridge_resistance_ohm = bridge_ohm;
        plant::Plant sagged(config);
        sagged.set_bus(18.0);
        TEST_ASSERT_TRUE(sagged.state().bus_V == 18.0);
        config.bridge.bus_V = 18.0;
        plant::Plant low(config);
        const plant::Duties duties = bench::voltages(5.0, -3.0);
        bench::run(sagged, duties, 30);
        bench::run(low, duties, 30);
        TEST_ASSERT_TRUE(sagged.state().i_a_A == low.state().i_a_A);
        TEST_ASSERT_TRUE(sagged.state().u_b_V == low.state().u_b_V);
        balances(sagged, sagged.energy().supplied);
    }
}

/* A leg that is high all through has no edge at which it could take the new voltage. */
void test_a_leg_that_stays_high_follows_the_bus()
{
    plant::Duties high;
    high.bridge_on = true;
    high.high_counts[0] = bench::half_counts;
    plant::Plant plant(at_rest(bench::config()));
    bench::run(plant, high, 2);
    plant.set_bus(18.0);
    bench::run(plant, high, 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 18.0, plant.state().u_a_V);
}

void test_a_capacitor_charges_to_the_new_source_and_keeps_its_charge_above_it()
{
    plant::Config config = at_rest(bench::config());
    config.supply.bus_source_ohm = 0.1;
    plant::Plant plant(config);
    plant.set_bus(26.0);
    bench::run(plant, bench::off(), 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 26.0 - 2.0 * std::exp(-T / (0.1 * 470e-6)),
                              plant.state().bus_V);
    bench::run(plant, bench::off(), 20);
    plant.set_bus(18.0);
    bench::run(plant, bench::off(), 20);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 26.0, plant.state().bus_V);
    balances(plant, plant.energy().supplied);
}

/* ---- converters ---- */

void test_a_stuck_converter_keeps_its_code_until_it_is_released()
{
    plant::Plant plant(noisy());
    bench::run(plant, bench::voltages(1.0, 1.0), 200);
    const int last = plant.samples().current_a;
    plant.stick(plant::Channel::current_a);
    plant.stick(plant::Channel::phase_voltage_b, -1234);
    bench::run(plant, bench::voltages(-1.0, -1.0), 200);
    TEST_ASSERT_EQUAL_INT(last, plant.samples().current_a);
    TEST_ASSERT_EQUAL_INT(-1234, plant.samples().phase_voltage_b);
    plant.release(plant::Channel::current_a);
    bench::run(plant, bench::voltages(-1.0, -1.0), 1);
    TEST_ASSERT_INT_WITHIN(10, 2048 + static_cast<int>(plant.state().i_a_A / code_A),
                           plant.samples().current_a);
    TEST_ASSERT_EQUAL_INT(-1234, plant.samples().phase_voltage_b);
}

void test_noise_has_the_rms_that_was_asked_for_and_no_mean()
{
    constexpr int periods = 20000;
    constexpr double rms_codes = 40.0;
    plant::Config config = at_rest(bench::config());
    plant::Plant quiet(config);
    plant::Plant loud(config);
    loud.add_noise(plant::Channel::bus_voltage, rms_codes);
    double sum = 0.0, squares = 0.0;
    for (int k = 0; k < periods; k++) {
        quiet.step(bench::off());
        loud.step(bench::off());
        const double noise = loud.samples().bus_voltage - quiet.samples().bus_voltage;
        sum += noise;
        squares += noise * noise;
    }
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * rms_codes / std::sqrt(periods), 0.0, sum / periods);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * rms_codes, rms_codes, std::sqrt(squares / periods));
    TEST_ASSERT_EQUAL_INT(quiet.samples().current_a, loud.samples().current_a);
    loud.add_noise(plant::Channel::bus_voltage, 0.0);
    loud.step(bench::off());
    TEST_ASSERT_EQUAL_INT(quiet.samples().bus_voltage, loud.samples().bus_voltage);
}

void test_the_bridge_is_as_hot_as_it_is_set()
{
    plant::Plant plant(noisy());
    plant.step(bench::off());
    TEST_ASSERT_EQUAL_INT(2048, plant.samples().bridge_temperature);
    plant.set_bridge_temperature(100.0); /* 0.987 of 10 kOhm */
    plant.step(bench::off());
    TEST_ASSERT_INT_WITHIN(2, 368, plant.samples().bridge_temperature);
    plant.set_bridge_temperature(0.0); /* 28.7 */
    plant.step(bench::off());
    TEST_ASSERT_INT_WITHIN(4, 3037, plant.samples().bridge_temperature);
    plant.stick(plant::Channel::bridge_temperature, 0);
    plant.step(bench::off());
    TEST_ASSERT_EQUAL_INT(0, plant.samples().bridge_temperature);
}

void test_offsets_and_gains_that_drift_reach_the_next_samples()
{
    plant::Config config = noisy();
    config.sensors.current_noise_rms_A = 0.0;
    plant::Plant plant(config);
    config.sensors.current_offset_b_A = 20.0 * code_A;
    plant.stick(plant::Channel::current_a, 7);
    plant.set_sensors(config.sensors);
    plant.step(bench::off());
    TEST_ASSERT_EQUAL_INT(2068, plant.samples().current_b);
    TEST_ASSERT_EQUAL_INT(7, plant.samples().current_a); /* a fault outlives the drift */
}

/* ---- filter of the phase voltages ---- */

constexpr double tf = 10e-6;

/* Filtered voltage from the codes of exact sensing, to half a code. */
double measured_V(const plant::Plant &plant)
{
    return plant.samples().phase_voltage_a * (2.0 * 31.2 / 65536);
}

constexpr double half_code_V = 31.2 / 65536;

void test_the_filter_delays_the_mean_of_a_step_as_its_exponential()
{
    constexpr double u_V = 4.8;
    plant::Config config = at_rest(bench::ideal());
    config.imperfections.phase_voltage_filter_s = tf;
    plant::Plant plant(config);
    for (int k = 0; k < 3; k++) {
        plant.step(bench::voltages(u_V, 0.0));
        /* u - tf / T (v(end) - v(begin)) with v = u (1 - exp(-t / tf)) */
        const double change = std::exp(-k * T / tf) - std::exp(-(k + 1) * T / tf);
        TEST_ASSERT_DOUBLE_WITHIN(1.01 * half_code_V, u_V * (1.0 - tf / T * change),
                                  measured_V(plant));
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, u_V, plant.state().u_a_V);
    }
}

/* Pulses without dead time; each edge leaves its own exponential at the period's end. */
void test_the_filter_takes_every_edge_of_a_switched_bridge()
{
    plant::Config config = at_rest(bench::config());
    config.bridge.dead_time_s = 0.0;
    config.imperfections.phase_voltage_filter_s = tf;
    plant::Plant plant(config);
    plant::Duties duties = bench::voltages(12.0, 0.0);
    const double count_s = T / (2.0 * bench::half_counts);
    const double plus_s = duties.high_counts[0] * count_s,
                 minus_s = duties.high_counts[1] * count_s;
    double begin_V = 0.0;
    for (int k = 0; k < 4; k++) {
        plant.step(duties);
        const auto left = [](double ago_s) { return std::exp(-ago_s / tf); };
        const double end_V =
            begin_V * left(T) + 24.0 * (left(0.5 * T - plus_s) - left(0.5 * T + plus_s) -
                                        left(0.5 * T - minus_s) + left(0.5 * T + minus_s));
        const double mean_V = 24.0 * 2.0 * (plus_s - minus_s) / T - tf / T * (end_V - begin_V);
        TEST_ASSERT_DOUBLE_WITHIN(1.01 * half_code_V, mean_V, measured_V(plant));
        begin_V = end_V;
    }
}

/* The back-EMF of an open winding is a sine: gain 1 / sqrt(1 + (w tf)^2), behind by atan(w tf). */
void test_the_filter_shifts_and_reduces_a_sine()
{
    constexpr double slow_s = 1e-4, w = bench::rotor_teeth * speed_rad_s;
    constexpr double amplitude_V = bench::torque_constant_Nm_A * speed_rad_s;
    plant::Config config = coasting(bench::config());
    config.imperfections.phase_voltage_filter_s = slow_s;
    plant::Plant plant(config);
    bench::run(plant, bench::off(), 40);
    for (int k = 40; k < 80; k++) {
        plant.step(bench::off());
        const double lag_rad = std::atan(w * slow_s);
        const double mean = (std::cos(w * (k + 1) * T - lag_rad) - std::cos(w * k * T - lag_rad)) /
                            (w * T * std::sqrt(1.0 + w * w * slow_s * slow_s));
        TEST_ASSERT_DOUBLE_WITHIN(3.0 * half_code_V, amplitude_V * mean, measured_V(plant));
    }
}

/* What a filter holds back in a period it passes on later: nothing is lost, whatever the bridge,
   the bus and the diodes do meanwhile. */
void test_the_filter_loses_no_voltage_over_time()
{
    plant::Config config = bench::config();
    config.imperfections = {3.0, 0.10, 0.02, 0.05, 0.015, 0.0075, 0.015, 0.22, tf};
    config.supply = {0.1, 470e-6, 10.0, 30.0};
    plant::Plant plant(config);
    double true_V = 0.0, seen_V = 0.0;
    for (int k = 0; k < 700; k++) {
        plant.step(k < 600 ? bench::rotor_voltages(plant, -1.0, 9.0) : bench::voltages(0.0, 0.0));
        true_V += plant.state().u_a_V;
        seen_V += measured_V(plant);
    }
    TEST_ASSERT_DOUBLE_WITHIN(700 * 0.2 * half_code_V, true_V, seen_V);
    balances(plant, plant.energy().supplied);
}

/* ---- refusals ---- */

template <typename Action> void is_refused(const char *name, const Action &action)
{
    std::string text;
    try {
        action();
    } catch (const std::invalid_argument &refusal) {
        text = refusal.what();
    }
    TEST_ASSERT_TRUE_MESSAGE(text.find(name) != std::string::npos, name);
}

void test_nonsense_is_refused_by_name()
{
    plant::Config config = noisy();
    config.supply = {0.1, 470e-6, 10.0, 30.0};
    plant::Plant plant(config);
    is_refused("jam_torque_Nm", [&] { plant.jam(-1.0); });
    is_refused("phase", [&] { plant.open_phase(2, true); });
    is_refused("-2048...2047", [&] { plant.stick(plant::Channel::phase_voltage_a, 2048); });
    is_refused("0...4095", [&] { plant.stick(plant::Channel::bus_voltage, -1); });
    is_refused("bridge_temperature_C", [&] { plant.set_bridge_temperature(200.0); });
    is_refused("noise_codes", [&] { plant.add_noise(plant::Channel::current_a, -1.0); });
    is_refused("bus_V", [&] { plant.set_bus(0.0); });
    is_refused("encoder_counts_per_turn",
               [&] { plant.set_encoder(plant::EncoderCondition::frozen); });
    config.sensors.encoder_counts_per_turn = 4000;
    plant::Plant counting(config);
    is_refused("miscounts_per_s",
               [&] { counting.set_encoder(plant::EncoderCondition::noisy, 10001.0); });
    is_refused("lost_share", [&] { counting.set_encoder(plant::EncoderCondition::lossy, 1.01); });
    is_refused("brake_V", [&] { plant.set_bus(30.0); });
    is_refused("coulomb_friction", [&] { plant.set_coulomb_friction(0.1); });
    config.imperfections.phase_voltage_filter_s = 1.0;
    is_refused("phase_voltage_filter_s", [&] { plant::Plant refused(config); });
}

/* 4,000 periods at 1,000 in a second: 400 +- 4 sigma of 19; half of them up. */
void test_a_noisy_encoder_miscounts_at_the_rate_that_was_asked_for()
{
    using Condition = plant::EncoderCondition;
    plant::Config config = at_rest(bench::config());
    config.sensors.encoder_counts_per_turn = 4000;
    plant::Plant plant(config);
    plant.set_encoder(Condition::noisy, 1000.0);
    int miscounts = 0;
    std::int32_t last = plant.samples().encoder_count;
    for (int k = 0; k < 4000; k++) {
        plant.step({});
        const std::int32_t change = plant.samples().encoder_count - last;
        TEST_ASSERT_INT_WITHIN(1, 0, change);
        miscounts += change != 0 ? 1 : 0;
        last = plant.samples().encoder_count;
    }
    TEST_ASSERT_INT_WITHIN(76, 400, miscounts);
    TEST_ASSERT_INT_WITHIN(80, 0, last);
    plant.set_encoder(Condition::sound);
    plant.step({});
    TEST_ASSERT_EQUAL_INT32(last, plant.samples().encoder_count); /* what was miscounted stays */
}

void test_a_lossy_encoder_loses_its_share_of_the_edges()
{
    using Condition = plant::EncoderCondition;
    plant::Config config = coasting(bench::config());
    config.sensors.encoder_counts_per_turn = 4000;
    plant::Plant sound(config), lossy(config);
    lossy.set_encoder(Condition::lossy, 0.25);
    for (int k = 0; k < 5000; k++) {
        sound.step({});
        lossy.step({});
    }
    const int passed = sound.samples().encoder_count;
    TEST_ASSERT_GREATER_THAN_INT(200, passed);
    const int sigma = static_cast<int>(std::sqrt(0.25 * 0.75 * passed)) + 1;
    TEST_ASSERT_INT_WITHIN(4 * sigma, (3 * passed) / 4, lossy.samples().encoder_count);
}

void test_the_count_of_a_faulty_encoder_goes_on_from_where_it_was()
{
    using Condition = plant::EncoderCondition;
    plant::Config config = coasting(bench::config());
    config.sensors.encoder_counts_per_turn = 4000;
    plant::Plant sound(config), faulty(config);
    const auto turn_for = [&](int periods) {
        const std::int32_t sound_before = sound.samples().encoder_count;
        const std::int32_t faulty_before = faulty.samples().encoder_count;
        for (int k = 0; k < periods; k++) {
            sound.step({});
            faulty.step({});
        }
        return std::pair{sound.samples().encoder_count - sound_before,
                         faulty.samples().encoder_count - faulty_before};
    };
    const auto [moved, seen] = turn_for(500);
    TEST_ASSERT_GREATER_THAN_INT(20, moved);
    TEST_ASSERT_EQUAL_INT32(moved, seen);
    faulty.set_encoder(Condition::frozen);
    TEST_ASSERT_EQUAL_INT32(0, turn_for(100).second);
    faulty.set_encoder(Condition::reversed);
    const auto [forwards, backwards] = turn_for(100);
    TEST_ASSERT_EQUAL_INT32(-forwards, backwards);
    faulty.set_encoder(Condition::half);
    const auto [all, half] = turn_for(100);
    TEST_ASSERT_EQUAL_INT32(all / 2, half);
    faulty.set_encoder(Condition::sound);
    const auto [again, right] = turn_for(100);
    TEST_ASSERT_EQUAL_INT32(again, right);
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_a_jam_stops_the_rotor_within_its_period_and_takes_its_kinetic_energy);
    RUN_TEST(test_a_jam_of_a_finite_torque_brakes_evenly_and_lets_go_of_the_rotor_when_freed);
    RUN_TEST(test_a_jump_of_the_inertia_keeps_the_speed);
    RUN_TEST(test_a_broken_lead_ends_its_current_at_once_and_its_energy_goes_into_the_arc);
    RUN_TEST(test_the_voltage_of_a_broken_phase_is_that_of_the_bridge);
    RUN_TEST(test_a_rotor_with_both_leads_broken_charges_no_bus);
    RUN_TEST(test_a_lead_that_is_joined_again_lets_the_current_rise_as_the_exponential);
    RUN_TEST(test_the_plain_motor_goes_on_where_it_was);
    RUN_TEST(test_a_stiff_bus_drives_with_its_new_voltage_from_the_same_period_on);
    RUN_TEST(test_a_leg_that_stays_high_follows_the_bus);
    RUN_TEST(test_a_capacitor_charges_to_the_new_source_and_keeps_its_charge_above_it);
    RUN_TEST(test_a_stuck_converter_keeps_its_code_until_it_is_released);
    RUN_TEST(test_noise_has_the_rms_that_was_asked_for_and_no_mean);
    RUN_TEST(test_offsets_and_gains_that_drift_reach_the_next_samples);
    RUN_TEST(test_the_filter_delays_the_mean_of_a_step_as_its_exponential);
    RUN_TEST(test_the_filter_takes_every_edge_of_a_switched_bridge);
    RUN_TEST(test_the_filter_shifts_and_reduces_a_sine);
    RUN_TEST(test_the_filter_loses_no_voltage_over_time);
    RUN_TEST(test_the_bridge_is_as_hot_as_it_is_set);
    RUN_TEST(test_the_count_of_a_faulty_encoder_goes_on_from_where_it_was);
    RUN_TEST(test_a_noisy_encoder_miscounts_at_the_rate_that_was_asked_for);
    RUN_TEST(test_a_lossy_encoder_loses_its_share_of_the_edges);
    RUN_TEST(test_nonsense_is_refused_by_name);
    return UNITY_END();
}
