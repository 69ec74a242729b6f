/*
 * The invariant estimator's gains against an independent formulation: the error model is the
 * numerical Jacobian of the phase equations, the gain comes from the Riccati recursion run period
 * by period, and what is left of it is judged by the eigenvalues of the estimation error.
 */
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstring>
#include <string>
#include <unity.h>

#include <Eigen/Dense>

#include "tests/reference/matrix_functions.h"
#include "tests/reference/motors.h"

extern "C" {
#include "firmware/design/invariant_ekf_design.h"
}

using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::complex;

namespace
{

constexpr double period_s = 1e-4;

/* Where the estimation error is linearised. */
struct OperatingPoint {
    double speed_rad_s, i_d_A;
};

/* Errors: current (d, q of the estimated frame), w, theta, T_L, voltage offset (d, q of it). */
enum { I_D, I_Q, SPEED, ANGLE, LOAD, BIAS_D, BIAS_Q, STATES };

/* True rotor and winding, or their estimate. */
struct Rotor {
    complex<double> current, bias; /* in phase coordinates */
    double speed, angle, load;
};

Rotor rate(const motor_params &m, const Rotor &x, complex<double> voltage)
{
    const complex<double> magnet = std::polar(1.0, m.rotor_teeth * x.angle);
    const complex<double> emf = complex<double>(0, 1) * m.torque_constant_Nm_A * x.speed * magnet;
    const double torque = m.torque_constant_Nm_A * (x.current * std::conj(magnet)).imag();
    Rotor d{};
    d.current = (voltage - x.bias - m.resistance_ohm * x.current - emf) / m.inductance_H;
    d.speed = (torque - m.viscous_friction_Nms_rad * x.speed - x.load) / m.inertia_kgm2;
    d.angle = x.speed;
    return d;
}

/* d/dt of the error, for a small error e around an estimate at the operating point. */
VectorXd error_rate(const motor_params &m, OperatingPoint at, const VectorXd &e)
{
    const double angle = 0.7; /* any: the error model must not depend on it */
    const complex<double> frame = std::polar(1.0, m.rotor_teeth * angle);
    const complex<double> voltage = 3.0 * frame; /* any, both see it */
    const Rotor estimate{at.i_d_A * frame, 0.0, at.speed_rad_s, angle, 0.03};
    const Rotor truth{estimate.current + complex<double>(e(I_D), e(I_Q)) * frame,
                      complex<double>(e(BIAS_D), e(BIAS_Q)) * frame, estimate.speed + e(SPEED),
                      estimate.angle + e(ANGLE), estimate.load + e(LOAD)};
    const Rotor d_truth = rate(m, truth, voltage);
    const Rotor d_estimate = rate(m, estimate, voltage);
    const complex<double> epsilon(e(I_D), e(I_Q));
    const complex<double> d_epsilon = (d_truth.current - d_estimate.current) * std::conj(frame) -
                                      complex<double>(0, m.rotor_teeth * at.speed_rad_s) * epsilon;
    /* constant in phase coordinates, it turns backwards in the frame */
    const complex<double> d_bias =
        -complex<double>(0, m.rotor_teeth * at.speed_rad_s) * complex<double>(e(BIAS_D), e(BIAS_Q));
    VectorXd result(STATES);
    result << d_epsilon.real(), d_epsilon.imag(), d_truth.speed - d_estimate.speed,
        d_truth.angle - d_estimate.angle, 0.0, d_bias.real(), d_bias.imag();
    return result;
}

MatrixXd transition(const motor_params &m, OperatingPoint at, int states, double period = period_s)
{
    const double size[STATES] = {1e-3, 1e-3, 1e-2, 1e-6, 1e-3, 1e-3, 1e-3};
    MatrixXd jacobian(STATES, STATES);
    for (int j = 0; j < STATES; j++) {
        const VectorXd e = VectorXd::Unit(STATES, j) * size[j];
        jacobian.col(j) = (error_rate(m, at, e) - error_rate(m, at, -e)) / (2.0 * size[j]);
    }
    return reference::exponential(jacobian.topLeftCorner(states, states) * period);
}

/* (9), (10), (12), period by period from P = Q. */
MatrixXd kalman_gain(const MatrixXd &f, const VectorXd &q, double r, int periods)
{
    MatrixXd p = q.asDiagonal();
    MatrixXd k;
    for (int i = 0; i < periods; i++) {
        const Eigen::Matrix2d s = p.topLeftCorner<2, 2>() + r * Eigen::Matrix2d::Identity();
        k = p.leftCols<2>() * s.inverse();
        p = f * (p - k * p.topRows<2>()) * f.transpose();
        p.diagonal() += q;
        p = (0.5 * (p + p.transpose())).eval();
    }
    return k;
}

invariant_ekf_gains motion_design(const motor_params &motor, double period = period_s)
{
    invariant_ekf_gains gains{};
    char error[DESIGN_ERROR_TEXT] = "";
    TEST_ASSERT_TRUE_MESSAGE(invariant_ekf_motion_design(&motor, period, &gains, error), error);
    return gains;
}

invariant_ekf_hold_gains hold_design(const motor_params &motor, double current_A,
                                     double period = period_s)
{
    invariant_ekf_hold_gains gains{};
    char error[DESIGN_ERROR_TEXT] = "";
    TEST_ASSERT_TRUE_MESSAGE(invariant_ekf_hold_design(&motor, period, current_A, &gains, error),
                             error);
    return gains;
}

void assert_relative(double tolerance, double expected, double actual, const char *name)
{
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(tolerance * std::abs(expected), expected, actual, name);
}

/* The kept gains. */
MatrixXd correction(const invariant_ekf_gains &k, double speed_rad_s)
{
    /* The drive corrects the phase currents, so both axes share the mean of the two gains. */
    const double k_current = 0.5 * (k.k_current_d + k.k_current_q);
    const double direction = std::clamp(speed_rad_s / k.angle_d_full_speed_rad_s, -1.0, 1.0);
    MatrixXd correction = MatrixXd::Identity(STATES, STATES);
    correction(I_D, I_D) -= k_current;
    correction(I_Q, I_Q) -= k_current;
    correction(SPEED, I_Q) -= k.k_speed_q_rad_As;
    correction(ANGLE, I_D) -= k.k_angle_d_rad_A * direction;
    correction(ANGLE, I_Q) -= k.k_angle_q_rad_A;
    correction(LOAD, I_Q) -= k.k_load_q_Nm_A;
    correction(BIAS_Q, I_D) -= k.k_bias_d_V_A * direction;
    correction(BIAS_Q, I_Q) -= k.k_bias_q_V_A;
    correction(LOAD, LOAD) -= k.load_return;
    correction(ANGLE, LOAD) += k.angle_return_rad_Nm;
    correction(BIAS_Q, LOAD) -= k.bias_return_V_Nm;
    return correction;
}

/* Spectral radius of one period of the estimation error: correct, predict. */
double spectral_radius(const motor_params &motor, const invariant_ekf_gains &k, OperatingPoint at,
                       int states, double period = period_s)
{
    const MatrixXd step = transition(motor, at, states, period) *
                          correction(k, at.speed_rad_s).topLeftCorner(states, states);
    return reference::spectral_radius(step);
}

double top_speed(const motor_params &motor, double period)
{
    const double no_load = motor.supply_V / motor.torque_constant_Nm_A;
    return std::min(no_load, 1.0 / (motor.rotor_teeth * period)); /* 1 electrical rad per sample */
}

void motion_gains_are_the_steady_kalman_gain_at_5_rad_s()
{
    const motor_params motor = reference::bendjedia_2012();
    const double current_noise = std::pow(0.03 * period_s / motor.inductance_H, 2);
    VectorXd q(5);
    q << current_noise, current_noise, 1e-6, 1e-8, 1e-6;
    const MatrixXd k = kalman_gain(transition(motor, {5.0, 0.0}, 5), q, 3.9e-5, 4000);
    const invariant_ekf_gains gains = motion_design(motor);
    assert_relative(1e-6, k(I_D, 0), gains.k_current_d, "i_d");
    assert_relative(1e-6, k(I_Q, 1), gains.k_current_q, "i_q");
    assert_relative(1e-6, k(SPEED, 1), gains.k_speed_q_rad_As, "w");
    assert_relative(1e-6, k(ANGLE, 0), gains.k_angle_d_rad_A, "theta from d");
    assert_relative(1e-6, k(ANGLE, 1), gains.k_angle_q_rad_A, "theta from q");
    assert_relative(1e-6, k(LOAD, 1), gains.k_load_q_Nm_A, "T_L");
}

void hold_gains_are_the_steady_kalman_gain_at_1_rad_s()
{
    const motor_params motor = reference::bendjedia_2012();
    const double current_noise = std::pow(0.03 * period_s / motor.inductance_H, 2);
    const invariant_ekf_hold_gains holds = hold_design(motor, 1.5);
    const struct {
        const invariant_ekf_gains &gains;
        double load_walk;
    } cases[] = {{holds.quiet, 1e-6}, {holds.following, 6.25e-6}};
    for (const auto &[gains, load_walk] : cases) {
        const double current_walk = std::pow(0.4 / motor.torque_constant_Nm_A, 2) * load_walk;
        const double current = std::max(current_noise, current_walk);
        VectorXd q(5);
        q << current, current, 1e-6, 1e-12, load_walk;
        const MatrixXd k = kalman_gain(transition(motor, {1.0, 1.5}, 5), q, 9.7e-6, 32768);
        assert_relative(1e-5, k(I_D, 0), gains.k_current_d, "i_d");
        assert_relative(1e-5, k(I_Q, 1), gains.k_current_q, "i_q");
        assert_relative(1e-5, k(SPEED, 1), gains.k_speed_q_rad_As, "w");
        assert_relative(1e-5, k(LOAD, 1), gains.k_load_q_Nm_A, "T_L");
    }
}

/* What an error becomes in hold in so many periods, and the sum of its innovations' size. */
struct Course {
    VectorXd error;
    double innovations;
};

Course course(const MatrixXd &predict, const invariant_ekf_gains &k, VectorXd error, int periods)
{
    const MatrixXd correct = correction(k, 0.0);
    double innovations = 0.0;
    for (int i = 0; i < periods; i++) {
        innovations += std::abs(error(I_Q));
        error = (predict * correct * error).eval();
    }
    return {error, innovations};
}

Course course(const motor_params &motor, const invariant_ekf_gains &k, double current_A,
              VectorXd error, int periods)
{
    return course(transition(motor, {0.0, current_A}, STATES), k, error, periods);
}

/* As the drive predicts: with the back-EMF of the speed at the period's begin. What the rotor's
   acceleration adds to it within periods is nothing in sum, from rest to rest. */
MatrixXd transition_of_the_drive(const motor_params &m, double current_A)
{
    const double decay = std::exp(-period_s * m.resistance_ohm / m.inductance_H);
    MatrixXd predict = transition(m, {0.0, current_A}, STATES);
    predict(I_Q, I_Q) = decay;
    predict(I_Q, SPEED) = -m.torque_constant_Nm_A * (1.0 - decay) / m.resistance_ohm;
    predict(I_Q, ANGLE) = 0.0;
    predict(I_Q, LOAD) = 0.0;
    return predict;
}

/* The angle follows the flux: a load step leaves neither load nor displacement behind. */
void a_load_step_leaves_nothing_behind()
{
    for (const motor_params &motor : reference::motors()) {
        const double current = 0.5 * motor.rated_current_A;
        const invariant_ekf_gains gains = hold_design(motor, current).following;
        const double stiffness = motor.rotor_teeth * motor.torque_constant_Nm_A * current;
        const MatrixXd predict = transition_of_the_drive(motor, current);
        const VectorXd error = course(predict, gains, VectorXd::Unit(STATES, LOAD), 20000).error;
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.0, error(LOAD));
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.0, error(ANGLE) * stiffness);
    }
}

/* What load and displacement have wrong together, in balance, shows in no current; the settled hold
   takes it back all the same, and still shows none. */
void the_settled_hold_returns_without_an_innovation()
{
    for (const motor_params &motor : reference::motors()) {
        const double current = 0.5 * motor.rated_current_A;
        invariant_ekf_gains gains = hold_design(motor, current).quiet;
        const double stiffness = motor.rotor_teeth * motor.torque_constant_Nm_A * current;
        gains.bias_return_V_Nm = 0.0;
        VectorXd error = VectorXd::Zero(STATES);
        error(LOAD) = 1.0;
        error(ANGLE) = -1.0 / stiffness;
        const Course settled = course(motor, gains, current, error, 100);
        const double w_h = std::sqrt(stiffness / motor.inertia_kgm2);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, std::exp(-100 * period_s * w_h / 3.0), settled.error(LOAD));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, settled.innovations / motor.rated_current_A);
    }
}

/* The slower of the two modes of return and offset has 7 times the time of the return. */
void a_settled_hold_finds_an_offset_while_the_rotor_could_swing_fifteen_times()
{
    for (const motor_params &motor : reference::motors()) {
        const double current = 0.5 * motor.rated_current_A;
        const invariant_ekf_gains gains = hold_design(motor, current).quiet;
        const double w_h = std::sqrt(motor.rotor_teeth * motor.torque_constant_Nm_A * current /
                                     motor.inertia_kgm2);
        const int periods = static_cast<int>(15 * 2 * M_PI / w_h / period_s);
        const VectorXd error =
            course(motor, gains, current, VectorXd::Unit(STATES, BIAS_Q), periods).error;
        TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.0, error(BIAS_Q));
    }
}

/* Decay of the slowest error, 1/s. */
double decay(double radius, double period)
{
    return -std::log(radius) / period;
}

void estimation_error_decays_at_every_speed_and_current_of_every_motor()
{
    for (const motor_params &motor : reference::motors()) {
        for (const double period : {50e-6, 100e-6, 200e-6}) {
            const invariant_ekf_gains gains = motion_design(motor, period);
            for (double speed = 1.0; speed <= top_speed(motor, period); speed *= 1.25) {
                for (const double sign : {1.0, -1.0}) {
                    for (const double load : {0.0, 0.5, 1.0}) {
                        const OperatingPoint at{sign * speed, load * motor.rated_current_A};
                        const double radius = spectral_radius(motor, gains, at, 5, period);
                        TEST_ASSERT_TRUE_MESSAGE(decay(radius, period) > 5.0,
                                                 ("grows at " + std::to_string(at.speed_rad_s) +
                                                  " rad/s, i_d " + std::to_string(at.i_d_A))
                                                     .c_str());
                    }
                }
            }
        }
    }
}

void estimation_error_of_the_reference_motor_decays_in_six_milliseconds()
{
    const motor_params motor = reference::bendjedia_2012();
    const invariant_ekf_gains gains = motion_design(motor);
    for (const double sign : {1.0, -1.0}) {
        for (const double speed : {1.0, 2.0, 5.0, 20.0, 50.0, 150.0}) {
            for (const double i_d : {0.0, 1.5, 3.0}) {
                const double radius = spectral_radius(motor, gains, {sign * speed, i_d}, 5);
                TEST_ASSERT_TRUE(decay(radius, period_s) > 1.0 / 6e-3);
            }
        }
    }
}

/* With the voltage offset among the errors; 2.5 1/s at worst on the reference motor. */
void a_voltage_offset_is_found_at_every_speed_and_current_of_every_motor()
{
    for (const motor_params &motor : reference::motors()) {
        for (const double period : {50e-6, 100e-6, 200e-6}) {
            const invariant_ekf_gains gains = motion_design(motor, period);
            for (double speed = 1.0; speed <= top_speed(motor, period); speed *= 1.25) {
                for (const double sign : {1.0, -1.0}) {
                    for (const double load : {0.0, 0.5, 1.0}) {
                        const OperatingPoint at{sign * speed, load * motor.rated_current_A};
                        const double radius = spectral_radius(motor, gains, at, STATES, period);
                        TEST_ASSERT_TRUE_MESSAGE(decay(radius, period) > 0.7,
                                                 ("stays at " + std::to_string(at.speed_rad_s) +
                                                  " rad/s, i_d " + std::to_string(at.i_d_A))
                                                     .c_str());
                    }
                }
            }
        }
    }
}

/* Why the gain from d to theta is odd in the speed. */
void angle_gain_without_its_sign_loses_one_direction()
{
    const motor_params motor = reference::bendjedia_2012();
    invariant_ekf_gains gains = motion_design(motor);
    gains.k_angle_d_rad_A = -gains.k_angle_d_rad_A;
    TEST_ASSERT_TRUE(spectral_radius(motor, gains, {20.0, 0.0}, 5) > 1.0);
    gains.k_angle_d_rad_A = 0.0;
    TEST_ASSERT_TRUE(decay(spectral_radius(motor, gains, {1.0, 0.0}, 5), period_s) < 10.0);
}

/*
 * A constant load and its displacement have no current signature: one error stays, none grows. The
 * offset of the voltage is constant in a held frame, so it is one of the errors at rest, where the
 * settled hold learns it; a rotor that swings about the frame does not turn it. At a lasting speed,
 * which a held rotor has not, the settled hold's return to its load may feed the angle error, with
 * 0.2 1/s, and with 0.6 1/s where a stiff hold returns within 10 ms: at 1 rad/s such a rotor has
 * left its quarter turn after 31 ms, and the error has grown by 2 %.
 */
void no_error_grows_in_hold()
{
    for (const motor_params &motor : reference::motors()) {
        for (const double period : {50e-6, 100e-6, 200e-6}) {
            const double current = 0.5 * motor.rated_current_A;
            const invariant_ekf_hold_gains hold = hold_design(motor, current, period);
            for (const invariant_ekf_gains &gains : {hold.quiet, hold.following}) {
                for (const double speed : {-5.0, -1.0, 0.0, 1.0, 5.0}) {
                    for (const double part : {0.1, 0.5, 1.0}) { /* of the current, ramping in */
                        const OperatingPoint at{speed, part * current};
                        const bool offset = speed == 0.0 && gains.load_return > 0.0;
                        const int states = offset ? STATES : LOAD + 1;
                        const bool turns = speed != 0.0 && gains.load_return > 0.0;
                        const double radius = spectral_radius(motor, gains, at, states, period);
                        TEST_ASSERT_TRUE(turns ? decay(radius, period) > -0.6
                                               : radius < 1.0 + 1e-6);
                    }
                }
            }
        }
    }
}

void full_angle_correction_begins_at_the_same_back_emf_on_every_motor()
{
    for (const motor_params &motor : reference::motors()) {
        const invariant_ekf_gains gains = motion_design(motor);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.157 / 24.0,
                                  gains.angle_d_full_speed_rad_s * motor.torque_constant_Nm_A /
                                      motor.supply_V);
    }
}

/* Gains of `motor` in units of its own voltage, current and torque against another's. */
void assert_same_gains(const motor_params &motor, const motor_params &other, double voltage_ratio,
                       double current_ratio)
{
    const double torque_ratio = voltage_ratio * current_ratio; /* speeds are the same */
    const invariant_ekf_gains a = motion_design(motor);
    const invariant_ekf_gains b = motion_design(other);
    assert_relative(1e-9, a.k_current_d, b.k_current_d, "i_d");
    assert_relative(1e-9, a.k_current_q, b.k_current_q, "i_q");
    assert_relative(1e-9, a.k_speed_q_rad_As, b.k_speed_q_rad_As * current_ratio, "w");
    assert_relative(1e-9, a.k_angle_d_rad_A, b.k_angle_d_rad_A * current_ratio, "theta from d");
    assert_relative(1e-9, a.k_angle_q_rad_A, b.k_angle_q_rad_A * current_ratio, "theta from q");
    assert_relative(1e-9, a.k_load_q_Nm_A, b.k_load_q_Nm_A * current_ratio / torque_ratio, "T_L");
    assert_relative(1e-9, a.angle_d_full_speed_rad_s, b.angle_d_full_speed_rad_s, "full speed");

    const double resistance_ratio = voltage_ratio / current_ratio;
    assert_relative(1e-9, a.k_bias_d_V_A, b.k_bias_d_V_A / resistance_ratio, "b");
    const invariant_ekf_hold_gains hold = hold_design(motor, 1.5);
    const invariant_ekf_hold_gains other_hold = hold_design(other, 1.5 * current_ratio);
    for (const auto kind : {&invariant_ekf_hold_gains::quiet, &invariant_ekf_hold_gains::following,
                            &invariant_ekf_hold_gains::unloaded}) {
        const invariant_ekf_gains c = hold.*kind;
        const invariant_ekf_gains d = other_hold.*kind;
        assert_relative(1e-5, c.k_current_d, d.k_current_d, "i_d, hold");
        assert_relative(1e-5, c.k_load_q_Nm_A, d.k_load_q_Nm_A * current_ratio / torque_ratio,
                        "T_L, hold");
        assert_relative(1e-5, c.k_angle_q_rad_A, d.k_angle_q_rad_A * current_ratio, "theta, hold");
        assert_relative(1e-5, c.k_bias_q_V_A, d.k_bias_q_V_A / resistance_ratio, "b");
        assert_relative(1e-5, c.bias_return_V_Nm, d.bias_return_V_Nm * torque_ratio / voltage_ratio,
                        "return of b");
        assert_relative(1e-5, c.k_resistance_ohm_A2,
                        d.k_resistance_ohm_A2 * current_ratio * current_ratio / resistance_ratio,
                        "R");
    }
}

void gains_follow_a_motor_with_twice_the_turns()
{
    const motor_params motor = reference::bendjedia_2012();
    motor_params other = motor; /* half the current at twice the voltage, the same torque */
    other.resistance_ohm *= 4.0;
    other.inductance_H *= 4.0;
    other.torque_constant_Nm_A *= 2.0;
    other.rated_current_A *= 0.5;
    other.supply_V *= 2.0;
    assert_same_gains(motor, other, 2.0, 0.5);
}

/* The whole error model, in float's stead its Jacobian: d axis and all. */
double thrown_rad(const motor_params &motor, double load_step_Nm)
{
    const OperatingPoint at = {1e-3, 0.0};
    const MatrixXd step = transition(motor, at, 5) *
                          correction(motion_design(motor), at.speed_rad_s).topLeftCorner(5, 5);
    VectorXd error = VectorXd::Unit(5, LOAD) * load_step_Nm;
    double peak = 0;
    for (int k = 0; k < 1000; k++) {
        error = step * error;
        peak = std::max(peak, std::abs(error(ANGLE)));
    }
    return peak * motor.rotor_teeth;
}

void a_load_step_throws_the_angle_as_far_as_the_check_says()
{
    motor_params motor = reference::bendjedia_2012();
    for (double back_emf = 1.0; back_emf > 0.1; back_emf *= 0.6) {
        motor.torque_constant_Nm_A = 0.157 * back_emf;
        const invariant_ekf_gains gains = motion_design(motor);
        const double expected = thrown_rad(motor, 0.1);
        TEST_ASSERT_DOUBLE_WITHIN(0.03 * expected, expected,
                                  invariant_ekf_thrown_rad(&motor, period_s, &gains, 0.1));
    }
}

void a_motor_without_back_emf_to_speak_of_is_refused_by_what_a_load_step_does()
{
    char error[DESIGN_ERROR_TEXT] = "";
    motor_params motor = reference::bendjedia_2012();
    invariant_ekf_gains gains = motion_design(motor);
    TEST_ASSERT_TRUE_MESSAGE(invariant_ekf_motion_check(&motor, period_s, &gains, error), error);
    motor.torque_constant_Nm_A /= 20.0;
    motor.inertia_kgm2 /= 20.0;
    gains = motion_design(motor);
    TEST_ASSERT_FALSE(invariant_ekf_motion_check(&motor, period_s, &gains, error));
    TEST_ASSERT_EQUAL_MEMORY("load_step_angle_error ", error, 22);
    TEST_ASSERT_NOT_NULL(
        strstr(error, "must be at most 20 degrees electrical, of 25 % of the rated torque"));
}

void gains_follow_two_motors_on_one_shaft()
{
    const motor_params motor = reference::bendjedia_2012();
    motor_params other = motor; /* in parallel: twice the current, torque, inertia, friction */
    other.resistance_ohm *= 0.5;
    other.inductance_H *= 0.5;
    other.rated_current_A *= 2.0;
    other.inertia_kgm2 *= 2.0;
    other.viscous_friction_Nms_rad *= 2.0;
    assert_same_gains(motor, other, 1.0, 2.0);
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
    RUN_TEST(motion_gains_are_the_steady_kalman_gain_at_5_rad_s);
    RUN_TEST(hold_gains_are_the_steady_kalman_gain_at_1_rad_s);
    RUN_TEST(a_load_step_leaves_nothing_behind);
    RUN_TEST(the_settled_hold_returns_without_an_innovation);
    RUN_TEST(a_settled_hold_finds_an_offset_while_the_rotor_could_swing_fifteen_times);
    RUN_TEST(estimation_error_decays_at_every_speed_and_current_of_every_motor);
    RUN_TEST(estimation_error_of_the_reference_motor_decays_in_six_milliseconds);
    RUN_TEST(a_voltage_offset_is_found_at_every_speed_and_current_of_every_motor);
    RUN_TEST(angle_gain_without_its_sign_loses_one_direction);
    RUN_TEST(no_error_grows_in_hold);
    RUN_TEST(full_angle_correction_begins_at_the_same_back_emf_on_every_motor);
    RUN_TEST(gains_follow_a_motor_with_twice_the_turns);
    RUN_TEST(a_load_step_throws_the_angle_as_far_as_the_check_says);
    RUN_TEST(a_motor_without_back_emf_to_speak_of_is_refused_by_what_a_load_step_does);
    RUN_TEST(gains_follow_two_motors_on_one_shaft);
    return UNITY_END();
}
