/* The default law with an encoder: its voltage against the simulated bench motor. */
#include "firmware/control/feedback_linearisation.h"
#include "firmware/design/feedback_linearisation_design.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

#define BANDWIDTH         900.0
#define CURRENT_BANDWIDTH 2000.0

enum { DAMPING, VOLTAGE_DISTURBANCE, JERK, LOAD };

static struct per_unit base;
static double given[LAW_GAINS_MAX];
static struct position_law_task task;
static struct feedback_linearisation_law_params params;
static struct feedback_linearisation_law_state state;
static struct voltage_law_input input;
static char error[DESIGN_ERROR_TEXT];

static bool design(void)
{
    state = (struct feedback_linearisation_law_state){0};
    return feedback_linearisation_law_design(&params, &task, error);
}

void setUp(void)
{
    base = per_unit_base(&bench_params, PERIOD_S);
    for (int i = 0; i < LAW_GAINS_MAX; i++) {
        given[i] = __builtin_nan("");
    }
    task = (struct position_law_task){
        .motor = &bench_params,
        .base = &base,
        .period_s = PERIOD_S,
        .delay_periods = 1,
        .bandwidth_rad_s = BANDWIDTH,
        .current_bandwidth_rad_s = CURRENT_BANDWIDTH,
        .speed_limit_rad_s = 150.0,
        .current_limit_A = 3.0,
        .gains = given,
    };
    TEST_ASSERT_TRUE_MESSAGE(design(), error);
    input = (struct voltage_law_input){
        .resistance = num_from_double(bench_params.resistance_ohm / base.resistance_ohm),
        .voltage_limit = NUM(0.92),
    };
}

void tearDown(void)
{
}

static struct voltage_demand step(void)
{
    return feedback_linearisation_law_step(&state, &params, &input);
}

static double q_V(struct voltage_demand demand)
{
    return num_to_double(demand.voltage.q) * base.voltage_V;
}

static double current_A(struct voltage_demand demand)
{
    return num_to_double(demand.torque_current) * base.current_A;
}

static void motion(double position_error_rad, double speed_error_rad_s, double speed_rad_s)
{
    input.motion.position_error = num_from_double(position_error_rad / base.rad_per_turn);
    input.motion.reference_speed =
        num_from_double((speed_rad_s + speed_error_rad_s) / base.speed_rad_s);
    input.motion.speed = num_from_double(speed_rad_s / base.speed_rad_s);
}

static void currents(double d_A, double q_A)
{
    input.current =
        (struct dq){num_from_double(d_A / base.current_A), num_from_double(q_A / base.current_A)};
    input.undisturbed_current = input.current;
}

static void test_at_rest_it_holds_the_load_with_its_copper_drop(void)
{
    const double load_Nm = 0.1;
    const double i_q = load_Nm / bench_params.torque_constant_Nm_A;

    input.motion.load_torque = num_from_double(load_Nm / base.torque_Nm);
    currents(0.0, i_q);
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, bench_params.resistance_ohm * i_q, q_V(step()));
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.0, step().voltage.d);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, i_q, current_A(step()));
}

/* The q current after a period of the bench motor under the demanded voltage. */
static struct bench_vector after_a_period(double d_A, double q_A, double speed_rad_s)
{
    const struct voltage_demand demand = step();
    const double turn = speed_rad_s * bench_params.rotor_teeth * PERIOD_S;
    const struct bench_vector i = bench_to_phases(d_A, q_A, 0.0);
    const struct bench_vector u =
        bench_to_phases(num_to_double(demand.voltage.d) * base.voltage_V,
                        num_to_double(demand.voltage.q) * base.voltage_V, 0.5 * turn);
    struct bench_motor motor = {
        .motor = bench_params, .i_a = i.a, .i_b = i.b, .speed_rad_s = speed_rad_s};

    motor.motor.inertia_kgm2 = IMPOSED_SPEED;
    bench_run(&motor, u.a, u.b);
    return bench_to_rotor(motor.i_a, motor.i_b, bench_electrical_rad(&motor));
}

static void test_the_currents_change_by_what_the_errors_ask_at_any_speed(void)
{
    const struct feedback_linearisation_poles poles = {BANDWIDTH, 0.7, CURRENT_BANDWIDTH};
    const double km = bench_params.torque_constant_Nm_A;
    const double inertia = bench_params.inertia_kgm2;
    struct feedback_linearisation_gains k;

    TEST_ASSERT_TRUE(feedback_linearisation_design(PERIOD_S, &poles, &k, error));
    params.half_speed = coef_from_double(0.0); /* the bench's speed is imposed */
    for (double speed = -90.0; speed < 100.0; speed += 30.0) {
        const double i_d = 0.4;
        const double i_q = 0.8;
        const double load_Nm = 0.06;
        const double reference_rad_s2 = 500.0;
        const double acceleration =
            (km * i_q - bench_params.viscous_friction_Nms_rad * speed - load_Nm) / inertia;
        const double change = inertia / km *
                              (k.k_position_s2 * 3e-4 + k.k_speed_s * -0.2 +
                               k.k_acceleration * (reference_rad_s2 - acceleration));

        motion(3e-4, -0.2, speed);
        input.motion.load_torque = num_from_double(load_Nm / base.torque_Nm);
        input.motion.reference_acceleration =
            num_from_double(reference_rad_s2 / base.acceleration_rad_s2);
        currents(i_d, i_q);

        const struct bench_vector after = after_a_period(i_d, i_q, speed);

        /* within a hundredth of the change: R d/2 sin h/2 is left out */
        TEST_ASSERT_DOUBLE_WITHIN(4e-3, i_q + change, after.b);
        TEST_ASSERT_DOUBLE_WITHIN(4e-3, i_d * exp(-CURRENT_BANDWIDTH * PERIOD_S), after.a);
    }
}

static void test_jerk_and_known_load_are_fed_forward_in_full(void)
{
    const double before = current_A(step());

    input.reference_jerk = NUM(0.01);
    input.load_torque_change = NUM(0.02);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, before + 0.03 * base.current_A, current_A(step()));
    given[JERK] = 0.0;
    TEST_ASSERT_TRUE(design());
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, before + 0.02 * base.current_A, current_A(step()));
}

static void test_a_voltage_that_nobody_demanded_is_taken_back(void)
{
    const double disturbance_V = -0.5;
    const double b =
        (1.0 - exp(-bench_params.resistance_ohm * PERIOD_S / bench_params.inductance_H)) /
        bench_params.resistance_ohm;
    const double before = q_V(step());

    input.innovation.q = num_from_double(b * disturbance_V / base.current_A);
    for (int i = 0; i < 200; i++) {
        (void)step();
    }
    /* the current it adds before the answer acts is made up for as well */
    input.undisturbed_current.q = num_from_double(-b * disturbance_V / base.current_A);
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, before - disturbance_V, q_V(step()));
}

static void test_without_a_disturbance_observer_innovations_do_nothing(void)
{
    given[VOLTAGE_DISTURBANCE] = 0.0;
    TEST_ASSERT_TRUE(design());
    input.innovation = (struct dq){NUM(0.02), NUM(0.02)};
    for (int i = 0; i < 200; i++) {
        (void)step();
    }
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.0, step().voltage.q);
}

static void test_a_step_of_any_size_stays_within_current_and_voltage(void)
{
    for (double size = 0.01; size < 2.0; size *= 2.0) {
        motion(size, 0.0, 0.0);
        const struct voltage_demand demand = step();
        const double magnitude =
            hypot(num_to_double(demand.voltage.d), num_to_double(demand.voltage.q));

        TEST_ASSERT_TRUE(fabs(current_A(demand)) <= 3.0 + 1e-3);
        TEST_ASSERT_TRUE(magnitude <= 0.92 + 1e-4);
    }
}

/* The speed at which the law neither accelerates nor brakes. */
static double approach_speed(double distance_rad)
{
    double slow = 0.0;
    double fast = 200.0;

    for (int i = 0; i < 40; i++) {
        const double speed = 0.5 * (slow + fast);

        motion(distance_rad, -speed, speed);
        currents(0.0,
                 bench_params.viscous_friction_Nms_rad * speed / bench_params.torque_constant_Nm_A);
        if (num_to_double(step().torque_current) > num_to_double(input.current.q)) {
            slow = speed;
        } else {
            fast = speed;
        }
    }
    return slow;
}

static void test_far_away_it_approaches_as_fast_as_the_current_can_brake(void)
{
    const double braking_rad_s2 =
        bench_params.torque_constant_Nm_A * task.current_limit_A / bench_params.inertia_kgm2;

    for (double distance_rad = 0.03; distance_rad < 1.0; distance_rad *= 2.0) {
        const double speed = approach_speed(distance_rad);
        const double needed_rad_s2 = speed * speed / (2.0 * distance_rad);

        TEST_ASSERT_TRUE(needed_rad_s2 < 0.62 * braking_rad_s2);
        TEST_ASSERT_TRUE(needed_rad_s2 > 0.35 * braking_rad_s2);
    }
}

static void test_a_bandwidth_that_the_period_cannot_bear_is_refused(void)
{
    task.bandwidth_rad_s = 1600.0;
    TEST_ASSERT_FALSE(design());
    TEST_ASSERT_EQUAL_STRING("law_bandwidth_rad_s 1600 rad/s: must be at most 1500 rad/s, "
                             "0.15 per control period",
                             error);
    task.bandwidth_rad_s = 1500.01;
    TEST_ASSERT_FALSE(design());
    for (double share = 0.15; share > 0.1499; share *= 1.0 - 1e-5) { /* however it is rounded */
        task.bandwidth_rad_s = share / task.period_s;
        TEST_ASSERT_TRUE_MESSAGE(design(), error);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_at_rest_it_holds_the_load_with_its_copper_drop);
    RUN_TEST(test_the_currents_change_by_what_the_errors_ask_at_any_speed);
    RUN_TEST(test_jerk_and_known_load_are_fed_forward_in_full);
    RUN_TEST(test_a_voltage_that_nobody_demanded_is_taken_back);
    RUN_TEST(test_without_a_disturbance_observer_innovations_do_nothing);
    RUN_TEST(test_a_step_of_any_size_stays_within_current_and_voltage);
    RUN_TEST(test_far_away_it_approaches_as_fast_as_the_current_can_brake);
    RUN_TEST(test_a_bandwidth_that_the_period_cannot_bear_is_refused);
    return UNITY_END();
}
