/* The gains a drive computes at start-up. Nothing here depends on the number format. */
#include <string.h>
#include <unity.h>

#include "firmware/design/elementary.h"
#include "firmware/design/invariant_ekf_design.h"
#include "firmware/design/loop_bandwidth.h"
#include "firmware/design/mechanical_model.h"
#include "firmware/design/pid_design.h"
#include "firmware/design/riccati.h"
#include "firmware/design/small_matrix.h"
#include "firmware/design/state_feedback_design.h"
#include "firmware/design/steady_state_ekf_design.h"

static const double period_s = 1e-4;
static const double bandwidth_rad_s = 200.0;
static const double current_bandwidth_rad_s = 1500.0;

static struct motor_params motor; /* bendjedia-2012, fresh for each test */
static char error[DESIGN_ERROR_TEXT];
static double not_a_number, infinite;

void setUp(void)
{
    volatile double zero = 0.0;

    not_a_number = zero / zero;
    infinite = 1.0 / zero;
    motor = (struct motor_params){.resistance_ohm = 0.37,
                                  .inductance_H = 0.9e-3,
                                  .torque_constant_Nm_A = 0.157,
                                  .viscous_friction_Nms_rad = 0.000307,
                                  .inertia_kgm2 = 15.62e-5,
                                  .rated_current_A = 3.0,
                                  .supply_V = 24.0,
                                  .rotor_teeth = 50};
    memset(error, 0, sizeof error);
}

void tearDown(void)
{
}

static void assert_relative(double relative, double expected, double actual, const char *name)
{
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(relative * magnitude(expected), expected, actual, name);
}

/* ---- elementary functions: correctly rounded values from 40-digit arithmetic ---- */

static void exponential_is_exact_to_two_ulp(void)
{
    static const struct {
        double x, value;
    } points[] = {
        {0.0, 1.0},
        {1.0, 2.7182818284590452354},
        {-0.02, 0.98019867330675530222},
        {0.34657359027997264, 1.4142135623730950130},
        {-1.0, 0.36787944117144232160},
        {100.0, 2.6881171418161354484e43},
        {-100.0, 3.7200759760208359630e-44},
        {700.0, 1.0142320547350045095e304},
        {-700.0, 9.8596765437597708567e-305},
    };

    for (unsigned i = 0; i < sizeof points / sizeof points[0]; i++) {
        assert_relative(4.5e-16, points[i].value, exponential(points[i].x), "e^x");
    }
}

static void exponential_clamps_its_argument(void)
{
    TEST_ASSERT_TRUE(exponential(1e9) == exponential(700.0));
    TEST_ASSERT_TRUE(exponential(-1e9) == exponential(-700.0));
}

static void lag_integrals_do_not_cancel_for_small_arguments(void)
{
    TEST_ASSERT_TRUE(exponential_phi1(0.0) == 1.0);
    TEST_ASSERT_TRUE(exponential_phi2(0.0) == 0.5);
    assert_relative(5e-16, 0.99990167644554236846, exponential_phi1(-1.9666e-4), "phi1");
    assert_relative(5e-16, 0.49996722494473476994, exponential_phi2(-1.9666e-4), "phi2");
    assert_relative(5e-16, 0.63212055882855768, exponential_phi1(-1.0), "phi1(-1)");
    assert_relative(2e-15, 0.36787944117144232, exponential_phi2(-1.0), "phi2(-1)");
}

static void lag_integrals_join_where_their_formulas_change(void)
{
    assert_relative(1e-15, exponential_phi1(-0.4999999999999999), exponential_phi1(-0.5), "phi1");
    assert_relative(1e-15, exponential_phi1(0.4999999999999999), exponential_phi1(0.5), "phi1");
    assert_relative(4e-15, exponential_phi2(-0.9999999999999999), exponential_phi2(-1.0), "phi2");
    assert_relative(4e-15, exponential_phi2(0.9999999999999999), exponential_phi2(1.0), "phi2");
}

/* ---- matrices ---- */

static void matrix_exponential_of_a_rotation_is_sine_and_cosine(void)
{
    struct matrix a = {{{0.0, -0.5}, {0.5, 0.0}}};
    struct matrix result;

    matrix_exponential(2, &a, &result);
    TEST_ASSERT_DOUBLE_WITHIN(1e-13, 0.87758256189037271612, result.at[0][0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-13, 0.47942553860420300027, result.at[1][0]);
}

static void matrix_inverse_times_matrix_is_identity(void)
{
    const struct matrix a = {{{4.0, 1.0, -2.0}, {1.0, 3.0, 0.5}, {-2.0, 0.5, 5.0}}};
    struct matrix_factors factors;
    struct matrix lower, inverse, product;

    TEST_ASSERT_TRUE(matrix_invert(3, &a, &factors, &lower, &inverse));
    matrix_multiply(3, &a, &inverse, &product);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-15, i == j ? 1.0 : 0.0, product.at[i][j]);
        }
    }
}

static void indefinite_matrix_has_no_factors(void)
{
    const struct matrix a = {{{1.0, 2.0}, {2.0, 1.0}}};
    struct matrix_factors factors;
    struct matrix lower, inverse;

    TEST_ASSERT_FALSE(matrix_invert(2, &a, &factors, &lower, &inverse));
}

/* ---- Riccati: P = P / (1 + P) + 1 is solved by the golden ratio ---- */

static struct riccati_problem two_random_walks(void)
{
    return (struct riccati_problem){.states = 2,
                                    .doublings = 7,
                                    .transition = {{{1.0, 0.0}, {0.0, 1.0}}},
                                    .process_noise = {1.0, 4.0},
                                    .measurement_noise = 1.0};
}

static void random_walk_is_filtered_with_the_golden_ratio(void)
{
    struct riccati_problem problem = two_random_walks();
    struct riccati_solution solution;

    TEST_ASSERT_TRUE(riccati_solve(&problem, &solution));
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 1.6180339887498949, solution.covariance.at[0][0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 0.6180339887498949, solution.gain[0][0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 4.8284271247461903, solution.covariance.at[1][1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 0.0, solution.gain[0][1]);
}

static void riccati_refuses_what_is_not_a_number(void)
{
    struct riccati_problem problem = two_random_walks();
    struct riccati_solution solution;

    problem.transition.at[1][0] = not_a_number;
    TEST_ASSERT_FALSE(riccati_solve(&problem, &solution));
}

/* ---- position laws ---- */

static void state_feedback_gains_are_the_exact_ones(void)
{
    struct state_feedback_gains gains;

    TEST_ASSERT_TRUE(state_feedback_design(&motor, period_s, bandwidth_rad_s,
                                           current_bandwidth_rad_s, &gains, error));
    assert_relative(1e-8, 0.39014114, gains.k_speed_As_rad, "K_w");
    assert_relative(1e-8, 39.0132951, gains.k_angle_A_rad, "K_theta");
    assert_relative(1e-8, 6.36942675, gains.k_load_A_Nm, "K_L");
    TEST_ASSERT_TRUE(gains.k_angle_reference_A_rad == gains.k_angle_A_rad);
}

static void state_feedback_is_near_the_printed_gains_with_the_torque_constant_they_imply(void)
{
    struct state_feedback_gains gains;

    motor.torque_constant_Nm_A = 0.153; /* 1 / 6.536 */
    TEST_ASSERT_TRUE(state_feedback_design(&motor, period_s, bandwidth_rad_s,
                                           current_bandwidth_rad_s, &gains, error));
    assert_relative(0.02, 0.405, gains.k_speed_As_rad, "K_w");
    assert_relative(0.02, 40.746, gains.k_angle_A_rad, "K_theta");
    TEST_ASSERT_DOUBLE_WITHIN(0.0005, 6.536, gains.k_load_A_Nm);
}

/* Position, speed and integral of the error, sampled: all three eigenvalues are e^(-w0 T). */
static void the_poles_of_the_pid_are_three_at_its_bandwidth(void)
{
    const struct mechanical_model model = mechanical_model_of(&motor, period_s);
    const double z = exponential(-bandwidth_rad_s * period_s);
    struct pid_gains pid;

    TEST_ASSERT_TRUE(
        pid_design(&motor, period_s, bandwidth_rad_s, current_bandwidth_rad_s, &pid, error));
    /* w+ = a11 w + b1 i, x+ = x + a21 w + b2 i, s+ = s + x, i = -kw w - kp x - ki s */
    const double kw = pid.k_speed_As_rad;
    const double kp = pid.k_proportional_A_rad;
    const double ki = pid.k_integral_step_A_rad;
    const double w[3] = {-model.one_minus_a11 - model.b1 * kw, -model.b1 * kp, -model.b1 * ki};
    const double x[3] = {model.a21 - model.b2 * kw, -model.b2 * kp, -model.b2 * ki};

    for (double d = -0.05; d < 0.1; d += 0.03) { /* det(d I - loop + I) at z = 1 + d */
        const double determinant =
            (d - w[0]) * ((d - x[1]) * d - x[2]) + w[1] * (-x[0] * d) + w[2] * -x[0];

        assert_relative(1e-9, (1.0 + d - z) * (1.0 + d - z) * (1.0 + d - z), determinant, "poles");
    }
}

static void feed_forward_carries_the_reference_motion(void)
{
    struct state_feedback_gains gains;
    struct pid_gains pid;

    TEST_ASSERT_TRUE(state_feedback_design(&motor, period_s, bandwidth_rad_s,
                                           current_bandwidth_rad_s, &gains, error));
    TEST_ASSERT_TRUE(
        pid_design(&motor, period_s, bandwidth_rad_s, current_bandwidth_rad_s, &pid, error));
    assert_relative(1e-12, 15.62e-5 / 0.157, gains.k_acceleration_reference_As2_rad, "alpha*");
    assert_relative(1e-12, gains.k_speed_As_rad + 0.000307 / 0.157, gains.k_speed_reference_As_rad,
                    "w*");
    assert_relative(1e-12, 15.62e-5 / 0.157, pid.k_acceleration_reference_As2_rad, "alpha*");
    assert_relative(1e-12, pid.k_speed_As_rad + 0.000307 / 0.157, pid.k_speed_reference_As_rad,
                    "w*");
}

static void designs_bear_a_motor_without_friction(void)
{
    struct state_feedback_gains with_little, without;

    motor.viscous_friction_Nms_rad = 1e-9;
    TEST_ASSERT_TRUE(state_feedback_design(&motor, period_s, bandwidth_rad_s,
                                           current_bandwidth_rad_s, &with_little, error));
    motor.viscous_friction_Nms_rad = 0.0;
    TEST_ASSERT_TRUE(state_feedback_design(&motor, period_s, bandwidth_rad_s,
                                           current_bandwidth_rad_s, &without, error));
    assert_relative(1e-7, with_little.k_speed_As_rad, without.k_speed_As_rad, "K_w");
    assert_relative(1e-7, with_little.k_angle_A_rad, without.k_angle_A_rad, "K_theta");

    struct mechanical_model model = mechanical_model_of(&motor, period_s);
    TEST_ASSERT_TRUE(model.one_minus_a11 == 0.0);
    TEST_ASSERT_TRUE(model.a21 == period_s);
}

/* ---- what is refused, and in which words ---- */

static void too_fast_a_position_loop_is_refused_with_its_limit(void)
{
    struct state_feedback_gains gains;
    struct pid_gains pid;

    TEST_ASSERT_TRUE(state_feedback_design(&motor, period_s, 375.0, 1500.0, &gains, error));
    TEST_ASSERT_FALSE(state_feedback_design(&motor, period_s, 376.0, 1500.0, &gains, error));
    TEST_ASSERT_EQUAL_STRING("position bandwidth 376 rad/s: must be at most 375 rad/s, "
                             "a quarter of the current's",
                             error);
    TEST_ASSERT_FALSE(pid_design(&motor, period_s, 376.0, 1500.0, &pid, error));
}

static void too_fast_a_current_loop_is_refused_with_its_limit(void)
{
    struct pid_gains gains;

    TEST_ASSERT_TRUE(pid_design(&motor, period_s, 200.0, 3000.0, &gains, error));
    TEST_ASSERT_FALSE(pid_design(&motor, period_s, 200.0, 3001.0, &gains, error));
    TEST_ASSERT_EQUAL_STRING("current bandwidth 3001 rad/s: must be at most 3000 rad/s, "
                             "0.3 per control period",
                             error);
}

static void impossible_motors_are_refused_by_name(void)
{
    static const char *const names[] = {"resistance",    "inductance", "torque constant", "inertia",
                                        "rated current", "supply",     "viscous friction"};
    double *const fields[] = {&motor.resistance_ohm,          &motor.inductance_H,
                              &motor.torque_constant_Nm_A,    &motor.inertia_kgm2,
                              &motor.rated_current_A,         &motor.supply_V,
                              &motor.viscous_friction_Nms_rad};
    const double bad[] = {-1.0, not_a_number, infinite};
    struct state_feedback_gains feedback;
    struct pid_gains pid;
    struct steady_state_ekf_gains paper;
    struct invariant_ekf_gains gains;
    struct invariant_ekf_hold_gains hold;

    for (unsigned i = 0; i < sizeof fields / sizeof fields[0]; i++) {
        for (unsigned k = 0; k < sizeof bad / sizeof bad[0]; k++) {
            double good = *fields[i];
            *fields[i] = bad[k];
            TEST_ASSERT_FALSE(
                state_feedback_design(&motor, period_s, 200.0, 1500.0, &feedback, error));
            TEST_ASSERT_EQUAL_STRING_LEN(names[i], error, strlen(names[i]));
            TEST_ASSERT_FALSE(pid_design(&motor, period_s, 200.0, 1500.0, &pid, error));
            TEST_ASSERT_FALSE(steady_state_ekf_design(&motor, period_s, &paper, error));
            TEST_ASSERT_FALSE(invariant_ekf_motion_design(&motor, period_s, &gains, error));
            TEST_ASSERT_FALSE(invariant_ekf_hold_design(&motor, period_s, 1.5, &hold, error));
            *fields[i] = good;
        }
    }
    motor.rotor_teeth = 0;
    TEST_ASSERT_FALSE(invariant_ekf_motion_design(&motor, period_s, &gains, error));
    TEST_ASSERT_EQUAL_STRING("rotor teeth 0 per turn: must be above 0 per turn, and finite", error);
}

static void a_period_beyond_the_electrical_time_constant_is_refused(void)
{
    struct invariant_ekf_gains gains;

    TEST_ASSERT_FALSE(invariant_ekf_motion_design(&motor, 2.5e-3, &gains, error));
    TEST_ASSERT_EQUAL_STRING("period 0.0025 s: must be below 0.002432 s, the motor's L / R", error);
}

static void a_period_for_which_the_euler_model_swings_up_is_refused(void)
{
    struct steady_state_ekf_gains gains;

    motor.inertia_kgm2 = 1e-6; /* the rotor swings against the EMF: R J / Km^2 = 15 us */
    TEST_ASSERT_FALSE(steady_state_ekf_design(&motor, period_s, &gains, error));
    TEST_ASSERT_EQUAL_STRING("period 0.0001 s: must be below 2.61e-05 s, or the Euler model "
                             "is unstable",
                             error);
}

static void a_hold_without_current_is_refused(void)
{
    struct invariant_ekf_hold_gains gains;

    TEST_ASSERT_FALSE(invariant_ekf_hold_design(&motor, period_s, 0.0, &gains, error));
    TEST_ASSERT_EQUAL_STRING("hold current 0 A: must be above 0 A, and finite", error);
}

static void numbers_in_refusals_have_four_digits(void)
{
    static const struct {
        double value;
        const char *text;
    } cases[] = {
        {0.0, "0"},
        {999.7, "999.7"},
        {1.0, "1"},
        {-3.5, "-3.5"},
        {0.03125, "0.03125"},
        {99995.0, "100000"},
        {123456.0, "123500"},
        {1.0e6, "1e+06"},
        {12345678.0, "1.235e+07"},
        {0.000125, "0.000125"},
        {9e-5, "9e-05"},
        {1.562e-5, "1.562e-05"},
        {1.5e-123, "1.5e-123"},
        {1e99, "1e+99"},
        {1e100, "1e+100"},
        {-2.5e100, "-2.5e+100"},
        {9.9999e99, "1e+100"},
    };

    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct refusal refusal = {.quantity = "x",
                                  .value = cases[i].value,
                                  .relation = "y",
                                  .limit = 1.0,
                                  .unit = "m",
                                  .reason = "z"};
        TEST_ASSERT_FALSE(design_refuse_limit(error, refusal));
        TEST_ASSERT_EQUAL_STRING_LEN(cases[i].text, error + 2, strlen(cases[i].text));
        TEST_ASSERT_EQUAL_STRING(" m: must be y 1 m, z", error + 2 + strlen(cases[i].text));
    }
}

static void a_value_differs_in_print_from_its_limit(void)
{
    struct refusal refusal = {.quantity = "speed",
                              .value = 140.0,
                              .relation = "at most",
                              .limit = 139.9968,
                              .unit = "rad/s",
                              .reason = "z"};

    TEST_ASSERT_FALSE(design_refuse_limit(error, refusal));
    TEST_ASSERT_EQUAL_STRING("speed 140 rad/s: must be at most 139.9968 rad/s, z", error);
}

static void a_long_refusal_is_cut_to_fit(void)
{
    char text[2 * DESIGN_ERROR_TEXT];

    memset(text, 'a', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    TEST_ASSERT_FALSE(design_refuse(error, text));
    TEST_ASSERT_EQUAL_size_t(DESIGN_ERROR_TEXT - 1, strlen(error));
}

/* ---- estimators ---- */

static void paper_gain_at_standstill_is_the_one_extracted(void)
{
    struct steady_state_ekf_gains gains;

    TEST_ASSERT_TRUE(steady_state_ekf_design(&motor, period_s, &gains, error));
    TEST_ASSERT_DOUBLE_WITHIN(5e-9, 0.00122314, gains.k_current_d);
    TEST_ASSERT_DOUBLE_WITHIN(5e-9, 0.00924184, gains.k_current_q);
    TEST_ASSERT_DOUBLE_WITHIN(5e-9, -0.02112846, gains.k_speed_q_rad_As);
    TEST_ASSERT_DOUBLE_WITHIN(5e-9, -0.00028647, gains.k_angle_q_rad_A);
    TEST_ASSERT_DOUBLE_WITHIN(5e-9, 0.00099537, gains.k_load_q_Nm_A);
}

static void motion_gains_are_the_optimum_found_for_the_reference_motor(void)
{
    struct invariant_ekf_gains gains;

    TEST_ASSERT_TRUE(invariant_ekf_motion_design(&motor, period_s, &gains, error));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.459528, gains.k_current_d);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.437949, gains.k_current_q);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -1.942612, gains.k_speed_q_rad_As);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.011901, gains.k_angle_d_rad_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -0.001789, gains.k_angle_q_rad_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.119719, gains.k_load_q_Nm_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0, gains.angle_d_full_speed_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, -0.00618984, gains.k_bias_d_V_A);
    TEST_ASSERT_TRUE(gains.k_bias_q_V_A == 0.0 && gains.k_resistance_ohm_A2 == 0.0);
    TEST_ASSERT_TRUE(gains.load_return == 0.0 && gains.load_settle == 0.0);
}

static void settled_hold_gains_of_the_reference_motor(void)
{
    struct invariant_ekf_hold_gains hold;
    const struct invariant_ekf_gains *gains = &hold.quiet;

    TEST_ASSERT_TRUE(invariant_ekf_hold_design(&motor, period_s, 1.5, &hold, error));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.63534, gains->k_current_d);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.65847, gains->k_current_q);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, -2.67109, gains->k_speed_q_rad_As);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, -0.0040019, gains->k_angle_q_rad_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.18360, gains->k_load_q_Nm_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -0.011943, gains->k_resistance_ohm_A2);
    TEST_ASSERT_TRUE(gains->k_angle_d_rad_A == 0.0 && gains->k_bias_d_V_A == 0.0);
    TEST_ASSERT_TRUE(gains->k_bias_q_V_A == 0.0 && gains->load_settle == 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.009110304, gains->load_return); /* 1 - exp(-0.1/10.9) */
    /* on the line J w_h^2 theta = -T_L, J w_h^2 = 50 x 0.157 x 1.5 N m/rad */
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, gains->load_return / 11.775, gains->angle_return_rad_Nm);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.001424492, gains->bias_return_V_Nm);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.025, hold.load_step_Nm);
}

/* 0.2 rad/s go on for 10.9 ms, against 11.775 N m/rad; of both phases 1.5 times. */
static void what_an_offset_feigns_is_no_load_step(void)
{
    struct invariant_ekf_hold_gains hold;

    TEST_ASSERT_TRUE(invariant_ekf_hold_design(&motor, period_s, 1.5, &hold, error));
    invariant_ekf_bear_offset(period_s, 0.1, &hold);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.025, hold.load_step_Nm);
    invariant_ekf_bear_offset(period_s, 0.2, &hold);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * 0.0385, 0.0385, hold.load_step_Nm);
}

static void a_hold_that_follows_leaves_the_offset_alone_and_lets_no_load_return(void)
{
    struct invariant_ekf_hold_gains hold;
    const struct invariant_ekf_gains *gains = &hold.following;

    TEST_ASSERT_TRUE(invariant_ekf_hold_design(&motor, period_s, 1.5, &hold, error));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, -4.04197, gains->k_speed_q_rad_As);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.311492, gains->k_load_q_Nm_A);
    TEST_ASSERT_TRUE(gains->k_bias_q_V_A == 0.0 && gains->bias_return_V_Nm == 0.0);
    TEST_ASSERT_TRUE(gains->load_return == 0.0 && gains->angle_return_rad_Nm == 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.181269247, gains->load_settle); /* 1 - exp(-0.1/0.5) */
    TEST_ASSERT_EQUAL_UINT32(291, hold.following_periods);            /* 8 / (275 rad/s) */
}

static void an_unloaded_hold_learns_the_offset_alone(void)
{
    struct invariant_ekf_hold_gains hold;
    const struct invariant_ekf_gains *gains = &hold.unloaded;

    TEST_ASSERT_TRUE(invariant_ekf_hold_design(&motor, period_s, 1.5, &hold, error));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -0.038814, gains->k_bias_q_V_A);
    TEST_ASSERT_TRUE(gains->k_angle_q_rad_A == 0.0 && gains->k_load_q_Nm_A == 0.0);
    TEST_ASSERT_TRUE(gains->bias_return_V_Nm == 0.0 && gains->angle_return_rad_Nm == 0.0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(exponential_is_exact_to_two_ulp);
    RUN_TEST(exponential_clamps_its_argument);
    RUN_TEST(lag_integrals_do_not_cancel_for_small_arguments);
    RUN_TEST(lag_integrals_join_where_their_formulas_change);
    RUN_TEST(matrix_exponential_of_a_rotation_is_sine_and_cosine);
    RUN_TEST(matrix_inverse_times_matrix_is_identity);
    RUN_TEST(indefinite_matrix_has_no_factors);
    RUN_TEST(random_walk_is_filtered_with_the_golden_ratio);
    RUN_TEST(riccati_refuses_what_is_not_a_number);
    RUN_TEST(state_feedback_gains_are_the_exact_ones);
    RUN_TEST(state_feedback_is_near_the_printed_gains_with_the_torque_constant_they_imply);
    RUN_TEST(the_poles_of_the_pid_are_three_at_its_bandwidth);
    RUN_TEST(feed_forward_carries_the_reference_motion);
    RUN_TEST(designs_bear_a_motor_without_friction);
    RUN_TEST(too_fast_a_position_loop_is_refused_with_its_limit);
    RUN_TEST(too_fast_a_current_loop_is_refused_with_its_limit);
    RUN_TEST(impossible_motors_are_refused_by_name);
    RUN_TEST(a_period_beyond_the_electrical_time_constant_is_refused);
    RUN_TEST(a_period_for_which_the_euler_model_swings_up_is_refused);
    RUN_TEST(a_hold_without_current_is_refused);
    RUN_TEST(numbers_in_refusals_have_four_digits);
    RUN_TEST(a_value_differs_in_print_from_its_limit);
    RUN_TEST(a_long_refusal_is_cut_to_fit);
    RUN_TEST(paper_gain_at_standstill_is_the_one_extracted);
    RUN_TEST(motion_gains_are_the_optimum_found_for_the_reference_motor);
    RUN_TEST(settled_hold_gains_of_the_reference_motor);
    RUN_TEST(what_an_offset_feigns_is_no_load_step);
    RUN_TEST(a_hold_that_follows_leaves_the_offset_alone_and_lets_no_load_return);
    RUN_TEST(an_unloaded_hold_learns_the_offset_alone);
    return UNITY_END();
}
