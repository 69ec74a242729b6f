/*
 * The closed loop of input-output linearisation as a matrix: rotor, winding, the period of delay,
 * prediction, encoder observer and voltage disturbance observer, at rest, with the winding's
 * resistance left out. Time in periods, currents as the acceleration that the model expects of
 * them.
 */
#include <algorithm>
#include <cmath>
#include <complex>
#include <unity.h>
#include <vector>

#include <Eigen/Core>

#include "tests/reference/matrix_functions.h"

extern "C" {
#include "firmware/design/feedback_linearisation_design.h"
}

namespace
{

constexpr double period_s = 1e-4;

/* What the true motor has of the model's: acceleration per current, inductance. */
struct Mismatch {
    double acceleration = 1, inductance = 1;
};

struct Loop {
    feedback_linearisation_gains k;
    double observer_pole, disturbance_gain;
};

enum {
    THETA,
    OMEGA,
    CURRENT,
    PAST_CURRENT,
    DEMAND,    /* in force over the coming period */
    PREDICTED, /* current expected now */
    THETA_EST, /* before this sample's correction's prediction */
    OMEGA_EST,
    LOAD_EST,    /* as an acceleration */
    DISTURBANCE, /* as a change of current per period */
    STATES
};

using State = Eigen::Matrix<double, STATES, 1>;
using Matrix = Eigen::Matrix<double, STATES, STATES>;

/* What a current that goes linearly from one value to another adds to the angle. (The firmware
   takes the mean of both for the whole period and so neglects a twelfth of the change.) */
double integrated_twice(double from, double to)
{
    return from / 2 + (to - from) / 6;
}

/* One period, from S(k) to S(k+1); linear in x. */
State step(const State &x, const Loop &loop, const Mismatch &motor)
{
    const double p = loop.observer_pole;
    const double q = 1 - p;
    State y = x;

    /* observer: predict with the mean measured current, correct */
    const double mean = (x[CURRENT] + x[PAST_CURRENT]) / 2 - x[LOAD_EST];
    const double speed = x[OMEGA_EST] + mean;
    const double angle = x[THETA_EST] + x[OMEGA_EST] - x[LOAD_EST] / 2 +
                         integrated_twice(x[PAST_CURRENT], x[CURRENT]);
    const double nu = x[THETA] - angle;
    const double theta = angle + (1 - p * p * p) * nu;
    const double omega = speed + 1.5 * q * q * (1 + p) * nu;
    const double load = x[LOAD_EST] - q * q * q * nu;

    /* prediction to S(k+1) */
    const double disturbance =
        x[DISTURBANCE] + loop.disturbance_gain * (x[CURRENT] - x[PREDICTED] - x[DISTURBANCE]);
    const double undisturbed = x[CURRENT] + x[DEMAND];
    const double current = undisturbed + disturbance;
    const double a = (x[CURRENT] + current) / 2 - load;
    const double omega_next = omega + a;
    const double theta_next = theta + omega - load / 2 + integrated_twice(x[CURRENT], current);

    /* law, for a reference at rest in zero */
    const double change = -loop.k.k_position_s2 * period_s * period_s * theta_next -
                          loop.k.k_speed_s * period_s * omega_next -
                          loop.k.k_acceleration * (current - load);

    /* the motor: the current goes linearly through the period */
    const double rise = x[DEMAND] / motor.inductance;
    const double k = motor.acceleration;
    y[THETA] = x[THETA] + x[OMEGA] + k * (x[CURRENT] / 2 + rise / 6);
    y[OMEGA] = x[OMEGA] + k * (x[CURRENT] + rise / 2);
    y[CURRENT] = x[CURRENT] + rise;
    y[PAST_CURRENT] = x[CURRENT];
    y[DEMAND] = change - disturbance;
    y[PREDICTED] = undisturbed;
    y[THETA_EST] = theta;
    y[OMEGA_EST] = omega;
    y[LOAD_EST] = load;
    y[DISTURBANCE] = disturbance;
    return y;
}

Matrix transition(const Loop &loop, const Mismatch &motor)
{
    Matrix a;
    for (int i = 0; i < STATES; ++i) {
        a.col(i) = step(State::Unit(i), loop, motor);
    }
    return a;
}

double slowest(const Loop &loop, const Mismatch &motor)
{
    return reference::spectral_radius(transition(loop, motor));
}

/* The worst over all corners of `share` of mismatch in inductance, torque constant and inertia. */
double slowest_of_corners(const Loop &loop, double share)
{
    double radius = 0;
    for (const double inductance : {1 - share, 1 + share}) {
        for (const double km : {1 - share, 1 + share}) {
            for (const double inertia : {1 - share, 1 + share}) {
                radius = std::max(radius, slowest(loop, {km / inertia, inductance}));
            }
        }
    }
    return radius;
}

Loop designed(double law, double damping, double current, double observer, double disturbance)
{
    Loop loop{};
    char error[DESIGN_ERROR_TEXT] = "";
    const feedback_linearisation_poles asked = {law, damping, current};
    TEST_ASSERT_TRUE_MESSAGE(feedback_linearisation_design(period_s, &asked, &loop.k, error),
                             error);
    loop.observer_pole = std::exp(-observer * period_s);
    loop.disturbance_gain = 1 - std::exp(-disturbance * period_s);
    return loop;
}
/* How far the nearest pole of the loop is from `wanted`. */
double distance(const std::vector<std::complex<double>> &found, std::complex<double> wanted)
{
    double nearest = 1;
    for (const std::complex<double> &pole : found) {
        nearest = std::min(nearest, std::abs(pole - wanted));
    }
    return nearest;
}

/* The chain of integrators alone, its state known. */
void test_the_poles_of_the_chain_of_integrators_are_the_placed_ones()
{
    for (const double damping : {0.3, 0.7, 0.95}) {
        const feedback_linearisation_gains k = designed(900, damping, 2000, 1400, 1000).k;
        Eigen::Matrix3d a;
        a << 1, 1, 0.5, 0, 1, 1, 0, 0, 1;
        const Eigen::Vector3d b(1.0 / 6, 0.5, 1);
        const Eigen::RowVector3d gain(k.k_position_s2 * period_s * period_s, k.k_speed_s * period_s,
                                      k.k_acceleration);
        const Eigen::Matrix3d closed = a - b * gain;
        const std::vector<std::complex<double>> found = reference::eigenvalues(closed);
        const std::complex<double> pair(-damping * 900, 900 * std::sqrt(1 - damping * damping));

        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, distance(found, std::exp(pair * period_s)));
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, distance(found, std::exp(std::conj(pair) * period_s)));
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, distance(found, std::exp(-2000 * period_s)));
    }
}

/* Of a right model they stay there, whatever the observers do. */
void test_the_poles_of_the_closed_loop_are_the_placed_ones()
{
    for (const double damping : {0.3, 0.7, 0.95}) {
        const double law = 900, current = 2000;
        const Loop loop = designed(law, damping, current, 1400, 1000);
        const std::vector<std::complex<double>> found =
            reference::eigenvalues(transition(loop, {}));
        const std::complex<double> pair(-damping * law, law * std::sqrt(1 - damping * damping));

        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, distance(found, std::exp(pair * period_s)));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, distance(found, std::exp(std::conj(pair) * period_s)));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, distance(found, std::exp(-current * period_s)));
    }
}

/* The bounds of the design stand on this. */
void test_the_loop_is_stable_up_to_its_limits_with_a_fifth_of_mismatch()
{
    const double law = LINEARISED_LAW_BANDWIDTH_PERIOD_MAX / period_s;
    const double current = LINEARISED_CURRENT_BANDWIDTH_PERIOD_MAX / period_s;

    for (const double observer : {1000.0, 1400.0, 2500.0, 5000.0}) {
        for (const double share : {1.0, 0.6, 0.3}) {
            const Loop loop = designed(share * law, 0.7, current, observer, 1000);
            TEST_ASSERT_TRUE(slowest_of_corners(loop, 0.2) < 1);
        }
    }
}

void test_a_third_more_bandwidth_would_not_bear_a_fifth_of_mismatch()
{
    Loop loop = designed(LINEARISED_LAW_BANDWIDTH_PERIOD_MAX / period_s, 0.7,
                         LINEARISED_CURRENT_BANDWIDTH_PERIOD_MAX / period_s, 2500, 1000);
    const double more = 4.0 / 3.0;

    loop.k.k_position_s2 *= more * more;
    loop.k.k_speed_s *= more;
    TEST_ASSERT_TRUE(slowest_of_corners(loop, 0.2) > 1);
}

void test_the_default_bears_a_fifth_of_mismatch()
{
    const Loop loop = designed(900, 0.7, 2000, 1400, 1000);

    TEST_ASSERT_TRUE(slowest_of_corners(loop, 0.2) < 0.992);
}

void test_a_bandwidth_beyond_the_limit_is_refused_with_the_limit()
{
    char error[DESIGN_ERROR_TEXT] = "";
    feedback_linearisation_gains k{};
    const feedback_linearisation_poles fast = {1600, 0.7, 2000};
    const feedback_linearisation_poles stiff = {900, 0.7, 3100};

    TEST_ASSERT_FALSE(feedback_linearisation_design(period_s, &fast, &k, error));
    TEST_ASSERT_EQUAL_STRING("law_bandwidth_rad_s 1600 rad/s: must be at most 1500 rad/s, "
                             "0.15 per control period",
                             error);
    TEST_ASSERT_FALSE(feedback_linearisation_design(period_s, &stiff, &k, error));
    TEST_ASSERT_EQUAL_STRING("current_bandwidth_rad_s 3100 rad/s: must be at most 3000 rad/s, "
                             "0.3 per control period",
                             error);
}

} // namespace

void setUp()
{
}

void tearDown()
{
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_the_poles_of_the_chain_of_integrators_are_the_placed_ones);
    RUN_TEST(test_the_poles_of_the_closed_loop_are_the_placed_ones);
    RUN_TEST(test_the_loop_is_stable_up_to_its_limits_with_a_fifth_of_mismatch);
    RUN_TEST(test_a_third_more_bandwidth_would_not_bear_a_fifth_of_mismatch);
    RUN_TEST(test_the_default_bears_a_fifth_of_mismatch);
    RUN_TEST(test_a_bandwidth_beyond_the_limit_is_refused_with_the_limit);
    return UNITY_END();
}
