/*
 * Speed of the plant alone, in simulated seconds per second of processor time.
 */
#include <cstdio>
#include <ctime>

#include "sil/plant/elementary.h"
#include "sil/plant/plant.h"

namespace
{

constexpr double two_pi = 2.0 * plant::pi;

/* Prints the ratio, best of five, for a constant voltage (u_d, u_q) in the rotor's own frame. */
void measure(const char *name, const plant::Config &config, double u_d_V, double u_q_V)
{
    constexpr int periods = 20000;
    const double half = config.bridge.half_period_counts;
    plant::Plant plant(config);
    plant::Duties duties;
    duties.bridge_on = true;
    double best_s = 1e9;
    for (int run = 0; run < 5; run++) {
        const std::clock_t start = std::clock();
        for (int k = 0; k < periods; k++) {
            const double turns = plant.state().theta_rad * config.motor.rotor_teeth / two_pi;
            const double turn = turns - static_cast<double>(static_cast<int>(turns));
            const plant::Phases d_axis = plant::unit_vector(two_pi * turn);
            const plant::Phases voltage = u_d_V * d_axis + u_q_V * plant::quarter_turn(d_axis);
            for (int phase = 0; phase < 2; phase++) {
                const double plus = 0.5 * half * (1.0 + voltage[phase] / config.bridge.bus_V);
                duties.high_counts[2 * phase] = static_cast<std::uint16_t>(plus + 0.5);
                duties.high_counts[2 * phase + 1] = static_cast<std::uint16_t>(half - plus + 0.5);
            }
            plant.step(duties);
        }
        const double taken_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        best_s = taken_s < best_s ? taken_s : best_s;
    }
    std::printf("%-36s %5.0f x real time   (ends at %6.2f rad/s, %6.3f A)\n", name,
                periods * config.bridge.period_s / best_s, plant.state().omega_rad_s,
                plant.state().i_a_A);
}

} // namespace

int main()
{
    plant::Config config;
    config.motor.resistance_ohm = 0.37;
    config.motor.inductance_H = 0.9e-3;
    config.motor.torque_constant_Nm_A = 0.157;
    config.motor.viscous_friction_Nms_rad = 0.000307;
    config.motor.inertia_kgm2 = 15.62e-5;
    config.motor.rotor_teeth = 50;
    measure("switched, at speed", config, 0.0, 8.0);
    measure("switched, d-axis current at rest", config, 1.5, 0.0);
    measure("switched, at rest without current", config, 0.0, 0.0);
    plant::Config with_energy = config;
    with_energy.track_energy = true;
    measure("switched, at speed, energies", with_energy, 0.0, 8.0);
    plant::Config averaged = config;
    averaged.bridge.model = plant::BridgeModel::averaged;
    measure("averaged, at speed", averaged, 0.0, 8.0);
    averaged.sensors.exact = true;
    measure("averaged, at speed, exact sensors", averaged, 0.0, 8.0);
    plant::Config real = config;
    real.imperfections = {3.0, 0.10, 0.02, 0.05, 0.015, 0.0075, 0.015, 0.22};
    real.supply = {0.1, 470e-6, 10.0, 30.0};
    measure("real, at speed", real, 0.0, 8.0);
    measure("real, d-axis current at rest", real, 1.5, 0.0);
    measure("real, at rest without current", real, 0.0, 0.0);
    plant::Config as_built = real;
    as_built.imperfections.iron.hysteresis = 0.02;
    as_built.imperfections.iron.eddy_time_s = 6e-6;
    as_built.imperfections.inductance_a_scale = 1.01;
    as_built.imperfections.magnet_rise_K = 70;
    as_built.sensors.divider_mismatch_a = 2.5e-3;
    measure("as built, at speed", as_built, 0.0, 8.0);
    measure("as built, d-axis current at rest", as_built, 1.5, 0.0);
    measure("as built, at rest without current", as_built, 0.0, 0.0);
    as_built.imperfections.belt.inertia_share = 0.5;
    measure("as built with a belt, at speed", as_built, 0.0, 8.0);
    return 0;
}
