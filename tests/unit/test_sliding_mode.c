/* The laws of Seshagiri and Khalil: CSMC, around the equivalent control, with servocompensator, and
 * the ideal sliding mode. */
#include "firmware/control/csmc.h"
#include "firmware/control/csmc_equivalent.h"
#include "firmware/control/csmc_servo.h"
#include "firmware/control/position_law_dispatch.h"
#include "firmware/control/smc.h"
#include "firmware/numeric/angle.h"
#include "tests/unit/num_assert.h"

#include <math.h>
#include <string.h>

#define T 1e-4
#define N 50.0

/* Section III, the nominal motor. */
static const struct motor_params motor = {
    .resistance_ohm = 20.0,
    .inductance_H = 35e-3,
    .torque_constant_Nm_A = 0.1349,
    .viscous_friction_Nms_rad = 0.0013,
    .inertia_kgm2 = 4.1295e-4,
    .rated_current_A = 2.0,
    .supply_V = 50.0,
    .rotor_teeth = 50,
};

#define K1    7.5e4
#define K2    550.0
#define MU_D  0.1
#define MU_Q  50.0
#define K0_D  20.0
#define K0_Q  100.0
#define M     50.0
#define K3    (0.1349 / 4.1295e-4)
#define K4    (0.0013 / 4.1295e-4)
#define R_TOL 1.0
#define L_TOL 5e-3
#define Q_D   (2.1 * K0_D * MU_D * 40e-3)
#define Q_Q   (2.1 * K0_Q * MU_Q * 40e-3 / K3)

/* Of 50 V: gains of 16 bits, terms up to ten times the result, 1/mu of 26. */
#define ROUNDING_V (50.0 * (32.0 * COEF_ROUNDING + 4096.0 * NUM_ROUNDING))

static const double not_given = __builtin_nan("");

static struct per_unit base;
static double gains[LAW_GAINS_MAX];
static struct position_law_task task;
static enum position_law law;
static union position_law_params params;
static union position_law_state state;
static char error[DESIGN_ERROR_TEXT];

/* What a law is asked in one period, SI; e = theta - theta*. */
static struct {
    double e_rad, speed_rad_s, reference_speed_rad_s, reference_acceleration_rad_s2;
    double load_torque_Nm, i_d_A, i_q_A, voltage_limit_V;
} asked;

static void give(const char *name, double value)
{
    const struct law_gain_list list = position_law_gains(law);

    for (size_t i = 0; i < list.count; i++) {
        if (strcmp(list.gain[i].name, name) == 0) {
            gains[i] = value;
            return;
        }
    }
    TEST_FAIL_MESSAGE(name);
}

void setUp(void)
{
    base = per_unit_base(&motor, T);
    for (int i = 0; i < LAW_GAINS_MAX; i++) {
        gains[i] = not_given;
    }
    task = (struct position_law_task){
        .motor = &motor,
        .base = &base,
        .period_s = T,
        .delay_periods = 1,
        .bandwidth_rad_s = 270.0,
        .current_bandwidth_rad_s = 2000.0,
        .speed_limit_rad_s = 100.0,
        .current_limit_A = 4.0,
        .gains = gains,
    };
    memset(&asked, 0, sizeof asked);
    asked.voltage_limit_V = 90.0;
}

void tearDown(void)
{
}

static void design(void)
{
    TEST_ASSERT_TRUE_MESSAGE(position_law_design(law, &params, &task, error), error);
    position_law_reset(&state);
}

static void design_as_published(enum position_law which)
{
    law = which;
    give("k1", K1);
    give("k2", K2);
    if (law != POSITION_LAW_SMC) {
        give("mu_d", MU_D);
        give("mu_q", MU_Q);
    }
    if (law == POSITION_LAW_CSMC || law == POSITION_LAW_CSMC_EQUIVALENT) {
        give("k0_d", K0_D);
        give("k0_q", K0_Q);
    }
    if (law == POSITION_LAW_CSMC_EQUIVALENT) {
        give("resistance_tolerance_ohm", R_TOL);
        give("inductance_tolerance_H", L_TOL);
        give("q_d_V", Q_D);
        give("q_q_V", Q_Q);
    } else {
        give("M_V", M);
    }
    if (law == POSITION_LAW_CSMC_SERVO) {
        give("servo_frequency_rad_s", 5.0);
        give("servo_decay_1_s", 1.0);
    }
    design();
}

struct volts {
    double d, q;
};

static struct volts step(void)
{
    const struct voltage_law_input input = {
        .motion = {.position_error = num_from_double(-asked.e_rad / base.rad_per_turn),
                   .reference_speed =
                       num_from_double(asked.reference_speed_rad_s / base.speed_rad_s),
                   .reference_acceleration = num_from_double(asked.reference_acceleration_rad_s2 /
                                                             base.acceleration_rad_s2),
                   .speed = num_from_double(asked.speed_rad_s / base.speed_rad_s),
                   .load_torque = num_from_double(asked.load_torque_Nm / base.torque_Nm)},
        .current = {num_from_double(asked.i_d_A / base.current_A),
                    num_from_double(asked.i_q_A / base.current_A)},
        .resistance = num_from_double(motor.resistance_ohm / base.resistance_ohm),
        .voltage_limit = num_from_double(asked.voltage_limit_V / base.voltage_V),
    };
    const struct voltage_demand demand = position_law_voltage(law, &state, &params, &input);

    return (struct volts){num_to_double(demand.voltage.d) * base.voltage_V,
                          num_to_double(demand.voltage.q) * base.voltage_V};
}

static double sat(double x)
{
    return fmin(fmax(x, -1.0), 1.0);
}

static double acceleration(void)
{
    return K3 * asked.i_q_A - K4 * asked.speed_rad_s - asked.load_torque_Nm / motor.inertia_kgm2;
}

static double surface(void)
{
    return K1 * asked.e_rad + K2 * (asked.speed_rad_s - asked.reference_speed_rad_s) +
           acceleration() - asked.reference_acceleration_rad_s2;
}

/* Inside both layers, none of the terms zero. */
static void ask_inside_the_layers(void)
{
    asked.e_rad = 5e-4;
    asked.speed_rad_s = 0.55;
    asked.reference_speed_rad_s = 0.5;
    asked.reference_acceleration_rad_s2 = 30.0;
    asked.load_torque_Nm = 0.2;
    asked.i_d_A = -0.03;
    asked.i_q_A = 1.45;
}

static void test_csmc_is_equations_3_and_7(void)
{
    design_as_published(POSITION_LAW_CSMC);
    ask_inside_the_layers();
    TEST_ASSERT_TRUE(fabs(surface()) < 0.9 * MU_Q && fabs(surface()) > 0.1 * MU_Q);
    const struct volts v = step();
    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, -M * asked.i_d_A / MU_D, v.d);
    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, -M * surface() / MU_Q, v.q);
}

static void test_outside_the_layer_the_voltage_is_m(void)
{
    design_as_published(POSITION_LAW_CSMC);
    asked.e_rad = -0.03;
    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, M, step().q);
    asked.e_rad = 1.5;
    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, -M, step().q);
}

/* However large the error: at the limit the surface is reached. */
static void test_the_current_is_limited(void)
{
    design_as_published(POSITION_LAW_CSMC);
    asked.e_rad = -0.5;
    asked.i_q_A = 3.9;
    TEST_ASSERT_DOUBLE_WITHIN(1.0, M * K3 * 0.1 / MU_Q, step().q);
    asked.i_q_A = 4.1;
    TEST_ASSERT_TRUE(step().q < 0.0);
}

/* (4): inside the layer d sigma/dt = s*. */
static void test_the_integrator_gathers_inside_the_layer(void)
{
    design_as_published(POSITION_LAW_CSMC);
    asked.e_rad = 1e-4;
    double v_V = 0.0;
    for (int k = 0; k < 51; k++) {
        v_V = step().q;
    }
    const double s = K1 * 1e-4;
    TEST_ASSERT_DOUBLE_WITHIN(2.0 * ROUNDING_V, -M * s * (1.0 + 50.0 * K0_Q * T) / MU_Q, v_V);
}

/* k0 sigma stays within mu however long the error lasts: 3/k0 later nothing is left to unwind. */
static void test_the_integrator_does_not_wind_up(void)
{
    design_as_published(POSITION_LAW_CSMC);
    asked.e_rad = 0.03;
    for (int k = 0; k < 20000; k++) {
        step();
    }
    TEST_ASSERT_TRUE(num_to_double(state.csmc.q.share) <= CONDITIONAL_INTEGRATOR_SCALE);
    asked.e_rad = -2.1 * MU_Q / K1;
    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, M, step().q);
}

/* F^ cancels the nominal motor: on the surface the law gives what holds it there. */
static void test_the_equivalent_control_is_equation_5(void)
{
    const double L = motor.inductance_H, R = motor.resistance_ohm;

    design_as_published(POSITION_LAW_CSMC_EQUIVALENT);
    ask_inside_the_layers();
    asked.speed_rad_s = 8.05;
    asked.reference_speed_rad_s = 8.0;
    asked.reference_acceleration_rad_s2 = 30.0 - 8.05 * K4;
    const double e1 = asked.speed_rad_s - asked.reference_speed_rad_s;
    const double e2 = acceleration() - asked.reference_acceleration_rad_s2;
    const double w = asked.speed_rad_s, i_d = asked.i_d_A, i_q = asked.i_q_A;
    const double beta1 = R_TOL * fabs(i_d) + L_TOL * N * fabs(i_q * w) + Q_D;
    const double beta2 =
        R_TOL * fabs(i_q) +
        L_TOL / K3 * fabs(K1 * e1 + K2 * e2 - K4 * acceleration() - K3 * N * i_d * w) + Q_Q;
    const double d = R * i_d - N * w * L * i_q - beta1 * sat(i_d / MU_D);
    const double q = R * i_q + N * w * L * i_d + motor.torque_constant_Nm_A * w -
                     L / K3 * (K1 * e1 + K2 * e2 - K4 * acceleration()) -
                     beta2 * sat(surface() / MU_Q);
    const struct volts v = step();
    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, d, v.d);
    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, q, v.q);
}

static void test_the_ideal_sliding_mode_knows_only_signs(void)
{
    design_as_published(POSITION_LAW_SMC);
    asked.e_rad = 1e-5;
    asked.i_d_A = -1e-3;
    const struct volts v = step();
    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, M, v.d);
    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, -M, v.q);
}

static void test_the_d_axis_is_served_first(void)
{
    design_as_published(POSITION_LAW_SMC);
    asked.e_rad = 1e-3;
    asked.i_d_A = -0.1;
    asked.voltage_limit_V = 60.0;
    const struct volts v = step();
    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, 50.0, v.d);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, -sqrt(60.0 * 60.0 - 50.0 * 50.0), v.q);
}

/*
 * What a servocompensator for 5 rad/s leaves of a disturbance with a constant part after 18 s, as a
 * share of what there is without. The plant: s* = mu (disturbance - level)/2, at once.
 */
static double left_over(double frequency_rad_s)
{
    const double full_rad = 0.5 * MU_Q / K1;
    double level = 0.0;
    double most_rad = 0.0;

    design_as_published(POSITION_LAW_CSMC_SERVO);
    give("servo_decay_1_s", 2.0);
    design();
    for (int k = 0; k < 200000; k++) {
        const double time_s = k * T;
        const double disturbance = 0.3 + 0.2 * sin(frequency_rad_s * time_s);

        asked.e_rad = full_rad * (disturbance - level);
        level = -step().q / M;
        if (time_s > 18.0) {
            most_rad = fmax(most_rad, fabs(asked.e_rad));
        }
    }
    return most_rad / (0.2 * full_rad);
}

static void test_the_servocompensator_knows_a_constant_and_its_frequency(void)
{
    TEST_ASSERT_TRUE(left_over(5.0) < 0.002);
    TEST_ASSERT_TRUE(left_over(7.0) > 0.4);
}

static void test_the_servocompensator_asks_for_its_frequency(void)
{
    law = POSITION_LAW_CSMC_SERVO;
    TEST_ASSERT_FALSE(position_law_design(law, &params, &task, error));
    TEST_ASSERT_NOT_NULL(strstr(error, "servo_frequency_rad_s: must be given"));
    give("servo_frequency_rad_s", 700.0);
    TEST_ASSERT_FALSE(position_law_design(law, &params, &task, error));
    TEST_ASSERT_EQUAL_STRING(
        "servo_frequency_rad_s 700 rad/s: must be at most 625 rad/s, fifty samples a cycle", error);
}

static void test_bandwidths_beyond_the_sampled_loop_are_refused(void)
{
    law = POSITION_LAW_CSMC;
    task.current_bandwidth_rad_s = 3000.0;
    TEST_ASSERT_FALSE(position_law_design(law, &params, &task, error));
    TEST_ASSERT_EQUAL_STRING("current_bandwidth_rad_s 3000 rad/s: must be at most 2500 rad/s, "
                             "g = M T / (mu L) <= 0.25 with delay",
                             error);
    task.delay_periods = 0;
    TEST_ASSERT_TRUE(position_law_design(law, &params, &task, error));
    task.bandwidth_rad_s = 800.0;
    TEST_ASSERT_FALSE(position_law_design(law, &params, &task, error));
    TEST_ASSERT_EQUAL_STRING("law_bandwidth_rad_s 800 rad/s: must be at most 750 rad/s, "
                             "a quarter of the current's",
                             error);
}

/* The published layers, whose g is 1.1, can be given all the same. */
static void test_given_gains_are_the_users_own(void)
{
    task.current_bandwidth_rad_s = 1e5;
    design_as_published(POSITION_LAW_CSMC);
}

/* g = M k3 T/(mu L) is the current bandwidth times the period. */
static void test_the_layers_follow_from_the_current_bandwidth(void)
{
    law = POSITION_LAW_CSMC;
    design();
    asked.i_d_A = 1e-3;
    const double volts_per_A = -step().d / asked.i_d_A;
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * 70.0, 2000.0 * motor.inductance_H, volts_per_A);
    position_law_reset(&state);
    asked.i_d_A = 0.0;
    asked.i_q_A = 1e-3;
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * 70.0, 2000.0 * motor.inductance_H, -step().q / asked.i_q_A);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_csmc_is_equations_3_and_7);
    RUN_TEST(test_outside_the_layer_the_voltage_is_m);
    RUN_TEST(test_the_current_is_limited);
    RUN_TEST(test_the_integrator_gathers_inside_the_layer);
    RUN_TEST(test_the_integrator_does_not_wind_up);
    RUN_TEST(test_the_equivalent_control_is_equation_5);
    RUN_TEST(test_the_ideal_sliding_mode_knows_only_signs);
    RUN_TEST(test_the_d_axis_is_served_first);
    RUN_TEST(test_the_servocompensator_knows_a_constant_and_its_frequency);
    RUN_TEST(test_the_servocompensator_asks_for_its_frequency);
    RUN_TEST(test_bandwidths_beyond_the_sampled_loop_are_refused);
    RUN_TEST(test_given_gains_are_the_users_own);
    RUN_TEST(test_the_layers_follow_from_the_current_bandwidth);
    return UNITY_END();
}
