/* The motor over one period, compared with the motor itself and with closed solutions. */
#include "firmware/design/elementary.h"
#include "firmware/motor/motor_model.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

#define NO_BRIDGE_OHM 0.0

/*
 * A current follows from ten rounded operations and the admittance, its series cut at x^3/24 with
 * x = T R/L = 0.04: 3e-6 of what the voltage adds in a period.
 */
#define CURRENT_ROUNDING (10.0 * (NUM_ROUNDING + COEF_ROUNDING) + 1e-6)

/* Resolution of an angle that was a num_t, electrical turns. */
#define ANGLE_ROUNDING (2.0 * NUM_ROUNDING + 1.0 / 4294967296.0)

static struct per_unit base;
static struct motor_model_params model;
static struct winding winding;

void setUp(void)
{
    base = per_unit_base(&bench_params, PERIOD_S);
    model = motor_model_design(&bench_params, &base, PERIOD_S, NO_BRIDGE_OHM);
    winding_set_resistance(&winding, &model, model.nominal_resistance);
}

void tearDown(void)
{
}

static struct phases predicted(struct phases current, struct phases voltage, num_t speed,
                               struct sincos mid_period)
{
    return predict_current(&model, &winding, current, speed, mid_period, voltage);
}

static void test_per_unit_makes_back_emf_equal_to_speed_and_torque_equal_to_current(void)
{
    const double km = bench_params.torque_constant_Nm_A;

    TEST_ASSERT_DOUBLE_WITHIN(1e-12, base.voltage_V, km * base.speed_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, base.torque_Nm, km * base.current_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, base.voltage_V, base.resistance_ohm * base.current_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, base.torque_Nm / bench_params.inertia_kgm2,
                              base.acceleration_rad_s2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, base.speed_rad_s * PERIOD_S * 50.0 / TWO_PI,
                              base.turns_per_period);
}

/* A mean acceleration of (1 - e^-y)/y over the period, y = T Kv/J. */
static void test_friction_takes_its_part_of_a_torque_within_the_period(void)
{
    for (int i = 1; i <= 3; i++) {
        struct motor_params sticky = bench_params;
        const double y = 0.1 * i;

        sticky.viscous_friction_Nms_rad = y * sticky.inertia_kgm2 / PERIOD_S;
        const struct motor_model_params m = motor_model_design(&sticky, &base, PERIOD_S, 0.0);

        TEST_ASSERT_DOUBLE_WITHIN(y * y * y / 20.0, (1.0 - exp(-y)) / y,
                                  coef_to_double(m.speed_per_torque) * base.speed_rad_s /
                                      base.acceleration_rad_s2 / PERIOD_S);
    }
}

/* i(t) = u/R (1 - exp(-t R/L)); the steps are exact, so nothing adds up over time but rounding. */
static void test_the_current_of_a_locked_rotor_rises_exponentially(void)
{
    const struct phases voltage = bench_phases(1.0, -0.5, base.voltage_V);
    const struct sincos angle = sincos_of(123456789u);
    struct phases current = {NUM(0.0), NUM(0.0)};

    for (int k = 1; k <= 100; k++) {
        const double rise = 1.0 - exponential(-k * PERIOD_S * 0.37 / 0.9e-3);

        current = predicted(current, voltage, NUM(0.0), angle);
        TEST_ASSERT_NUM_WITHIN(CURRENT_ROUNDING, 1.0 / 0.37 * rise / base.current_A, current.a);
        TEST_ASSERT_NUM_WITHIN(CURRENT_ROUNDING, -0.5 / 0.37 * rise / base.current_A, current.b);
    }
}

/* Taken as linear about the nominal resistance; what that leaves grows with the square. */
static void test_a_calibrated_resistance_gives_the_admittance_of_its_exponential(void)
{
    const double rate = PERIOD_S / 0.9e-3;
    const double nominal_x = rate * 0.37;

    for (double share = 0.25; share < 3.0; share += 0.05) {
        const double r = 0.37 * share;
        const double x = rate * r;
        const double admittance = (1.0 - exponential(-x)) / r;
        const double curvature = (x - nominal_x) * (x - nominal_x) / 6.0 + 3e-6;

        winding_set_resistance(&winding, &model, num_from_double(r / base.resistance_ohm));
        TEST_ASSERT_NUM_WITHIN(rate * base.resistance_ohm * curvature +
                                   4.0 * (NUM_ROUNDING + COEF_ROUNDING),
                               admittance * base.resistance_ohm, winding.admittance);
        TEST_ASSERT_NUM_WITHIN(NUM_ROUNDING, r / base.resistance_ohm, winding.resistance);
    }
}

static void test_a_calibrated_resistance_stays_between_a_quarter_and_three_times_nominal(void)
{
    const double nominal = 0.37 / base.resistance_ohm;

    winding_set_resistance(&winding, &model, NUM(-1.0));
    TEST_ASSERT_NUM_WITHIN(NUM_ROUNDING, 0.25 * nominal, winding.resistance);
    winding_set_resistance(&winding, &model, NUM(5.0));
    TEST_ASSERT_NUM_WITHIN(NUM_ROUNDING, 3.0 * nominal, winding.resistance);
}

/* 0.14 ohm and 6 A on 24 V, with a bridge of 0.22 ohm that the board does not state, warm. */
static void test_a_winding_of_little_resistance_may_be_less_than_its_bridge(void)
{
    struct motor_params motor = bench_params;

    motor.resistance_ohm = 0.14;
    motor.rated_current_A = 6.0;
    base = per_unit_base(&motor, PERIOD_S);
    model = motor_model_design(&motor, &base, PERIOD_S, NO_BRIDGE_OHM);
    winding_set_resistance(&winding, &model, num_from_double(0.48 / base.resistance_ohm));
    TEST_ASSERT_NUM_WITHIN(NUM_ROUNDING, 0.48 / base.resistance_ohm, winding.resistance);
}

static void test_the_bridge_is_part_of_the_resistance(void)
{
    model = motor_model_design(&bench_params, &base, PERIOD_S, 0.05);
    TEST_ASSERT_NUM_WITHIN(NUM_ROUNDING, 0.42 / base.resistance_ohm, model.nominal_resistance);
}

/* Predicted less true current after one period at an imposed speed, in the mid-period frame. */
static struct bench_vector error_at_speed(double speed_rad_s)
{
    struct bench_motor motor = {.motor = bench_params,
                                .i_a = 1.0,
                                .i_b = -0.7,
                                .speed_rad_s = speed_rad_s,
                                .angle_rad = 0.02};
    const double half_turn_rad = 0.5 * 50.0 * speed_rad_s * PERIOD_S;
    const double mid_rad = bench_electrical_rad(&motor) + half_turn_rad;
    const num_t speed = num_from_double(speed_rad_s / base.speed_rad_s);
    const angle_t mid_period = position_from_rad(motor.angle_rad, 50).fraction +
                               (angle_t)angle_from_turns(half_period_turns(&model, speed));
    const struct phases next =
        predicted(bench_phases(motor.i_a, motor.i_b, base.current_A),
                  bench_phases(6.0, -2.0, base.voltage_V), speed, sincos_of(mid_period));

    motor.motor.inertia_kgm2 = IMPOSED_SPEED;
    bench_run(&motor, 6.0, -2.0);
    return bench_to_rotor(num_to_double(next.a) - motor.i_a / base.current_A,
                          num_to_double(next.b) - motor.i_b / base.current_A, mid_rad);
}

/*
 * With h the electrical angle of a period, x = T R/L: the EMF's mean over the period is short by
 * h^2/24, which the model has; that its end counts more than its begin turns it by h x/12, which
 * the model leaves out, being a tenth of a degree at full speed.
 */
static void test_the_current_of_a_turning_rotor_is_that_of_the_motor(void)
{
    static const double speeds[] = {-140.0, -45.0, -2.0, 0.0, 2.0, 45.0, 140.0};
    const double x = PERIOD_S * 0.37 / 0.9e-3;
    const double gain = PERIOD_S / 0.9e-3 * base.resistance_ohm;

    for (unsigned i = 0; i < sizeof speeds / sizeof speeds[0]; i++) {
        const double emf = magnitude(speeds[i]) / base.speed_rad_s;
        const double h = magnitude(speeds[i]) * 50.0 * PERIOD_S;
        const double rounding = CURRENT_ROUNDING + gain * emf * SINE_ERROR;
        const double next_order =
            gain * emf * (h * h * h * h / 1920.0 + h * h * x * x / 240.0 + h * h * x / 24.0 * x);
        const struct bench_vector error = error_at_speed(speeds[i]);

        TEST_ASSERT_DOUBLE_WITHIN(rounding + next_order, 0.0, error.b);
        TEST_ASSERT_DOUBLE_WITHIN(rounding + gain * emf * h * x / 12.0, 0.0, error.a);
    }
}

/* w = t tau/J and theta = t^2/2 tau/J: the trapezoid of the speeds leaves no error but rounding. */
static void test_a_constant_torque_moves_the_rotor_along_a_parabola(void)
{
    const double acceleration = 0.157 * 1.2 / 15.62e-5;
    struct motor_params frictionless = bench_params;
    struct rotor rotor = {.position = {0, 0}};

    frictionless.viscous_friction_Nms_rad = 0.0;
    model = motor_model_design(&frictionless, &base, PERIOD_S, NO_BRIDGE_OHM);
    for (int k = 1; k <= 1000; k++) {
        const double t = k * PERIOD_S;
        const double speed = acceleration * t / base.speed_rad_s;
        const double turns = 0.5 * acceleration * t * t * 50.0 / TWO_PI;
        const double rounding = k * NUM_ROUNDING;

        predict_rotor(&model, &rotor, num_from_double(1.2 / base.current_A));
        TEST_ASSERT_NUM_WITHIN(speed * COEF_ROUNDING + rounding, speed, rotor.speed);
        TEST_ASSERT_DOUBLE_WITHIN(turns * 2.0 * COEF_ROUNDING + k * (rounding + ANGLE_ROUNDING),
                                  turns * TWO_PI / 50.0, position_to_rad(rotor.position, 50));
    }
}

static void test_a_load_that_the_current_carries_leaves_the_rotor_at_rest(void)
{
    struct rotor rotor = {.position = {7, 99}, .load_torque = NUM(0.25)};

    for (int k = 0; k < 100; k++) {
        predict_rotor(&model, &rotor, NUM(0.25));
    }
    TEST_ASSERT_EQUAL_INT32(7, rotor.position.turns);
    TEST_ASSERT_EQUAL_UINT32(99, rotor.position.fraction);
    TEST_ASSERT_NUM_WITHIN(0.0, 0.0, rotor.speed);
    TEST_ASSERT_NUM_WITHIN(0.0, 0.25, rotor.load_torque);
}

static void test_friction_stops_a_coasting_rotor_exponentially(void)
{
    struct rotor rotor = {.speed = NUM(0.5)};
    const double decay = exponential(-0.1 * 0.307e-3 / 15.62e-5);

    for (int k = 0; k < 1000; k++) {
        predict_rotor(&model, &rotor, NUM(0.0));
    }
    /* Euler steps of 2e-4 of the time constant. */
    TEST_ASSERT_NUM_WITHIN(2e-5 + 1000.0 * NUM_ROUNDING + COEF_ROUNDING, 0.5 * decay, rotor.speed);
}

static double turns_between(angle_t from, angle_t to)
{
    return (double)(int32_t)(to - from) / 4294967296.0;
}

static void test_the_rotor_turns_half_its_way_by_the_middle_of_the_period(void)
{
    const double half = 0.5 * 45.0 * PERIOD_S * 50.0 / TWO_PI;
    struct rotor rotor = {.position = {3, 0x80000000u},
                          .speed = num_from_double(45.0 / base.speed_rad_s)};
    const angle_t begin = rotor.position.fraction;
    const angle_t middle =
        begin + (angle_t)angle_from_turns(half_period_turns(&model, rotor.speed));
    const num_t friction = num_mul_coef(rotor.speed, model.friction);

    predict_rotor(&model, &rotor, friction);
    TEST_ASSERT_DOUBLE_WITHIN(half * COEF_ROUNDING + ANGLE_ROUNDING, half,
                              turns_between(begin, middle));
    TEST_ASSERT_DOUBLE_WITHIN(2.0 * ANGLE_ROUNDING, turns_between(begin, middle),
                              0.5 * turns_between(begin, rotor.position.fraction));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_per_unit_makes_back_emf_equal_to_speed_and_torque_equal_to_current);
    RUN_TEST(test_friction_takes_its_part_of_a_torque_within_the_period);
    RUN_TEST(test_the_current_of_a_locked_rotor_rises_exponentially);
    RUN_TEST(test_a_calibrated_resistance_gives_the_admittance_of_its_exponential);
    RUN_TEST(test_a_calibrated_resistance_stays_between_a_quarter_and_three_times_nominal);
    RUN_TEST(test_a_winding_of_little_resistance_may_be_less_than_its_bridge);
    RUN_TEST(test_the_bridge_is_part_of_the_resistance);
    RUN_TEST(test_the_current_of_a_turning_rotor_is_that_of_the_motor);
    RUN_TEST(test_a_constant_torque_moves_the_rotor_along_a_parabola);
    RUN_TEST(test_a_load_that_the_current_carries_leaves_the_rotor_at_rest);
    RUN_TEST(test_friction_stops_a_coasting_rotor_exponentially);
    RUN_TEST(test_the_rotor_turns_half_its_way_by_the_middle_of_the_period);
    return UNITY_END();
}
