/* What the plant's tests share: the motor of Bendjedia 2012 on the `bench` bridge. */
#ifndef STEADYSTEP_TESTS_PLANT_BENCH_H
#define STEADYSTEP_TESTS_PLANT_BENCH_H

#include <cmath>

#include "sil/plant/plant.h"

namespace bench
{

constexpr double pi = 3.14159265358979323846;
constexpr double resistance_ohm = 0.37, inductance_H = 0.9e-3, torque_constant_Nm_A = 0.157;
constexpr double friction_Nms_rad = 0.000307, inertia_kgm2 = 15.62e-5;
constexpr int rotor_teeth = 50;
constexpr double period_s = 1e-4;
constexpr int half_counts = 8500;

inline plant::Config config()
{
    plant::Config config;
    config.motor = {resistance_ohm,   inductance_H, torque_constant_Nm_A,
                    friction_Nms_rad, inertia_kgm2, rotor_teeth};
    config.bridge.delay_periods = 0;
    config.sensors.exact = true;
    config.track_energy = true;
    return config;
}

inline plant::Config ideal()
{
    plant::Config ideal = config();
    ideal.bridge.model = plant::BridgeModel::averaged;
    return ideal;
}

/* The drive's symmetrical modulation: each phase's legs at (1 +- m) / 2. */
inline plant::Duties voltages(double u_a_V, double u_b_V, double bus_V = 24.0)
{
    plant::Duties duties;
    duties.bridge_on = true;
    const double wanted[2] = {u_a_V / bus_V, u_b_V / bus_V};
    for (int phase = 0; phase < 2; phase++) {
        const int plus = static_cast<int>(0.5 * half_counts * (1.0 + wanted[phase]) + 0.5);
        duties.high_counts[2 * phase] = static_cast<std::uint16_t>(plus);
        duties.high_counts[2 * phase + 1] = static_cast<std::uint16_t>(half_counts - plus);
    }
    return duties;
}

inline plant::Duties off()
{
    return plant::Duties();
}

/* Voltage (u_d, u_q) in the frame of the rotor as it stands now. */
inline plant::Duties rotor_voltages(const plant::Plant &plant, double u_d_V, double u_q_V)
{
    const double angle = rotor_teeth * plant.state().theta_rad;
    return voltages(u_d_V * std::cos(angle) - u_q_V * std::sin(angle),
                    u_d_V * std::sin(angle) + u_q_V * std::cos(angle));
}

inline void run(plant::Plant &plant, const plant::Duties &duties, int periods)
{
    for (int k = 0; k < periods; k++) {
        plant.step(duties);
    }
}

} // namespace bench

#endif
