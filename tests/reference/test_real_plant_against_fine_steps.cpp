/*
 * The plants `real` and `as-built` against an independent solution: flux linkages in V s, the
 * library's sine and cosine, classical Runge-Kutta in steps of one timer count (5.9 ns), gates,
 * diodes, bus, brake and sticking decided count by count. Shares no code with the plant but the
 * three numbers of the magnetic circuit that magnetics_of designs (unit.plant_magnetics tests
 * those).
 */
#include <cmath>
#include <cstdio>
#include <unity.h>

#include "sil/plant/magnetics.h"
#include "sil/plant/plant.h"

void setUp()
{
}

void tearDown()
{
}

namespace
{

plant::Config real()
{
    plant::Config config;
    config.motor = {0.37, 0.9e-3, 0.157, 0.000307, 15.62e-5, 50};
    config.imperfections = {3.0, 0.10, 0.02, 0.05, 0.015, 0.0075, 0.015, 0.22};
    config.supply = {0.1, 470e-6, 10.0, 30.0};
    config.bridge.delay_periods = 0;
    config.sensors.exact = true;
    return config;
}

struct Reference {
    explicit Reference(const plant::Config &configuration) : config(configuration)
    {
        const plant::Magnetics magnetics = plant::magnetics_of(config.motor, config.imperfections);
        const plant::ImperfectionConfig &with = config.imperfections;
        const double scale[2] = {with.inductance_a_scale, with.inductance_b_scale};
        for (int p = 0; p < 2; p++) {
            L0[p] = magnetics.inductance * scale[p];
            magnet_A[p] = magnetics.magnet_A / scale[p];
        }
        beta = magnetics.saturation /
               (magnetics.inductance * magnetics.inductance * magnetics.inductance);
        const double far_share = with.belt.inertia_share;
        far_kgm2 = far_share * config.motor.inertia_kgm2;
        near_kgm2 = config.motor.inertia_kgm2 - far_kgm2;
        if (far_share > 0.0) {
            const double rate = 2.0 * std::acos(-1.0) * with.belt.frequency_Hz;
            const double softness = 1.0 / near_kgm2 + 1.0 / far_kgm2;
            spring_Nm_rad = rate * rate / softness;
            damper_Nms_rad = 2.0 * with.belt.damping * rate / softness;
        }
        far_omega() = config.initial_omega_rad_s;
        omega() = config.initial_omega_rad_s;
        theta() = config.initial_theta_rad;
        bus_V() = config.bridge.bus_V;
        close(0);
        close(1);
    }

    const plant::Config config;
    double L0[2], magnet_A[2], beta;
    double near_kgm2, far_kgm2, spring_Nm_rad = 0.0, damper_Nms_rad = 0.0;
    static constexpr int unknowns = 7; /* flux linkages, omega, theta, bus, behind the belt: omega
                                          and theta less the rotor's */
    double x[unknowns] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    double magnetised[2] = {0.0, 0.0}, eddy_A[2] = {0.0, 0.0}; /* the iron, within a period */
    double load_torque_Nm = 0.0;
    double mean_voltage_V[2] = {0.0, 0.0};
    bool open[2] = {true, true}; /* the current is 0 and diodes keep it there */
    bool braking = false;

    double &omega()
    {
        return x[2];
    }
    double &theta()
    {
        return x[3];
    }
    double &bus_V()
    {
        return x[4];
    }

    double &far_omega()
    {
        return x[5];
    }

    double iron_A(int phase) const
    {
        const plant::ImperfectionConfig &with = config.imperfections;
        return with.iron.hysteresis * with.rated_current_A * magnetised[phase] + eddy_A[phase];
    }

    /* At the end of a period in which the flux linkages have changed so. */
    void magnetise(const double *change_Vs)
    {
        const plant::IronConfig &iron = config.imperfections.iron;
        const double turned_by_Vs =
            iron.hysteresis_flux * config.motor.torque_constant_Nm_A / config.motor.rotor_teeth;
        const double eddy_left = std::exp(-config.bridge.period_s / iron.eddy_lag_s);
        for (int p = 0; p < 2; p++) {
            const double goal = change_Vs[p] < 0.0 ? -1.0 : 1.0;
            magnetised[p] =
                goal + (magnetised[p] - goal) * std::exp(-std::fabs(change_Vs[p]) / turned_by_Vs);
            const double loss_ohm = L0[p] / iron.eddy_time_s;
            const double through_A = change_Vs[p] / config.bridge.period_s / loss_ohm;
            eddy_A[p] =
                iron.eddy_time_s > 0.0 ? through_A + (eddy_A[p] - through_A) * eddy_left : 0.0;
            if (open[p]) {
                close(p);
            }
        }
    }

    struct Leg {
        bool wanted_high = false;
        bool on = true;       /* the wanted switch conducts */
        int counts_to_on = 0; /* rest of the dead time */
    } leg[4];

    /* Of what the bridge does during one count. */
    struct Terminals {
        double share[2], drop_V[2];
        bool floats[2];
        bool stuck;
        double slides; /* sign of the speed against which friction acts */
    };

    /* m and f of both phases, the sine of twice the electrical angle, and the detent torque, at the
       angle of y. */
    struct Rotor {
        double magnet[2], slope[2], sin_twice, detent_Nm;
    };

    /* Many a step asks twice for one angle, and a rotor that sticks has but one. */
    mutable double last_theta_rad = NAN;
    mutable Rotor last_rotor = {};

    const Rotor &rotor(const double *y) const
    {
        if (y[3] != last_theta_rad) {
            last_theta_rad = y[3];
            last_rotor = rotor_at(config.motor.rotor_teeth * y[3]);
        }
        return last_rotor;
    }

    Rotor rotor_at(double angle) const
    {
        const plant::ImperfectionConfig &with = config.imperfections;
        const double h = with.flux_harmonic_3;
        const double c1 = std::cos(angle), s1 = std::sin(angle);
        const double c3 = std::cos(3.0 * angle), s3 = std::sin(3.0 * angle);
        const double s2 = std::sin(2.0 * angle);
        const double holding_Nm =
            std::sqrt(2.0) * config.motor.torque_constant_Nm_A * with.rated_current_A;
        return {{c1 + h / 3.0 * c3, s1 - h / 3.0 * s3},
                {-s1 - h * s3, c1 - h * c3},
                s2,
                -holding_Nm * (with.detent_4 * std::sin(4.0 * angle) + with.detent_2 * s2 +
                               with.detent_1 * s1)};
    }

    double current(int phase, const double *y, const Rotor &at) const
    {
        const double flux = y[phase];
        return flux / L0[phase] + beta * flux * flux * flux - magnet_A[phase] * at.magnet[phase] +
               iron_A(phase);
    }

    double current(int phase, const double *y) const
    {
        return current(phase, y, rotor(y));
    }

    /* dlambda/dt of a phase that carries no current. */
    double emf(int phase, const double *y, const Rotor &at) const
    {
        return magnet_A[phase] * config.motor.rotor_teeth * y[2] * at.slope[phase] /
               (1.0 / L0[phase] + 3.0 * beta * y[phase] * y[phase]);
    }

    double torque_Nm(const double *y, const Rotor &at) const
    {
        /* What the open motor has without saturation is detent_Nm, but for h^2: unlike phases pull
           it with (I_f,a - I_f,b) / 2 sin 2 phi. */
        double torque_Nm = at.detent_Nm;
        const double mean_A = 0.5 * (magnet_A[0] + magnet_A[1]);
        const double Kx = config.motor.rotor_teeth * L0[0] * magnet_A[0];
        for (int p = 0; p < 2; p++) {
            torque_Nm += Kx * at.slope[p] * (y[p] / L0[p] - mean_A * at.magnet[p]);
        }
        return torque_Nm + 0.5 * (magnet_A[0] - magnet_A[1]) * Kx * at.sin_twice *
                               (1.0 + 2.0 / 3.0 * config.imperfections.flux_harmonic_3);
    }

    /* By which the belt drives the rotor. */
    double belt_Nm(const double *y) const
    {
        return spring_Nm_rad * y[6] + damper_Nms_rad * (y[5] - y[2]);
    }

    /* By which stops drive what strikes them: a spring and a damper, that push and never pull. */
    double stops_Nm(double angle_rad, double rad_s, double inertia_kgm2) const
    {
        const plant::StopConfig &stops = config.stops;
        const double damper_Nms_rad =
            2.0 * stops.damping * std::sqrt(stops.stiffness_Nm_rad * inertia_kgm2);
        const double over_rad = angle_rad - stops.high_rad, under_rad = stops.low_rad - angle_rad;
        double sum_Nm = 0.0;
        if (over_rad > 0.0) {
            sum_Nm -= std::fmax(stops.stiffness_Nm_rad * over_rad + damper_Nms_rad * rad_s, 0.0);
        }
        if (under_rad > 0.0) {
            sum_Nm += std::fmax(stops.stiffness_Nm_rad * under_rad - damper_Nms_rad * rad_s, 0.0);
        }
        return sum_Nm;
    }

    double at_the_shaft_Nm(const double *y) const
    {
        return far_kgm2 > 0.0 ? belt_Nm(y)
                              : stops_Nm(y[3], y[2], config.motor.inertia_kgm2) - load_torque_Nm;
    }

    double coulomb_Nm() const
    {
        return config.imperfections.coulomb_friction * std::sqrt(2.0) *
               config.motor.torque_constant_Nm_A * config.imperfections.rated_current_A;
    }

    /* Newton's method for the flux of a phase without current. */
    void close(int phase)
    {
        const Rotor here = rotor(x);
        double before = NAN;
        for (int n = 0; n < 20 && x[phase] != before; n++) {
            before = x[phase];
            x[phase] -=
                current(phase, x, here) / (1.0 / L0[phase] + 3.0 * beta * x[phase] * x[phase]);
        }
    }

    void derivative(const double *y, const Terminals &t, double *dy) const
    {
        const plant::MotorConfig &m = config.motor;
        const plant::SupplyConfig &s = config.supply;
        const plant::ImperfectionConfig &with = config.imperfections;
        const double scale[2] = {with.resistance_a_scale, with.resistance_b_scale};
        const Rotor at = rotor(y);
        double drawn_A = 0.0;
        for (int p = 0; p < 2; p++) {
            const double i = current(p, y, at);
            dy[p] = t.floats[p]
                        ? emf(p, y, at)
                        : t.share[p] * y[4] + t.drop_V[p] -
                              (m.resistance_ohm * scale[p] + with.bridge_resistance_ohm) * i;
            drawn_A += t.floats[p] ? 0.0 : t.share[p] * i;
        }
        const double net_Nm =
            torque_Nm(y, at) - m.viscous_friction_Nms_rad * y[2] + at_the_shaft_Nm(y);
        dy[2] = t.stuck ? 0.0 : (net_Nm - t.slides * coulomb_Nm()) / near_kgm2;
        dy[5] =
            far_kgm2 > 0.0
                ? (stops_Nm(y[3] + y[6], y[5], far_kgm2) - belt_Nm(y) - load_torque_Nm) / far_kgm2
                : 0.0;
        dy[6] = far_kgm2 > 0.0 ? y[5] - y[2] : 0.0;
        dy[3] = t.stuck ? 0.0 : y[2];
        const double source_A = std::fmax((config.bridge.bus_V - y[4]) / s.bus_source_ohm, 0.0);
        const double brake_A = braking ? y[4] / s.brake_ohm : 0.0;
        dy[4] = (source_A - brake_A - drawn_A) / s.bus_capacitance_F;
    }

    void runge_kutta(const Terminals &t, double h)
    {
        double k1[unknowns], k2[unknowns], k3[unknowns], k4[unknowns], y[unknowns];
        derivative(x, t, k1);
        for (int n = 0; n < unknowns; n++) {
            y[n] = x[n] + 0.5 * h * k1[n];
        }
        derivative(y, t, k2);
        for (int n = 0; n < unknowns; n++) {
            y[n] = x[n] + 0.5 * h * k2[n];
        }
        derivative(y, t, k3);
        for (int n = 0; n < unknowns; n++) {
            y[n] = x[n] + h * k3[n];
        }
        derivative(y, t, k4);
        for (int n = 0; n < unknowns; n++) {
            x[n] += h / 6.0 * (k1[n] + 2.0 * k2[n] + 2.0 * k3[n] + k4[n]);
        }
    }

    /* Of a leg: its share of the bus and its drop, for a current that leaves or enters it. */
    void leg_voltage(int l, bool leaves, bool bridge_on, double *share, double *drop_V) const
    {
        if (bridge_on && leg[l].on) {
            *share = leg[l].wanted_high ? 1.0 : 0.0;
            *drop_V = 0.0;
        } else {
            *share = leaves ? 0.0 : 1.0;
            *drop_V = leaves ? -config.bridge.diode_drop_V : config.bridge.diode_drop_V;
        }
    }

    void phase_voltage(int p, bool positive, bool bridge_on, double *share, double *drop_V) const
    {
        double other_share, other_drop_V;
        leg_voltage(2 * p, positive, bridge_on, share, drop_V);
        leg_voltage(2 * p + 1, !positive, bridge_on, &other_share, &other_drop_V);
        *share -= other_share;
        *drop_V -= other_drop_V;
    }

    void one_count(bool bridge_on)
    {
        Terminals t = {};
        const Rotor here = rotor(x);
        bool diodes[2];
        double before_A[2];
        for (int p = 0; p < 2; p++) {
            double up_share, up_V, down_share, down_V;
            phase_voltage(p, true, bridge_on, &up_share, &up_V);
            phase_voltage(p, false, bridge_on, &down_share, &down_V);
            const double up = up_share * bus_V() + up_V;
            const double down = down_share * bus_V() + down_V;
            const double e = emf(p, x, here);
            before_A[p] = open[p] ? 0.0 : current(p, x, here);
            diodes[p] = up != down;
            t.floats[p] = diodes[p] && open[p] && e >= up && e <= down;
            const bool positive = before_A[p] > 0.0 || (before_A[p] == 0.0 && e < up);
            t.share[p] = positive ? up_share : down_share;
            t.drop_V[p] = positive ? up_V : down_V;
            if (t.floats[p]) {
                t.share[p] = t.drop_V[p] = 0.0;
            }
        }
        const double net_Nm = torque_Nm(x, here) + at_the_shaft_Nm(x);
        t.stuck = omega() == 0.0 && std::fabs(net_Nm) <= coulomb_Nm();
        t.slides = omega() > 0.0 || (omega() == 0.0 && net_Nm > 0.0) ? 1.0 : -1.0;
        const double bus_before_V = bus_V();
        const double h = config.bridge.period_s / (2.0 * config.bridge.half_period_counts);
        const double flux_before[2] = {x[0], x[1]};
        runge_kutta(t, h);
        for (int p = 0; p < 2; p++) {
            open[p] = t.floats[p] || (diodes[p] && before_A[p] * current(p, x) < 0.0);
            if (open[p]) {
                close(p);
            }
            mean_voltage_V[p] +=
                (t.floats[p] ? (x[p] - flux_before[p]) / h
                             : t.share[p] * 0.5 * (bus_before_V + bus_V()) + t.drop_V[p]) /
                (2.0 * config.bridge.half_period_counts);
        }
        if (!t.stuck && coulomb_Nm() > 0.0 && omega() * t.slides < 0.0) {
            omega() = 0.0;
        }
        const double brake_V = config.supply.brake_V;
        braking = bus_V() > (braking ? 0.98 * brake_V : brake_V);
    }

    void period(const plant::Duties &duties)
    {
        const int half = config.bridge.half_period_counts;
        const double count_s = config.bridge.period_s / (2.0 * half);
        const int dead = static_cast<int>(std::lround(config.bridge.dead_time_s / count_s));
        const double flux_before[2] = {x[0], x[1]};
        mean_voltage_V[0] = mean_voltage_V[1] = 0.0;
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
        if (config.imperfections.iron.hysteresis > 0.0) {
            const double change_Vs[2] = {x[0] - flux_before[0], x[1] - flux_before[1]};
            magnetise(change_Vs);
        }
    }
};

struct Difference {
    double current_A = 0.0, omega_rad_s = 0.0, theta_rad = 0.0, voltage_V = 0.0, bus_V = 0.0;
    double highest_bus_V = 0.0, lowest_bus_V = 1e9; /* of the plant, like the rest */
    double fastest_rad_s = 0.0, last_rad_s = 0.0;
};

void widen(double &worst, double difference)
{
    worst = std::fmax(worst, std::fabs(difference));
}

/* A voltage vector of the given size at an electrical angle. */
plant::Duties duties_for(double voltage_V, double electrical_rad, bool on)
{
    plant::Duties duties;
    duties.bridge_on = on;
    const double wanted[2] = {voltage_V * std::cos(electrical_rad),
                              voltage_V * std::sin(electrical_rad)};
    for (int p = 0; p < 2; p++) {
        const double plus = 4250.0 * (1.0 + wanted[p] / 24.0);
        duties.high_counts[2 * p] = static_cast<std::uint16_t>(plus);
        duties.high_counts[2 * p + 1] = static_cast<std::uint16_t>(8500.0 - plus);
    }
    return duties;
}

struct Run {
    double voltage_V = 0.0, ahead_rad = 1.5; /* of the rotor's d axis */
    int periods = 60, off_from = 60;
    double load_torque_Nm = 0.05;
};

Difference compare(const plant::Config &config, const Run &run)
{
    plant::Plant plant(config);
    Reference reference(config);
    reference.load_torque_Nm = run.load_torque_Nm;
    plant.set_load_torque(run.load_torque_Nm);
    Difference worst;
    for (int k = 0; k < run.periods; k++) {
        const double angle = 50.0 * reference.theta() + run.ahead_rad;
        const plant::Duties duties = duties_for(run.voltage_V, angle, k < run.off_from);
        plant.step(duties);
        reference.period(duties);
        const plant::State &state = plant.state();
        for (int p = 0; p < 2; p++) {
            const double reference_A = reference.open[p] ? 0.0 : reference.current(p, reference.x);
            widen(worst.current_A, (p == 0 ? state.i_a_A : state.i_b_A) - reference_A);
            widen(worst.voltage_V,
                  (p == 0 ? state.u_a_V : state.u_b_V) - reference.mean_voltage_V[p]);
        }
        widen(worst.omega_rad_s, state.omega_rad_s - reference.omega());
        widen(worst.theta_rad, state.theta_rad - reference.theta());
        widen(worst.bus_V, state.bus_V - reference.bus_V());
        worst.highest_bus_V = std::fmax(worst.highest_bus_V, state.bus_V);
        worst.lowest_bus_V = std::fmin(worst.lowest_bus_V, state.bus_V);
        worst.fastest_rad_s = std::fmax(worst.fastest_rad_s, std::fabs(state.omega_rad_s));
        worst.last_rad_s = state.omega_rad_s;
    }
    std::printf("worst difference: %.1e A, %.1e rad/s, %.1e rad, %.1e V, bus %.1e V (%.2f...%.2f V)"
                "\n",
                worst.current_A, worst.omega_rad_s, worst.theta_rad, worst.voltage_V, worst.bus_V,
                worst.lowest_bus_V, worst.highest_bus_V);
    return worst;
}

/* The tolerance is ten times wider where the brake switches: the reference knows to a count when.
 */
void agrees(const Difference &worst, double tolerance)
{
    TEST_ASSERT_TRUE(worst.current_A < tolerance);
    TEST_ASSERT_TRUE(worst.omega_rad_s < 2.0 * tolerance);
    TEST_ASSERT_TRUE(worst.theta_rad < 0.01 * tolerance);
    TEST_ASSERT_TRUE(worst.bus_V < 20.0 * tolerance);
    TEST_ASSERT_TRUE(worst.voltage_V < 6e-3); /* a conduction ends at a whole count: 24 V / 17000 */
}

void test_in_motion()
{
    plant::Config config = real();
    config.initial_omega_rad_s = 45.0;
    agrees(compare(config, {9.0}), 1e-6);
}

/* Without friction: the reference knows to a count when a speed turns round. */
void test_a_stop_is_struck_and_left()
{
    plant::Config config = real();
    config.initial_omega_rad_s = 30.0;
    config.stops.high_rad = 0.05;
    config.imperfections.coulomb_friction = 0.0;
    config.stops.damping = 0.0;
    const Difference worst = compare(config, {0.0, 0.0, 80, 0, 0.0});
    agrees(worst, 3e-6);
    TEST_ASSERT_TRUE(worst.last_rad_s < -1.0);
}

/* The damper takes hold at once, and the reference knows to a count when. */
void test_a_soft_stop_below_that_damps_more_than_it_springs()
{
    plant::Config config = real();
    config.initial_omega_rad_s = -30.0;
    config.stops.low_rad = -0.03;
    config.stops.stiffness_Nm_rad = 5.0;
    config.stops.damping = 1.5;
    agrees(compare(config, {0.0, 0.0, 120, 120, 0.0}), 3e-5);
}

void test_a_rotor_that_rests_on_a_stop_and_sticks()
{
    plant::Config config = real();
    config.initial_omega_rad_s = 2.0;
    config.stops.high_rad = 0.002;
    config.stops.stiffness_Nm_rad = 20.0;
    config.stops.damping = 0.5;
    const Difference worst = compare(config, {0.0, 0.0, 700, 0, -0.1});
    agrees(worst, 3e-6);
    TEST_ASSERT_TRUE(worst.last_rad_s == 0.0);
}

void test_a_load_behind_a_belt_strikes_its_stop()
{
    plant::Config config = real();
    config.initial_omega_rad_s = 30.0;
    config.imperfections.belt = {0.5, 100.0, 0.02};
    config.stops.high_rad = 0.05;
    config.stops.stiffness_Nm_rad = 1000.0;
    config.imperfections.coulomb_friction = 0.0;
    config.stops.damping = 0.0;
    agrees(compare(config, {0.0, 0.0, 120, 0, 0.0}), 3e-6);
}

void test_fast()
{
    plant::Config config = real();
    config.initial_omega_rad_s = 130.0;
    agrees(compare(config, {21.0}), 3e-5);
}

void test_deep_saturation_and_a_large_harmonic()
{
    plant::Config config = real();
    config.imperfections.saturation_depth = 0.3;
    config.imperfections.flux_harmonic_3 = 0.1;
    config.initial_omega_rad_s = 20.0;
    agrees(compare(config, {8.0, 0.3}), 3e-6);
}

void test_breaking_away()
{
    plant::Config config = real();
    const Difference worst = compare(config, {2.0, 1.2, 100, 100, 0.0});
    agrees(worst, 3e-6);
    TEST_ASSERT_TRUE(worst.fastest_rad_s > 5.0);
}

void test_coming_to_rest_on_friction_and_detent()
{
    plant::Config config = real();
    config.initial_omega_rad_s = 1.5;
    const Difference worst = compare(config, {0.0, 0.0, 700, 0, 0.0});
    agrees(worst, 3e-6);
    TEST_ASSERT_TRUE(worst.last_rad_s == 0.0);
}

void test_small_currents_that_end_in_the_dead_times()
{
    plant::Config config = real();
    config.initial_omega_rad_s = 2.0;
    agrees(compare(config, {0.4}), 3e-6);
}

void test_freewheeling_until_the_diodes_block()
{
    plant::Config config = real();
    config.initial_omega_rad_s = 45.0;
    agrees(compare(config, {9.0, 1.5, 60, 20}), 3e-6);
}

void test_braking_charges_the_bus_to_the_brake_resistor()
{
    plant::Config config = real();
    config.initial_omega_rad_s = 130.0;
    const Difference worst = compare(config, {12.0, 1.5, 120, 120});
    agrees(worst, 3e-5);
    TEST_ASSERT_TRUE(worst.highest_bus_V > 29.0 && worst.highest_bus_V < 31.0);
}

void test_a_driven_rotor_feeds_the_bus_through_the_diodes()
{
    plant::Config config = real();
    config.initial_omega_rad_s = 260.0; /* 40.8 V against 24 V and two diodes */
    agrees(compare(config, {0.0, 1.5, 60, 0}), 3e-5);
}

/* ---- as built ---- */

plant::Config as_built()
{
    plant::Config config = real();
    config.imperfections.iron.hysteresis = 0.04;
    config.imperfections.iron.eddy_time_s = 12e-6;
    config.imperfections.resistance_a_scale = 0.97;
    config.imperfections.resistance_b_scale = 1.05;
    config.imperfections.inductance_a_scale = 1.06;
    config.imperfections.inductance_b_scale = 0.93;
    return config;
}

void test_iron_and_unlike_phases_in_motion()
{
    plant::Config config = as_built();
    config.initial_omega_rad_s = 45.0;
    agrees(compare(config, {9.0}), 1e-6);
}

void test_iron_where_the_current_has_ended()
{
    plant::Config config = as_built();
    config.initial_omega_rad_s = 45.0;
    agrees(compare(config, {9.0, 1.5, 60, 20}), 3e-6);
}

void test_iron_at_small_currents()
{
    plant::Config config = as_built();
    config.initial_omega_rad_s = 2.0;
    agrees(compare(config, {0.4}), 3e-6);
}

void test_a_belt_that_is_torn_at()
{
    plant::Config config = as_built();
    config.imperfections.belt = {0.5, 250.0, 0.02};
    config.initial_omega_rad_s = 45.0;
    agrees(compare(config, {9.0, 1.5, 100, 100, 0.3}), 1e-6);
}

void test_a_belt_swings_while_the_rotor_sticks_and_tears_it_loose()
{
    plant::Config config = as_built();
    config.imperfections.belt = {0.3, 60.0, 0.02};
    const Difference worst = compare(config, {1.0, 0.0, 150, 150, 0.4});
    agrees(worst, 3e-6);
    TEST_ASSERT_TRUE(worst.fastest_rad_s > 1.0);
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_in_motion);
    RUN_TEST(test_a_stop_is_struck_and_left);
    RUN_TEST(test_a_soft_stop_below_that_damps_more_than_it_springs);
    RUN_TEST(test_a_rotor_that_rests_on_a_stop_and_sticks);
    RUN_TEST(test_a_load_behind_a_belt_strikes_its_stop);
    RUN_TEST(test_fast);
    RUN_TEST(test_deep_saturation_and_a_large_harmonic);
    RUN_TEST(test_breaking_away);
    RUN_TEST(test_coming_to_rest_on_friction_and_detent);
    RUN_TEST(test_small_currents_that_end_in_the_dead_times);
    RUN_TEST(test_freewheeling_until_the_diodes_block);
    RUN_TEST(test_braking_charges_the_bus_to_the_brake_resistor);
    RUN_TEST(test_a_driven_rotor_feeds_the_bus_through_the_diodes);
    RUN_TEST(test_iron_and_unlike_phases_in_motion);
    RUN_TEST(test_iron_where_the_current_has_ended);
    RUN_TEST(test_iron_at_small_currents);
    RUN_TEST(test_a_belt_that_is_torn_at);
    RUN_TEST(test_a_belt_swings_while_the_rotor_sticks_and_tears_it_loose);
    return UNITY_END();
}
