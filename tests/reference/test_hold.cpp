/*
 * The d-axis hold in one piece: plant by zero-order hold, the voltage that is still to act, the
 * estimator with the drive's own gains, its prediction over the delay, damping and current control.
 * Its modes are found by Eigen, and the firmware's check of two small loops must say the same.
 */
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstring>
#include <string>
#include <unity.h>
#include <utility>

#include <Eigen/Dense>

#include "tests/reference/matrix_functions.h"
#include "tests/reference/motors.h"

extern "C" {
#include "firmware/design/hold_check.h"
#include "firmware/design/modes.h"
#include "firmware/drive/default_settings.h"
}

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace
{

constexpr double period_s = 1e-4;

/* True rotor, voltage in force since the last S(k), estimate, integrator of the current control;
   and behind them the voltage that has been computed at the last S(k). */
enum { I, W, THETA, VOLTAGE, I_EST, W_EST, THETA_EST, LOAD_EST, OFFSET_EST, INTEGRAL, STATES };

struct Hold {
    motor_params motor;
    double current_A;
    double damping_As_rad;
    double current_bandwidth_rad_s;
    invariant_ekf_gains gains;
    double feigned_share;
};

/* i_q, w, theta under voltage, load and offset, over one period: [transition | input]. */
MatrixXd rotor_step(const Hold &hold, double inductance_scale = 1)
{
    motor_params m = hold.motor;
    m.inductance_H *= inductance_scale;
    MatrixXd rate = MatrixXd::Zero(6, 6);
    rate.row(0) << -m.resistance_ohm / m.inductance_H, -m.torque_constant_Nm_A / m.inductance_H, 0,
        1 / m.inductance_H, 0, -1 / m.inductance_H;
    rate.row(1) << m.torque_constant_Nm_A / m.inertia_kgm2,
        -m.viscous_friction_Nms_rad / m.inertia_kgm2,
        -m.torque_constant_Nm_A * m.rotor_teeth * hold.current_A / m.inertia_kgm2, 0,
        -1 / m.inertia_kgm2, 0;
    rate(2, 1) = 1;
    return reference::exponential(rate * period_s).topRows(3);
}

/* From just behind the answer of S(k) to just behind that of S(k+1). */
VectorXd period(const Hold &hold, const VectorXd &x, double load_Nm = 0,
                double inductance_scale = 1)
{
    const motor_params &m = hold.motor;
    const invariant_ekf_gains &k = hold.gains;
    const MatrixXd step = rotor_step(hold);
    VectorXd next(STATES);
    VectorXd truth(6), model(6);
    truth << x(I), x(W), x(THETA), x(VOLTAGE), load_Nm, 0;
    model << x(I_EST), x(W_EST), x(THETA_EST), x(VOLTAGE), x(LOAD_EST), x(OFFSET_EST);
    const Eigen::Vector3d now = rotor_step(hold, inductance_scale) * truth;
    const Eigen::Vector3d predicted = step * model;
    const double innovation = now(0) - predicted(0);
    next.segment<3>(I) = now;
    next(I_EST) = predicted(0) + 0.5 * (k.k_current_d + k.k_current_q) * innovation;
    next(W_EST) = predicted(1) + k.k_speed_q_rad_As * innovation;
    next(THETA_EST) =
        predicted(2) + k.k_angle_q_rad_A * innovation + k.angle_return_rad_Nm * x(LOAD_EST);
    next(LOAD_EST) = x(LOAD_EST) * (1 - k.load_return) + k.k_load_q_Nm_A * innovation;
    next(OFFSET_EST) =
        x(OFFSET_EST) + k.k_bias_q_V_A * innovation - k.bias_return_V_Nm * x(LOAD_EST);
    /* The voltage of the last S(k) acts now; with it the drive predicts S(k+1), where its new one
       begins to act. */
    const double acting = x(STATES);
    VectorXd coming(6);
    coming << next(I_EST), next(W_EST), next(THETA_EST), acting, next(LOAD_EST), next(OFFSET_EST);
    const Eigen::Vector3d ahead = step * coming;
    const double wanted = next(LOAD_EST) / m.torque_constant_Nm_A - hold.damping_As_rad * ahead(1);
    const double error = wanted - ahead(0);
    next(VOLTAGE) = acting;
    next(INTEGRAL) =
        x(INTEGRAL) + m.resistance_ohm * hold.current_bandwidth_rad_s * period_s * error;
    VectorXd all(STATES + 1);
    all << next, m.inductance_H * hold.current_bandwidth_rad_s * error + x(INTEGRAL) +
                     m.torque_constant_Nm_A * ahead(1);
    return all;
}

/* Smallest damping ratio of the modes faster than 1 rad/s, of a motor with so much of the
   inductance that its drive assumes. */
double damping_in_one_piece(const Hold &hold, double inductance_scale = 1)
{
    constexpr int n = STATES + 1; /* and the voltage that begins to act a period later */
    const int last = hold.gains.bias_return_V_Nm == 0 ? OFFSET_EST : -1;
    MatrixXd loop(n, n);
    for (int j = 0; j < n; j++) {
        loop.col(j) = period(hold, VectorXd::Unit(n, j), 0, inductance_scale);
    }
    if (last >= 0) { /* an offset that is not estimated is none of the modes */
        loop.row(last).setZero();
        loop.col(last).setZero();
    }
    double least = 1;
    for (const std::complex<double> z : reference::eigenvalues(loop)) {
        if (std::abs(z) < 1e-6) {
            continue; /* the delay */
        }
        const std::complex<double> s = std::log(z) / period_s;
        if (std::abs(s) > 1) {
            least = std::min(least, -s.real() / std::abs(s));
        }
    }
    return least;
}

/* Motors over the ranges of data sheets, each from its number alone. */
struct Draw {
    std::uint64_t state;
    double operator()(double low, double high)
    {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return low * std::pow(high / low, static_cast<double>(state >> 11) / 9007199254740992.0);
    }
};

motor_params drawn_motor(std::uint64_t number)
{
    Draw draw{number * 977 + 11};
    for (int i = 0; i < 5; i++) {
        draw(1, 2);
    }
    motor_params m{};
    m.rated_current_A = draw(0.4, 6);
    m.resistance_ohm = draw(2, 6) / m.rated_current_A;
    m.inductance_H = m.resistance_ohm * draw(0.5e-3, 6e-3);
    /* N L I / Km, how much more flux the current makes than the magnet: 0.6 to 3.1 */
    m.rotor_teeth = draw(1, 2) > 1.8 ? 100 : 50;
    m.torque_constant_Nm_A = m.rotor_teeth * m.inductance_H * m.rated_current_A / draw(0.6, 3.1);
    const double torque = std::sqrt(2.0) * m.torque_constant_Nm_A * m.rated_current_A;
    m.inertia_kgm2 = torque * draw(0.8e-5, 3e-4);
    m.viscous_friction_Nms_rad = draw(1e-7, 1e-4) * torque / 0.3;
    m.supply_V = std::max(12.0, 4 * m.resistance_ohm * m.rated_current_A);
    return m;
}

using Kind = invariant_ekf_gains invariant_ekf_hold_gains::*;

constexpr Kind settled_hold = &invariant_ekf_hold_gains::quiet;
constexpr Kind load_step_hold = &invariant_ekf_hold_gains::following;

/* The hold of the defaults; false: refused. */
bool default_hold(const motor_params &motor, double current_A, Hold &hold, Kind kind)
{
    char error[DESIGN_ERROR_TEXT] = "";
    drive_settings settings{};
    drive_settings_default(&settings, &motor);
    settings.hold_current_A = current_A;
    default_settings_apply(&settings, period_s, 0);
    hold.motor = motor;
    hold.current_A = settings.hold_current_A;
    hold.current_bandwidth_rad_s = settings.current_bandwidth_rad_s;
    const hold_task task = {&hold.motor, period_s, hold.current_A, settings.hold_bandwidth_rad_s,
                            hold.current_bandwidth_rad_s};
    invariant_ekf_hold_gains gains{};
    if (!hold_damping_design(&task, &hold.damping_As_rad, error) ||
        !invariant_ekf_hold_design(&motor, period_s, hold.current_A, &gains, error)) {
        return false;
    }
    hold.gains = gains.*kind;
    hold.feigned_share = gains.feigned_share;
    return true;
}

double damping_of_the_check(const Hold &hold)
{
    const hold_task task = {&hold.motor, period_s, hold.current_A, NAN,
                            hold.current_bandwidth_rad_s};
    return std::min(hold_control_damping(&task, hold.damping_As_rad),
                    hold_estimator_damping(&task, &hold.gains));
}

/* Least and most of a share over a hundred drawn motors, in their default hold, settled. */
template <typename Share> std::pair<double, double> range_over_motors(const Share &share)
{
    double least = 1;
    double most = 0;
    for (std::uint64_t number = 0; number < 100; number++) {
        Hold hold{};
        if (!default_hold(drawn_motor(number), NAN, hold, settled_hold)) {
            continue;
        }
        const double one = share(hold, "motor " + std::to_string(number));
        least = std::min(least, one);
        most = std::max(most, one);
    }
    TEST_MESSAGE((std::to_string(least) + " to " + std::to_string(most)).c_str());
    return {least, most};
}

double tenth_of_its_torque_Nm(const Hold &hold)
{
    return 0.1 * hold.motor.torque_constant_Nm_A * hold.current_A;
}

int periods_of(const Hold &hold, double swings)
{
    return static_cast<int>(
        std::ceil(swings / (hold_frequency(&hold.motor, hold.current_A) * period_s)));
}

} // namespace

extern "C" {
void setUp(void)
{
}

void tearDown(void)
{
}
}

/* Separation: two small loops have the damping of the whole. */
static void the_check_says_what_the_whole_loop_does(void)
{
    int swinging = 0;
    for (std::uint64_t number = 0; number < 200; number++) {
        const motor_params motor = drawn_motor(number);
        for (const double share : {0.5, 1.0}) {
            for (const Kind kind : {settled_hold, load_step_hold}) {
                Hold hold{};
                if (!default_hold(motor, share * motor.rated_current_A, hold, kind)) {
                    continue;
                }
                const std::string name = "motor " + std::to_string(number);
                const double whole = damping_in_one_piece(hold);
                TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.02, whole, damping_of_the_check(hold),
                                                  name.c_str());
                swinging += whole < 0.9 ? 1 : 0;
            }
        }
    }
    TEST_ASSERT_TRUE(swinging > 400);
}

/* At the hold current of the defaults. */
static void the_default_hold_of_every_motor_is_damped(void)
{
    int damped = 0;
    int well_damped = 0;
    constexpr int motors = 200;
    for (std::uint64_t number = 0; number < motors; number++) {
        Hold settled{};
        Hold load_step{};
        const motor_params motor = drawn_motor(number);
        if (default_hold(motor, NAN, settled, settled_hold) &&
            default_hold(motor, NAN, load_step, load_step_hold)) {
            const double least =
                std::min(damping_in_one_piece(settled), damping_in_one_piece(load_step));
            damped += least >= HOLD_DAMPING_MIN ? 1 : 0;
            well_damped += least >= 0.2 ? 1 : 0;
        }
    }
    const std::string said = std::to_string(damped) + " of 200 damped by 0.1, " +
                             std::to_string(well_damped) + " by 0.2";
    TEST_MESSAGE(said.c_str());
    TEST_ASSERT_TRUE_MESSAGE(damped == motors, said.c_str());
}

/* A data sheet states the inductance to a fifth, and saturation takes a tenth of it. */
static void a_hold_is_stable_with_a_tenth_less_inductance_and_with_a_tenth_more(void)
{
    int holds = 0, unstable_less = 0, unstable_more = 0;
    for (std::uint64_t number = 0; number < 200; number++) {
        const motor_params motor = drawn_motor(number);
        for (const double share : {0.5, 1.0}) {
            for (const Kind kind : {settled_hold, load_step_hold}) {
                Hold hold{};
                if (default_hold(motor, share * motor.rated_current_A, hold, kind)) {
                    holds++;
                    unstable_less += damping_in_one_piece(hold, 0.9) < 0 ? 1 : 0;
                    unstable_more += damping_in_one_piece(hold, 1.1) < 0 ? 1 : 0;
                }
            }
        }
    }
    const std::string said = std::to_string(unstable_less) + " and " +
                             std::to_string(unstable_more) + " of " + std::to_string(holds);
    TEST_MESSAGE(said.c_str());
    TEST_ASSERT_TRUE(holds > 700);
    TEST_ASSERT_EQUAL_MESSAGE(0, unstable_less, said.c_str());
    TEST_ASSERT_EQUAL_MESSAGE(0, unstable_more, said.c_str());
}

/* The drive notices a step by what its estimate shows of it: two thirds of the bare load, and less.
 */
static void what_a_settled_hold_shows_of_a_load_step_is_what_the_whole_loop_does(void)
{
    const auto [least, most] = range_over_motors([](const Hold &hold, const std::string &motor) {
        const double load_Nm = tenth_of_its_torque_Nm(hold);
        VectorXd x = VectorXd::Zero(STATES + 1);
        double shown = 0;
        for (int k = 0; k < periods_of(hold, 8); k++) {
            x = period(hold, x, load_Nm);
            shown = std::max(shown, x(LOAD_EST) / load_Nm);
        }
        const hold_task task = {&hold.motor, period_s, hold.current_A, NAN,
                                hold.current_bandwidth_rad_s};
        const double computed = hold_step_shown(&task, &hold.gains);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.01, shown, computed, motor.c_str());
        return computed;
    });
    TEST_ASSERT_TRUE(least > 0.3 && most < 1);
}

/* The hold's resistance is 2 % off as a load comes, and its q current. */
static void what_an_error_of_the_resistance_feigns_is_within_the_share_stated(void)
{
    const auto [least, most] = range_over_motors([](const Hold &hold, const std::string &) {
        const double load_Nm = tenth_of_its_torque_Nm(hold);
        VectorXd x = VectorXd::Zero(STATES + 1);
        x(OFFSET_EST) =
            0.02 * hold.motor.resistance_ohm * load_Nm / hold.motor.torque_constant_Nm_A;
        double feigned_Nm = 0;
        for (int k = 0; k < periods_of(hold, 30); k++) {
            x = period(hold, x);
            feigned_Nm = std::max(feigned_Nm, std::fabs(x(LOAD_EST)));
        }
        return feigned_Nm / load_Nm / hold.feigned_share;
    });
    TEST_ASSERT_TRUE(least > 0.5 && most < 1);
}

/* Undamped, as it is at first: what damps is slower than the swing. */
static void a_load_step_of_the_share_stated_is_borne_and_one_beyond_is_not(void)
{
    for (const double factor : {0.995, 1.005}) {
        const double load = factor * HOLD_LOAD_STEP_SHARE; /* of the hold's largest torque */
        double angle = 0, speed = 0, farthest = 0;
        for (int i = 0; i < 400000; i++) { /* semi-implicit Euler, in the time of w_h */
            speed += 1e-4 * (load - std::sin(angle));
            angle += 1e-4 * speed;
            farthest = std::max(farthest, angle);
        }
        TEST_ASSERT_EQUAL(factor < 1, farthest < 3.14159);
    }
}

/* The load at which the check ends is the one whose w_h makes 20 degrees of the drop's error. */
static void a_load_too_heavy_for_what_the_drop_leaves_of_the_back_emf_is_refused(void)
{
    const motor_params bare = reference::bendjedia_2012();
    const double feigned = 0.025 * bare.resistance_ohm * bare.rated_current_A /
                           bare.torque_constant_Nm_A * bare.rotor_teeth; /* electrical rad/s */
    const double least = feigned / (20.0 * std::acos(-1.0) / 180.0);     /* of w_h */
    const double current_A = 0.5 * bare.rated_current_A;
    const double most =
        bare.rotor_teeth * bare.torque_constant_Nm_A * current_A / (least * least); /* of J */
    for (const double factor : {0.99, 1.01}) {
        motor_params motor = bare;
        motor.inertia_kgm2 = factor * most;
        const hold_task task = {&motor, period_s, current_A, NAN, 1500.0};
        invariant_ekf_hold_gains gains = {};
        char error[DESIGN_ERROR_TEXT] = "";
        TEST_ASSERT_TRUE_MESSAGE(
            invariant_ekf_hold_design(&motor, period_s, current_A, &gains, error), error);
        TEST_ASSERT_EQUAL_MESSAGE(factor < 1, hold_estimator_check(&task, &gains, error), error);
        TEST_ASSERT_EQUAL(factor > 1,
                          std::string(error).rfind("winding_drop_angle_error 20.", 0) == 0);
        TEST_ASSERT_EQUAL(factor > 1,
                          std::strstr(error, "too little back-EMF for its inertia") != nullptr);
    }
}

static void the_modes_of_a_known_system_are_found(void)
{
    matrix a = {};
    const double w = 1000, damping = 0.3; /* a pair, and two real modes */
    const std::complex<double> z =
        std::exp(period_s * w * std::complex<double>(-damping, std::sqrt(1 - damping * damping)));
    a.at[0][0] = z.real();
    a.at[0][1] = -z.imag();
    a.at[1][0] = z.imag();
    a.at[1][1] = z.real();
    a.at[2][2] = 0.9;
    a.at[3][3] = 0.3;
    a.at[0][3] = 5.0; /* coupling that moves no mode */
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, damping, modes_damping(4, &a, period_s, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0, modes_damping(4, &a, period_s, 2000.0 * 6));
    a.at[2][2] = 1.001; /* unstable */
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -1.0, modes_damping(4, &a, period_s, 0.0));
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(the_modes_of_a_known_system_are_found);
    RUN_TEST(the_check_says_what_the_whole_loop_does);
    RUN_TEST(the_default_hold_of_every_motor_is_damped);
    RUN_TEST(a_load_too_heavy_for_what_the_drop_leaves_of_the_back_emf_is_refused);
    RUN_TEST(a_hold_is_stable_with_a_tenth_less_inductance_and_with_a_tenth_more);
    RUN_TEST(what_a_settled_hold_shows_of_a_load_step_is_what_the_whole_loop_does);
    RUN_TEST(what_an_error_of_the_resistance_feigns_is_within_the_share_stated);
    RUN_TEST(a_load_step_of_the_share_stated_is_borne_and_one_beyond_is_not);
    return UNITY_END();
}
