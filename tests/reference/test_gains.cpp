/*
 * The position laws' gains against an independent formulation: the matrix exponential of the
 * mechanics with their inputs held, and the eigenvalues of the loop that the gains close.
 */
#include <complex>
#include <unity.h>

#include <Eigen/Dense>

#include "tests/reference/matrix_functions.h"
#include "tests/reference/motors.h"

extern "C" {
#include "firmware/design/mechanical_model.h"
#include "firmware/design/pid_design.h"
#include "firmware/design/state_feedback_design.h"
}

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector2d;

namespace
{

constexpr double period_s = 1e-4;
constexpr double bandwidth_rad_s = 200.0;
constexpr double current_bandwidth_rad_s = 1500.0;

/* [w; theta] over one period; inputs i_q and T_L held. */
struct SampledMechanics {
    Matrix2d a;
    Vector2d b, e;
};

SampledMechanics sampled(const motor_params &motor)
{
    Matrix4d model = Matrix4d::Zero(); /* states w, theta, i_q, T_L */
    model.row(0) << -motor.viscous_friction_Nms_rad, 0.0, motor.torque_constant_Nm_A, -1.0;
    model.row(0) /= motor.inertia_kgm2;
    model(1, 0) = 1.0;
    const Matrix4d step = reference::exponential(model * period_s);
    return {step.topLeftCorner<2, 2>(), step.block<2, 1>(0, 2), step.block<2, 1>(0, 3)};
}

state_feedback_gains state_feedback(const motor_params &motor, double period = period_s)
{
    state_feedback_gains gains{};
    char error[DESIGN_ERROR_TEXT] = "";
    TEST_ASSERT_TRUE_MESSAGE(state_feedback_design(&motor, period, bandwidth_rad_s,
                                                   current_bandwidth_rad_s, &gains, error),
                             error);
    return gains;
}

pid_gains pid(const motor_params &motor)
{
    pid_gains gains{};
    char error[DESIGN_ERROR_TEXT] = "";
    TEST_ASSERT_TRUE_MESSAGE(
        pid_design(&motor, period_s, bandwidth_rad_s, current_bandwidth_rad_s, &gains, error),
        error);
    return gains;
}

void assert_relative(double tolerance, double expected, double actual)
{
    TEST_ASSERT_DOUBLE_WITHIN(tolerance * std::abs(expected), expected, actual);
}

template <class Matrix> void assert_poles(double tolerance, double pole, const Matrix &loop)
{
    for (const std::complex<double> &eigenvalue : reference::eigenvalues(loop)) {
        TEST_ASSERT_DOUBLE_WITHIN(tolerance, 0.0, std::abs(eigenvalue - pole));
    }
}

void sampled_mechanics_are_the_matrix_exponential()
{
    for (const motor_params &motor : reference::motors()) {
        const SampledMechanics expected = sampled(motor);
        const mechanical_model model = mechanical_model_of(&motor, period_s);
        assert_relative(1e-13, expected.a(1, 0), model.a21);
        assert_relative(1e-10, 1.0 - expected.a(0, 0), model.one_minus_a11);
        assert_relative(1e-13, expected.b(0), model.b1);
        assert_relative(1e-11, expected.b(1), model.b2);
        assert_relative(1e-13, expected.e(0), model.e1);
        assert_relative(1e-11, expected.e(1), model.e2);
    }
}

void state_feedback_places_the_double_pole()
{
    for (const motor_params &motor : reference::motors()) {
        const SampledMechanics m = sampled(motor);
        const state_feedback_gains k = state_feedback(motor);
        const Matrix2d loop = m.a - m.b * Eigen::RowVector2d(k.k_speed_As_rad, k.k_angle_A_rad);
        assert_poles(1e-6, 0.98019867330675530, loop); /* e^-0.02 */
    }
}

/* Ackermann with the controllability matrix, as (27) means it. */
void state_feedback_agrees_with_ackermann()
{
    const SampledMechanics m = sampled(reference::bendjedia_2012());
    const double pole = std::exp(-bandwidth_rad_s * period_s);
    Matrix2d controllability;
    controllability << m.b, m.a * m.b;
    const Matrix2d polynomial =
        (m.a - pole * Matrix2d::Identity()) * (m.a - pole * Matrix2d::Identity());
    const Eigen::RowVector2d expected =
        Eigen::RowVector2d(0.0, 1.0) * controllability.inverse() * polynomial;
    const state_feedback_gains k = state_feedback(reference::bendjedia_2012());
    assert_relative(1e-7, expected(0), k.k_speed_As_rad);
    assert_relative(1e-7, expected(1), k.k_angle_A_rad);
}

/* The printed gains, 0.405 and 40.746, lie at the continuous limit of Km = 1 / 6.536. */
void printed_gains_are_the_continuous_limit()
{
    motor_params motor = reference::bendjedia_2012();
    motor.torque_constant_Nm_A = 0.153;
    const state_feedback_gains k = state_feedback(motor, 1e-7);
    assert_relative(
        1e-4, (2.0 * bandwidth_rad_s * motor.inertia_kgm2 - motor.viscous_friction_Nms_rad) / 0.153,
        k.k_speed_As_rad);
    assert_relative(0.004, 0.405, k.k_speed_As_rad);
    assert_relative(0.004, 40.746, k.k_angle_A_rad);
    TEST_ASSERT_DOUBLE_WITHIN(0.0005, 6.536, k.k_load_A_Nm);
}

void state_feedback_rests_on_the_reference_under_a_known_load()
{
    const motor_params motor = reference::bendjedia_2012();
    const SampledMechanics m = sampled(motor);
    const state_feedback_gains k = state_feedback(motor);
    Vector2d x = Vector2d::Zero();
    for (int i = 0; i < 3000; i++) {
        const double current = k.k_angle_reference_A_rad * 1.0 - k.k_angle_A_rad * x(1) -
                               k.k_speed_As_rad * x(0) + k.k_load_A_Nm * 0.1;
        x = m.a * x + m.b * current + m.e * 0.1;
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.0, x(1));
}

/* Without the last two terms the lag at constant speed is (2 / w0) v, the paper's Fig. 11. */
void feed_forward_removes_the_lag_at_constant_speed()
{
    const motor_params motor = reference::bendjedia_2012();
    const SampledMechanics m = sampled(motor);
    const state_feedback_gains k = state_feedback(motor);
    const double speed = 40.0;
    for (const bool feed_forward : {false, true}) {
        Vector2d x = Vector2d::Zero();
        double reference = 0.0;
        for (int i = 0; i < 3000; i++) {
            reference = speed * period_s * i;
            const double current = k.k_angle_reference_A_rad * reference - k.k_angle_A_rad * x(1) -
                                   k.k_speed_As_rad * x(0) +
                                   (feed_forward ? k.k_speed_reference_As_rad * speed : 0.0);
            x = m.a * x + m.b * current;
        }
        const double lag = reference + speed * period_s - x(1);
        if (feed_forward) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, lag);
        } else {
            assert_relative(0.02, 2.0 / bandwidth_rad_s * speed, lag);
        }
    }
}

void pid_places_the_triple_pole()
{
    for (const motor_params &motor : reference::motors()) {
        const SampledMechanics m = sampled(motor);
        const pid_gains k = pid(motor);
        Matrix3d loop = Matrix3d::Zero(); /* states w, theta, sum of -theta */
        loop.topLeftCorner<2, 2>() =
            m.a - m.b * Eigen::RowVector2d(k.k_speed_As_rad, k.k_proportional_A_rad);
        loop.block<2, 1>(0, 2) = m.b * k.k_integral_step_A_rad;
        loop.row(2) << 0.0, -1.0, 1.0;
        assert_poles(1e-4, 0.98019867330675530, loop); /* a triple pole: cube root of rounding */
    }
}

void pid_rests_on_the_reference_under_an_unknown_load()
{
    const motor_params motor = reference::bendjedia_2012();
    const SampledMechanics m = sampled(motor);
    const pid_gains k = pid(motor);
    Vector2d x = Vector2d::Zero();
    double sum = 0.0;
    for (int i = 0; i < 3000; i++) {
        const double current = k.k_proportional_A_rad * (1.0 - x(1)) +
                               k.k_integral_step_A_rad * sum - k.k_speed_As_rad * x(0);
        sum += 1.0 - x(1);
        x = m.a * x + m.b * current + m.e * 0.1;
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.0, x(1));
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
    RUN_TEST(sampled_mechanics_are_the_matrix_exponential);
    RUN_TEST(state_feedback_places_the_double_pole);
    RUN_TEST(state_feedback_agrees_with_ackermann);
    RUN_TEST(printed_gains_are_the_continuous_limit);
    RUN_TEST(state_feedback_rests_on_the_reference_under_a_known_load);
    RUN_TEST(feed_forward_removes_the_lag_at_constant_speed);
    RUN_TEST(pid_places_the_triple_pole);
    RUN_TEST(pid_rests_on_the_reference_under_an_unknown_load);
    return UNITY_END();
}
