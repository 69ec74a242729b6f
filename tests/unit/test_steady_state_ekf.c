/* Bendjedia's estimator: equation by equation, and within the limits it is known to have. */
#include "firmware/estimator/steady_state_ekf.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

static struct per_unit base;
static struct motor_model_params model;
static struct steady_state_ekf_gains gains;
static struct steady_state_ekf_params params;
static struct steady_state_ekf ekf;
static char error[DESIGN_ERROR_TEXT];

void setUp(void)
{
    const struct position origin = {0, 0};

    base = per_unit_base(&bench_params, PERIOD_S);
    model = motor_model_design(&bench_params, &base, PERIOD_S, 0.0);
    TEST_ASSERT_TRUE_MESSAGE(steady_state_ekf_design(&bench_params, PERIOD_S, &gains, error),
                             error);
    params = steady_state_ekf_scale(&model, &base, &gains);
    steady_state_ekf_reset(&ekf, &params, origin, model.nominal_resistance);
}

void tearDown(void)
{
}

/* The state of the paper, SI. */
struct state {
    double i_d, i_q, speed, angle, load;
};

/* (3), (8), (11) as printed, sign of the back-EMF corrected; voltage taken at theta + T w / 2. */
static struct state paper_step(struct state x, struct bench_vector u_ab, struct bench_vector i_ab)
{
    const double R = 0.37;
    const double L = 0.9e-3;
    const double Km = 0.157;
    const double Kv = 0.307e-3;
    const double J = 15.62e-5;
    const double N = 50.0;
    const double T = PERIOD_S;
    const struct bench_vector u = bench_to_rotor(u_ab.a, u_ab.b, N * (x.angle + 0.5 * T * x.speed));
    struct state y = {
        .i_d = x.i_d + T / L * (u.a - R * x.i_d + N * L * x.speed * x.i_q),
        .i_q = x.i_q + T / L * (u.b - R * x.i_q - N * L * x.speed * x.i_d - Km * x.speed),
        .speed = x.speed + T / J * (Km * x.i_q - Kv * x.speed - x.load),
        .angle = x.angle + T * x.speed,
        .load = x.load,
    };
    const struct bench_vector i = bench_to_rotor(i_ab.a, i_ab.b, N * y.angle);
    const double nu_d = i.a - y.i_d;
    const double nu_q = i.b - y.i_q;

    y.i_d += gains.k_current_d * nu_d;
    y.i_q += gains.k_current_q * nu_q;
    y.speed += gains.k_speed_q_rad_As * nu_q;
    y.angle += gains.k_angle_q_rad_A * nu_q;
    y.load += gains.k_load_q_Nm_A * nu_q;
    return y;
}

static void set(struct state x)
{
    struct estimate *estimate = &ekf.estimate;

    steady_state_ekf_reset(&ekf, &params, position_from_rad(x.angle, 50), model.nominal_resistance);
    ekf.current.d = num_from_double(x.i_d / base.current_A);
    ekf.current.q = num_from_double(x.i_q / base.current_A);
    estimate->rotor.speed = num_from_double(x.speed / base.speed_rad_s);
    estimate->rotor.load_torque = num_from_double(x.load / base.torque_Nm);
}

static void step(struct bench_vector voltage, struct bench_vector current)
{
    const struct channels winding = {
        .voltage = bench_phases(voltage.a, voltage.b, base.voltage_V),
        .current = bench_phases(current.a, current.b, base.current_A),
    };

    (void)steady_state_ekf_predict(&ekf, &params, winding.voltage);
    (void)steady_state_ekf_step(&ekf, &params, &winding, winding.voltage);
}

static void test_a_step_is_that_of_the_paper(void)
{
    static const struct state starts[] = {
        {0.0, 0.0, 0.0, 0.0, 0.0},    {0.1, -0.5, 3.0, 0.02, 0.05},   {-0.4, 1.2, 45.0, -0.7, 0.1},
        {1.5, 0.2, -20.0, 3.3, -0.2}, {-1.0, -2.5, -45.0, 12.0, 0.3},
    };
    static const struct bench_vector voltage = {6.0, -9.0};
    static const struct bench_vector current = {0.7, -1.1};
    const double rounding = 20.0 * (NUM_ROUNDING + COEF_ROUNDING) + 4.0 * SINE_ERROR;

    for (unsigned i = 0; i < sizeof starts / sizeof starts[0]; i++) {
        const struct state expected = paper_step(starts[i], voltage, current);
        const struct estimate *x = &ekf.estimate;

        set(starts[i]);
        step(voltage, current);
        TEST_ASSERT_NUM_WITHIN(rounding, expected.i_d / base.current_A, ekf.current.d);
        TEST_ASSERT_NUM_WITHIN(rounding, expected.i_q / base.current_A, ekf.current.q);
        TEST_ASSERT_NUM_WITHIN(rounding, expected.speed / base.speed_rad_s, x->rotor.speed);
        TEST_ASSERT_NUM_WITHIN(rounding, expected.load / base.torque_Nm, x->rotor.load_torque);
        TEST_ASSERT_DOUBLE_WITHIN(rounding * base.rad_per_turn, expected.angle,
                                  position_to_rad(x->rotor.position, 50));
    }
}

static void test_a_reset_forgets_all_but_what_it_is_set_to(void)
{
    set((struct state){0.5, 0.5, 20.0, 1.0, 0.1});
    steady_state_ekf_reset(&ekf, &params, position_from_rad(2.0, 50), NUM(0.1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2.0, position_to_rad(ekf.estimate.rotor.position, 50));
    TEST_ASSERT_NUM_WITHIN(0.0, 0.0, ekf.current.d);
    TEST_ASSERT_NUM_WITHIN(0.0, 0.0, ekf.current.q);
    TEST_ASSERT_NUM_WITHIN(0.0, 0.0, ekf.estimate.rotor.speed);
    TEST_ASSERT_NUM_WITHIN(0.0, 0.0, ekf.estimate.rotor.load_torque);
    TEST_ASSERT_NUM_WITHIN(NUM_ROUNDING, 0.1, ekf.estimate.winding.resistance);
}

/* What the rest of the drive sees as current is what was measured. */
static void test_the_phase_currents_shown_are_the_measured_ones(void)
{
    const struct bench_vector voltage = {1.0, 0.5};
    const struct bench_vector current = {0.6, -0.3};

    step(voltage, current);
    TEST_ASSERT_NUM_WITHIN(NUM_ROUNDING, 0.1, ekf.estimate.current.a);
    TEST_ASSERT_NUM_WITHIN(NUM_ROUNDING, -0.05, ekf.estimate.current.b);
}

static struct bench_motor motor;

static void turn(double speed_rad_s, int periods)
{
    for (int k = 0; k < periods; k++) {
        const struct bench_vector voltage =
            bench_regulate(&motor, 0.0, bench_speed_current(&motor, speed_rad_s));
        struct bench_vector current;

        bench_run(&motor, voltage.a, voltage.b);
        current = (struct bench_vector){motor.i_a, motor.i_b};
        step(voltage, current);
    }
}

static double angle_error_electrical_deg(void)
{
    return (motor.angle_rad - position_to_rad(ekf.estimate.rotor.position, 50)) * 50.0 * 360.0 /
           TWO_PI;
}

static void test_moderate_speeds_are_tracked_both_ways(void)
{
    static const double speeds[] = {20.0, -20.0};

    for (unsigned i = 0; i < 2u; i++) {
        setUp();
        motor = (struct bench_motor){.motor = bench_params};
        turn(speeds[i], 2000);
        TEST_ASSERT_DOUBLE_WITHIN(3.0, 0.0, angle_error_electrical_deg());
        TEST_ASSERT_DOUBLE_WITHIN(0.5, motor.speed_rad_s,
                                  num_to_double(ekf.estimate.rotor.speed) * base.speed_rad_s);
    }
}

/*
 * The Euler predictor alone, the speed held: a current error shrinks by |1 - T R/L + j N w T| a
 * period, which is 1 at 56.8 rad/s.
 */
static double current_error_left(double speed_rad_s)
{
    const struct steady_state_ekf_gains no_gains = {0.0, 0.0, 0.0, 0.0, 0.0};
    const struct bench_vector no_current = {0.0, 0.0};
    const double back_emf = 0.157 * speed_rad_s;
    double d;
    double q;

    params = steady_state_ekf_scale(&model, &base, &no_gains);
    params.model.speed_per_torque = coef_from_double(0.0);
    set((struct state){.i_d = 0.6, .speed = speed_rad_s});
    for (int k = 0; k < 200; k++) {
        const double mid_rad = 50.0 * speed_rad_s * PERIOD_S * (k + 0.5);

        step(bench_to_phases(0.0, back_emf, mid_rad), no_current);
    }
    d = num_to_double(ekf.current.d);
    q = num_to_double(ekf.current.q);
    return sqrt(d * d + q * q) / 0.1;
}

static void test_the_euler_predictor_is_stable_up_to_57_rad_s(void)
{
    TEST_ASSERT_TRUE(current_error_left(50.0) < 0.6);
    TEST_ASSERT_TRUE(current_error_left(63.0) > 1.7);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_step_is_that_of_the_paper);
    RUN_TEST(test_a_reset_forgets_all_but_what_it_is_set_to);
    RUN_TEST(test_the_phase_currents_shown_are_the_measured_ones);
    RUN_TEST(test_moderate_speeds_are_tracked_both_ways);
    RUN_TEST(test_the_euler_predictor_is_stable_up_to_57_rad_s);
    return UNITY_END();
}
