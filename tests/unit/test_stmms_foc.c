/* The laws of Kim 2016: STMMS, STMMS with inductance feed-forward, FOC; one mechanical controller.
 */
#include "firmware/control/foc.h"
#include "firmware/control/position_law_dispatch.h"
#include "firmware/control/stmms.h"
#include "firmware/control/stmms_plus.h"
#include "firmware/numeric/angle.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

/* Case 1 of the paper, on another motor. */
#define K1P 1000.0
#define K0  1e6
#define K1  20.0
#define K2  100.0
#define RHO 1500.0

/* Of 12 V: gains of 16 bits on terms of that size, a resistance of 16 bits. */
#define ROUNDING_V (24.0 * (16.0 * COEF_ROUNDING + 64.0 * NUM_ROUNDING))
#define ROUNDING_A (6.0 * (4.0 * COEF_ROUNDING + 64.0 * NUM_ROUNDING))

static const double not_given = __builtin_nan("");

static struct per_unit base;
static double gains[LAW_GAINS_MAX];
static struct position_law_task task;
static enum position_law law;
static union position_law_params params;
static union position_law_state state;
static char error[DESIGN_ERROR_TEXT];

/* What a law is asked in one period, SI. */
static struct {
    double error_rad;
    double reference_speed_rad_s, reference_acceleration_rad_s2;
    double speed_rad_s;
    double load_torque_Nm;
    double i_d_A, i_q_A, i_d_reference_A;
    double resistance_ohm;
    double voltage_limit_V;
} asked;

static const enum position_law laws[] = {POSITION_LAW_STMMS, POSITION_LAW_STMMS_PLUS,
                                         POSITION_LAW_FOC};
enum { LAWS = sizeof laws / sizeof laws[0] };

void setUp(void)
{
    base = per_unit_base(&bench_params, PERIOD_S);
    for (int i = 0; i < LAW_GAINS_MAX; i++) {
        gains[i] = not_given;
    }
    task = (struct position_law_task){
        .motor = &bench_params,
        .base = &base,
        .period_s = PERIOD_S,
        .delay_periods = 1,
        .bandwidth_rad_s = 200.0,
        .current_bandwidth_rad_s = RHO,
        .speed_limit_rad_s = 30.0,
        .current_limit_A = 3.0,
        .gains = gains,
    };
    asked.error_rad = 0.0;
    asked.reference_speed_rad_s = 0.0;
    asked.reference_acceleration_rad_s2 = 0.0;
    asked.speed_rad_s = 0.0;
    asked.load_torque_Nm = 0.0;
    asked.i_d_A = 0.0;
    asked.i_q_A = 0.0;
    asked.i_d_reference_A = 0.0;
    asked.resistance_ohm = bench_params.resistance_ohm;
    asked.voltage_limit_V = 22.0;
}

void tearDown(void)
{
}

static void design(enum position_law which)
{
    law = which;
    TEST_ASSERT_TRUE_MESSAGE(position_law_design(law, &params, &task, error), error);
    position_law_reset(&state);
}

static void design_as_published(enum position_law which)
{
    gains[TORQUE_DEMAND_K1P] = K1P;
    gains[TORQUE_DEMAND_K0] = K0;
    gains[TORQUE_DEMAND_K1] = K1;
    gains[TORQUE_DEMAND_K2] = K2;
    design(which);
}

struct answer {
    double v_d_V, v_q_V, i_q_A;
};

static struct answer step(void)
{
    const struct voltage_law_input input = {
        .motion = {.position_error = num_from_double(asked.error_rad / base.rad_per_turn),
                   .reference_speed =
                       num_from_double(asked.reference_speed_rad_s / base.speed_rad_s),
                   .reference_acceleration = num_from_double(asked.reference_acceleration_rad_s2 /
                                                             base.acceleration_rad_s2),
                   .speed = num_from_double(asked.speed_rad_s / base.speed_rad_s),
                   .load_torque = num_from_double(asked.load_torque_Nm / base.torque_Nm)},
        .current = {num_from_double(asked.i_d_A / base.current_A),
                    num_from_double(asked.i_q_A / base.current_A)},
        .current_d_reference = num_from_double(asked.i_d_reference_A / base.current_A),
        .resistance = num_from_double(asked.resistance_ohm / base.resistance_ohm),
        .voltage_limit = num_from_double(asked.voltage_limit_V / base.voltage_V),
    };
    const struct voltage_demand demand = position_law_voltage(law, &state, &params, &input);

    return (struct answer){num_to_double(demand.voltage.d) * base.voltage_V,
                           num_to_double(demand.voltage.q) * base.voltage_V,
                           num_to_double(demand.torque_current) * base.current_A};
}

/* The second of two equal periods, from which L di*, the change of the reference, is gone. */
static struct answer steady_step(void)
{
    gains[TORQUE_DEMAND_K0] = 0.0; /* nothing gathers in the first */
    design(law);
    (void)step();
    return step();
}

/* (24) as printed, signs of e1 = theta - theta* included. */
static double equation_24_A(double integral_rad_s)
{
    const double e1 = -asked.error_rad;
    const double e1_rate = asked.speed_rad_s - asked.reference_speed_rad_s;
    const double e2 = e1_rate + K1P * e1;
    const double torque = 0.307e-3 * asked.speed_rad_s + asked.load_torque_Nm +
                          15.62e-5 * (asked.reference_acceleration_rad_s2 - K1P * e1_rate -
                                      K0 * -integral_rad_s - K1 * e1 - K2 * e2);

    return torque / 0.157;
}

static void ask_for_motion(void)
{
    asked.error_rad = 3e-3;
    asked.reference_speed_rad_s = 20.0;
    asked.speed_rad_s = 19.5;
    asked.reference_acceleration_rad_s2 = 300.0;
    asked.load_torque_Nm = 0.05;
}

static void test_the_torque_demand_is_equation_24(void)
{
    for (int i = 0; i < LAWS; i++) {
        setUp();
        ask_for_motion();
        design_as_published(laws[i]);
        TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_A, equation_24_A(1 * 3e-3 * PERIOD_S), step().i_q_A);
        TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_A, equation_24_A(2 * 3e-3 * PERIOD_S), step().i_q_A);
        asked.error_rad = -2e-3;
        TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_A, equation_24_A((6e-3 - 2e-3) * PERIOD_S),
                                  step().i_q_A);
    }
}

static void test_the_load_is_compensated_unless_that_is_switched_off(void)
{
    for (int i = 0; i < LAWS; i++) {
        setUp();
        asked.load_torque_Nm = 0.1;
        design(laws[i]);
        TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_A, 0.1 / 0.157, step().i_q_A);
        gains[TORQUE_DEMAND_LOAD_COMPENSATION] = 0.0;
        design(laws[i]);
        TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_A, 0.0, step().i_q_A);
    }
}

/* (28) in the rotor frame, whatever currents flow. */
static void test_stmms_gives_the_voltage_of_a_winding_without_inductance(void)
{
    ask_for_motion();
    asked.resistance_ohm = 0.6;
    asked.i_d_A = 1.0;
    asked.i_q_A = -1.0;
    design_as_published(POSITION_LAW_STMMS);
    const struct answer answer = step();

    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, 0.0, answer.v_d_V);
    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, 0.6 * answer.i_q_A + 0.157 * 19.5, answer.v_q_V);
}

static void test_stmms_plus_adds_what_the_inductance_takes(void)
{
    ask_for_motion();
    asked.i_d_A = 1.0;
    asked.i_q_A = -1.0;
    asked.i_d_reference_A = 0.5;
    gains[TORQUE_DEMAND_GAINS] = 0.5; /* inductance_feed_forward */
    design_as_published(POSITION_LAW_STMMS_PLUS);
    const struct answer first = step();
    const double reactance_ohm = 50.0 * 19.5 * 0.9e-3;

    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, 0.37 * 0.5 - reactance_ohm * first.i_q_A, first.v_d_V);
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * ROUNDING_V,
                              0.37 * first.i_q_A + 0.157 * 19.5 + reactance_ohm * 0.5 +
                                  0.5 * 0.9e-3 * first.i_q_A / PERIOD_S,
                              first.v_q_V);
}

/* The steady voltages of a motor that carries i_q* at this speed: the equations of the motor. */
static void test_foc_and_stmms_plus_hold_the_demanded_current_at_any_speed(void)
{
    ask_for_motion();
    for (int i = 1; i < LAWS; i++) {
        law = laws[i];
        for (int direction = -1; direction <= 1; direction += 2) {
            asked.speed_rad_s = direction * 20.0;
            asked.reference_speed_rad_s = asked.speed_rad_s;
            asked.i_q_A = (0.05 + 0.307e-3 * asked.speed_rad_s + 15.62e-5 * 300.0) / 0.157;
            asked.error_rad = 0.0;
            const struct answer answer = steady_step();

            TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_A, asked.i_q_A, answer.i_q_A);
            TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, -50.0 * asked.speed_rad_s * 0.9e-3 * asked.i_q_A,
                                      answer.v_d_V);
            TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, 0.37 * asked.i_q_A + 0.157 * asked.speed_rad_s,
                                      answer.v_q_V);
        }
    }
}

/* rho L on either axis. */
static void test_foc_closes_the_current_with_rho(void)
{
    asked.load_torque_Nm = 0.1;
    law = POSITION_LAW_FOC;
    const struct answer without = steady_step();

    asked.i_d_A = 0.5;
    asked.i_q_A = 0.25;
    const struct answer with = steady_step();

    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, 0.5 * (0.37 - RHO * 0.9e-3), with.v_d_V - without.v_d_V);
    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, 0.25 * (0.37 - RHO * 0.9e-3), with.v_q_V - without.v_q_V);
    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_V, 0.1 / 0.157 * (0.37 - 0.37 + RHO * 0.9e-3),
                              without.v_q_V);
}

static void test_current_and_voltage_stay_within_their_limits(void)
{
    for (int i = 0; i < LAWS; i++) {
        setUp();
        design(laws[i]);
        for (int k = 0; k < 40; k++) {
            const double sign = k % 3 == 0 ? -1.0 : 1.0;

            asked.error_rad = sign * POSITION_DIFFERENCE_MAX * base.rad_per_turn;
            asked.reference_speed_rad_s = sign * 100.0;
            asked.speed_rad_s = -sign * 100.0;
            asked.i_d_A = -sign * 6.0;
            asked.i_q_A = -sign * 6.0;
            const struct answer answer = step();
            const double length = sqrt(answer.v_d_V * answer.v_d_V + answer.v_q_V * answer.v_q_V);

            TEST_ASSERT_DOUBLE_WITHIN(1e-5, sign * 3.0, answer.i_q_A);
            TEST_ASSERT_TRUE(length <= 22.0 * (1.0 + 1e-4));
        }
    }
}

static double integral_A(void)
{
    /* all three states begin with it */
    return num_to_double(state.stmms.demand.integral) / TORQUE_DEMAND_INTEGRAL_SCALE *
           base.current_A;
}

static void test_the_integral_does_not_wind_up_while_the_current_is_limited(void)
{
    for (int i = 0; i < LAWS; i++) {
        setUp();
        asked.error_rad = 0.1;
        design(laws[i]);
        for (int k = 0; k < 3000; k++) {
            (void)step();
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, integral_A());
    }
}

/* A bus too low for the speed: the voltage is short long before the current is. */
static void test_the_integral_does_not_wind_up_while_the_voltage_is_limited(void)
{
    for (int i = 0; i < LAWS; i++) {
        setUp();
        asked.error_rad = 1e-3;
        asked.speed_rad_s = 30.0;
        asked.reference_speed_rad_s = 30.0;
        asked.voltage_limit_V = 4.0;
        design(laws[i]);
        (void)step(); /* finds it short */
        const double before = integral_A();

        for (int k = 0; k < 3000; k++) {
            (void)step();
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, before, integral_A());
        asked.error_rad = -1e-3; /* the way back is open */
        (void)step();
        TEST_ASSERT_TRUE(integral_A() < before);
    }
}

static void test_the_integral_makes_up_for_what_the_model_does_not_know(void)
{
    for (int i = 0; i < LAWS; i++) {
        setUp();
        asked.error_rad = 1e-3;
        design(laws[i]);
        const double first = step().i_q_A;

        for (int k = 1; k < 1000; k++) {
            (void)step();
        }
        /* k0 = k1p k2 w0/30 */
        const double gathered_A = 15.62e-5 / 0.157 * (800.0 * 200.0 * 200.0 / 30.0) * 1e-3 * 0.1;

        TEST_ASSERT_DOUBLE_WITHIN(0.01 * gathered_A, first + gathered_A, step().i_q_A);
    }
}

static void is_refused(enum position_law which, const char *text)
{
    TEST_ASSERT_FALSE(position_law_design(which, &params, &task, error));
    TEST_ASSERT_EQUAL_STRING(text, error);
}

static void test_a_bandwidth_beyond_the_sampling_is_refused_with_its_limit(void)
{
    task.bandwidth_rad_s = 400.0;
    is_refused(POSITION_LAW_STMMS_PLUS, "law_bandwidth_rad_s 400 rad/s: must be at most 375 rad/s, "
                                        "k1p T <= 0.15, k1p = 4 bandwidths");
    task.current_bandwidth_rad_s = 2000.0;
    is_refused(POSITION_LAW_FOC, "law_bandwidth_rad_s 400 rad/s: must be at most 375 rad/s, "
                                 "k1p T <= 0.15, k1p = 4 bandwidths");
    task.current_bandwidth_rad_s = 3500.0;
    is_refused(POSITION_LAW_FOC, "current bandwidth 3500 rad/s: must be at most 3000 rad/s, "
                                 "0.3 per control period");
}

static void test_stmms_refuses_what_its_winding_is_too_slow_for(void)
{
    task.bandwidth_rad_s = 250.0;
    is_refused(POSITION_LAW_STMMS, "law_bandwidth_rad_s 250 rad/s: must be at most 230.2 rad/s, "
                                   "(k1p + k2) L/R <= 2.8");
    task.bandwidth_rad_s = 200.0;
    task.speed_limit_rad_s = 60.0;
    is_refused(POSITION_LAW_STMMS, "speed_limit_rad_s 60 rad/s: must be at most 32.89 rad/s, "
                                   "N w L/R <= 4 without current control");
}

/* The paper's own gains are beyond every limit. */
static void test_given_gains_are_taken_as_they_are(void)
{
    task.bandwidth_rad_s = 1000.0;
    task.current_bandwidth_rad_s = 25000.0;
    task.speed_limit_rad_s = 200.0;
    gains[TORQUE_DEMAND_GAINS] = 1.0;
    for (int i = 0; i < LAWS; i++) {
        if (laws[i] == POSITION_LAW_FOC) {
            gains[TORQUE_DEMAND_GAINS] = 25000.0; /* rho */
        }
        design_as_published(laws[i]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_torque_demand_is_equation_24);
    RUN_TEST(test_the_load_is_compensated_unless_that_is_switched_off);
    RUN_TEST(test_stmms_gives_the_voltage_of_a_winding_without_inductance);
    RUN_TEST(test_stmms_plus_adds_what_the_inductance_takes);
    RUN_TEST(test_foc_and_stmms_plus_hold_the_demanded_current_at_any_speed);
    RUN_TEST(test_foc_closes_the_current_with_rho);
    RUN_TEST(test_current_and_voltage_stay_within_their_limits);
    RUN_TEST(test_the_integral_does_not_wind_up_while_the_current_is_limited);
    RUN_TEST(test_the_integral_does_not_wind_up_while_the_voltage_is_limited);
    RUN_TEST(test_the_integral_makes_up_for_what_the_model_does_not_know);
    RUN_TEST(test_a_bandwidth_beyond_the_sampling_is_refused_with_its_limit);
    RUN_TEST(test_stmms_refuses_what_its_winding_is_too_slow_for);
    RUN_TEST(test_given_gains_are_taken_as_they_are);
    return UNITY_END();
}
