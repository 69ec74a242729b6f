/*
 * The plant against an independent solution of the same bridge and motor: the equations in (a, b)
 * with the library's sine and cosine, classical Runge-Kutta in steps of one timer count (5.9 ns),
 * and gates that a state machine per leg switches count by count. Shares no code with the plant.
 */
#include <cmath>
#include <cstdio>
#include <unity.h>

#include "sil/plant/plant.h"

void setUp()
{
}

void tearDown()
{
}

namespace
{

struct Reference {
    plant::Config config;
    double x[4] = {0.0, 0.0, 0.0, 0.0}; /* i_a, i_b, omega, theta */
    double load_torque = 0.0;
    double mean_voltage[2] = {0.0, 0.0};

    struct Leg {
        bool wanted_high = false;
        bool on = true;       /* the wanted switch conducts */
        int counts_to_on = 0; /* rest of the dead time */
    } leg[4];

    void emf(const double *y, double *e) const
    {
        const double angle = config.motor.rotor_teeth * y[3];
        e[0] = -config.motor.torque_constant_Nm_A * y[2] * std::sin(angle);
        e[1] = config.motor.torque_constant_Nm_A * y[2] * std::cos(angle);
    }

    void derivative(const double *y, const double *u, const bool *floats, double *dy) const
    {
        const plant::MotorConfig &m = config.motor;
        const double angle = m.rotor_teeth * y[3];
        const double s = std::sin(angle);
        const double c = std::cos(angle);
        const double k = m.torque_constant_Nm_A;
        dy[0] = floats[0] ? 0.0 : (u[0] - m.resistance_ohm * y[0] + k * y[2] * s) / m.inductance_H;
        dy[1] = floats[1] ? 0.0 : (u[1] - m.resistance_ohm * y[1] - k * y[2] * c) / m.inductance_H;
        dy[2] = (k * (-y[0] * s + y[1] * c) - m.viscous_friction_Nms_rad * y[2] - load_torque) /
                m.inertia_kgm2;
        dy[3] = y[2];
    }

    void runge_kutta(const double *u, const bool *floats, double h)
    {
        double k1[4], k2[4], k3[4], k4[4], y[4];
        derivative(x, u, floats, k1);
        for (int n = 0; n < 4; n++) {
            y[n] = x[n] + 0.5 * h * k1[n];
        }
        derivative(y, u, floats, k2);
        for (int n = 0; n < 4; n++) {
            y[n] = x[n] + 0.5 * h * k2[n];
        }
        derivative(y, u, floats, k3);
        for (int n = 0; n < 4; n++) {
            y[n] = x[n] + h * k3[n];
        }
        derivative(y, u, floats, k4);
        for (int n = 0; n < 4; n++) {
            x[n] += h / 6.0 * (k1[n] + 2.0 * k2[n] + 2.0 * k3[n] + k4[n]);
        }
    }

    /* Voltage of a leg for a current that leaves (> 0) or enters (< 0) it. */
    double leg_voltage(int l, double current, bool bridge_on) const
    {
        if (bridge_on && leg[l].on) {
            return leg[l].wanted_high ? config.bridge.bus_V : 0.0;
        }
        return current > 0.0 ? -config.bridge.diode_drop_V
                             : config.bridge.bus_V + config.bridge.diode_drop_V;
    }

    double phase_voltage(int phase, double current, bool bridge_on) const
    {
        return leg_voltage(2 * phase, current, bridge_on) -
               leg_voltage(2 * phase + 1, -current, bridge_on);
    }

    void one_count(bool bridge_on)
    {
        double u[2], e[2];
        bool floats[2], diodes[2];
        emf(x, e);
        for (int p = 0; p < 2; p++) {
            const double up = phase_voltage(p, 1.0, bridge_on);
            const double down = phase_voltage(p, -1.0, bridge_on);
            diodes[p] = up != down;
            floats[p] = diodes[p] && x[p] == 0.0 && e[p] >= up && e[p] <= down;
            u[p] = x[p] > 0.0 || (x[p] == 0.0 && e[p] < up) ? up : down;
        }
        const double before[2] = {x[0], x[1]};
        runge_kutta(u, floats, config.bridge.period_s / (2.0 * config.bridge.half_period_counts));
        for (int p = 0; p < 2; p++) {
            if (diodes[p] && before[p] * x[p] < 0.0) {
                x[p] = 0.0; /* a diode does not let the current turn */
            }
            mean_voltage[p] += (floats[p] ? e[p] : u[p]) / (2.0 * config.bridge.half_period_counts);
        }
    }

    void period(const plant::Duties &duties)
    {
        const int half = config.bridge.half_period_counts;
        const double count_s = config.bridge.period_s / (2.0 * half);
        const int dead = static_cast<int>(std::lround(config.bridge.dead_time_s / count_s));
        mean_voltage[0] = mean_voltage[1] = 0.0;
        for (int n = 0; n < 2 * half; n++) {
            for (int l = 0; l < 4; l++) {
                const int high = duties.high_counts[l];
                const bool wanted = duties.bridge_on && n >= half - high && n < half + high;
                if (wanted != leg[l].wanted_high) {
                    leg[l].wanted_high = wanted;
                    leg[l].counts_to_on = dead;
                }
                leg[l].on = leg[l].counts_to_on == 0;
                leg[l].counts_to_on -= leg[l].on ? 0 : 1;
            }
            one_count(duties.bridge_on);
        }
    }
};

plant::Config bench()
{
    plant::Config config;
    config.motor = {0.37, 0.9e-3, 0.157, 0.000307, 15.62e-5, 50};
    config.bridge.delay_periods = 0;
    config.sensors.exact = true;
    return config;
}

struct Difference {
    double current_A = 0.0, omega_rad_s = 0.0, theta_rad = 0.0, voltage_V = 0.0;
};

void widen(double &worst, double difference)
{
    worst = std::fmax(worst, std::fabs(difference));
}

/* A voltage vector of the given size at an angle `lead` before the rotor's d axis. */
plant::Duties duties_for(double voltage, double electrical_rad, bool on)
{
    plant::Duties duties;
    duties.bridge_on = on;
    const double wanted[2] = {voltage * std::cos(electrical_rad),
                              voltage * std::sin(electrical_rad)};
    for (int p = 0; p < 2; p++) {
        const double plus = 4250.0 * (1.0 + wanted[p] / 24.0);
        duties.high_counts[2 * p] = static_cast<std::uint16_t>(plus);
        duties.high_counts[2 * p + 1] = static_cast<std::uint16_t>(8500.0 - plus);
    }
    return duties;
}

Difference compare(const plant::Config &config, double voltage_V, int periods, int off_from)
{
    plant::Plant plant(config);
    Reference reference;
    reference.config = config;
    reference.x[2] = config.initial_omega_rad_s;
    reference.x[3] = config.initial_theta_rad;
    reference.load_torque = 0.05;
    plant.set_load_torque(0.05);
    Difference worst;
    for (int k = 0; k < periods; k++) {
        const double angle = 50.0 * reference.x[3] + 1.5;
        const plant::Duties duties = duties_for(voltage_V, angle, k < off_from);
        plant.step(duties);
        reference.period(duties);
        widen(worst.current_A, plant.state().i_a_A - reference.x[0]);
        widen(worst.current_A, plant.state().i_b_A - reference.x[1]);
        widen(worst.omega_rad_s, plant.state().omega_rad_s - reference.x[2]);
        widen(worst.theta_rad, plant.state().theta_rad - reference.x[3]);
        widen(worst.voltage_V, plant.state().u_a_V - reference.mean_voltage[0]);
        widen(worst.voltage_V, plant.state().u_b_V - reference.mean_voltage[1]);
    }
    std::printf("worst difference: %.1e A, %.1e rad/s, %.1e rad, %.1e V\n", worst.current_A,
                worst.omega_rad_s, worst.theta_rad, worst.voltage_V);
    return worst;
}

void agrees(const Difference &worst, double tolerance)
{
    TEST_ASSERT_TRUE(worst.current_A < tolerance);
    TEST_ASSERT_TRUE(worst.omega_rad_s < 2.0 * tolerance);
    TEST_ASSERT_TRUE(worst.theta_rad < 0.01 * tolerance);
    /* The reference ends a conduction only at a whole count: 24 V for at most 1 / 17000. */
    TEST_ASSERT_TRUE(worst.voltage_V < 6e-3);
}

void test_in_motion_with_dead_time()
{
    plant::Config config = bench();
    config.initial_omega_rad_s = 45.0;
    agrees(compare(config, 9.0, 60, 60), 3e-8);
}

void test_fast_with_dead_time()
{
    plant::Config config = bench();
    config.initial_omega_rad_s = 130.0;
    agrees(compare(config, 21.0, 60, 60), 2e-7);
}

void test_small_currents_that_end_in_the_dead_times()
{
    plant::Config config = bench();
    config.initial_omega_rad_s = 2.0;
    agrees(compare(config, 0.4, 60, 60), 3e-8);
}

void test_freewheeling_until_the_diodes_block()
{
    plant::Config config = bench();
    config.initial_omega_rad_s = 45.0;
    agrees(compare(config, 9.0, 60, 20), 3e-8);
}

void test_a_driven_rotor_feeds_the_bus_through_the_diodes()
{
    plant::Config config = bench();
    config.initial_omega_rad_s = 260.0; /* 40.8 V against 24 V and two diodes */
    agrees(compare(config, 0.0, 60, 0), 2e-7);
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_in_motion_with_dead_time);
    RUN_TEST(test_fast_with_dead_time);
    RUN_TEST(test_small_currents_that_end_in_the_dead_times);
    RUN_TEST(test_freewheeling_until_the_diodes_block);
    RUN_TEST(test_a_driven_rotor_feeds_the_bus_through_the_diodes);
    return UNITY_END();
}
