/*
 * The rotor found by impulses and by alignment, on a motor whose phases saturate: flux and rotor
 * as in sil/plant/magnetics.h without harmonics and detent, a bridge without dead time.
 */
#include <string.h>

#include "firmware/estimator/initial_position.h"
#include "tests/unit/bench.h"
#include "tests/unit/emulated.h"
#include "tests/unit/num_assert.h"

enum { STEPS = 40 }; /* of a period */

#define DEGREE   (TWO_PI / 360.0)
#define TRIP_A   5.4
#define CODE_A   (12.0 / 4096.0)
#define MAGNET_A 3.46
#define FRICTION 10e-3 /* N m, Coulomb */
#define OFFSET_A 0.009
#define OFFSET_V 0.005

enum { EVERY = EMULATED ? 7 : 1 }; /* of the angles all around */

/* Flux linkages over L0, A: x of i = x + b x^3 - I_f m. */
struct saturable {
    double saturation; /* b, 1/A^2; 0.00095 is a depth of 10 % */
    double x_a, x_b;
    double angle;              /* electrical */
    double magnet_a, magnet_b; /* I_f m there, A */
    double speed;              /* mechanical */
    double inertia_kgm2;
    double friction_Nm;
    double resistance_ohm;
    bool broken_a;   /* an open winding */
    double u_a, u_b; /* means over the past period */
    double furthest; /* largest motion, electrical rad */
    double began;
    double peak_A;
};

static struct per_unit base;
static struct initial_position_params params;
static struct initial_position detection;
static struct saturable motor;
static char error[DESIGN_ERROR_TEXT];
static uint32_t periods;
static double railed_V;                          /* what the sensing of phase a adds */
static enum initial_position_stage railed_since; /* from this stage on */

static double flux_of(double x, double saturation) /* x + b x^3 = its argument */
{
    double y = x;

    double last = x + 1.0;

    for (int i = 0; i < 40 && y != last; i++) {
        last = y;
        y -= (y + saturation * y * y * y - x) / (1.0 + 3.0 * saturation * y * y);
    }
    return y;
}

static double current_a(void)
{
    return motor.x_a + motor.saturation * motor.x_a * motor.x_a * motor.x_a - motor.magnet_a;
}

static double current_b(void)
{
    return motor.x_b + motor.saturation * motor.x_b * motor.x_b * motor.x_b - motor.magnet_b;
}

static void turn_to(double angle_rad)
{
    motor.angle = angle_rad;
    motor.magnet_a = MAGNET_A * cos(angle_rad);
    motor.magnet_b = MAGNET_A * sin(angle_rad);
}

static void place(double angle_rad)
{
    turn_to(angle_rad);
    motor.began = angle_rad;
    motor.x_a = flux_of(motor.magnet_a, motor.saturation);
    motor.x_b = flux_of(motor.magnet_b, motor.saturation);
}

/* With the bridge off the diodes drive the current to zero, and hold it there. */
static double diode_voltage(double current)
{
    return current > 0.0 ? -26.0 : 26.0;
}

static void run_motor(bool on, double u_a, double u_b)
{
    const struct motor_params *p = &bench_params;
    const double dt = PERIOD_S / STEPS;
    const double per_L = dt / p->inductance_H;

    motor.u_a = motor.u_b = 0.0;
    for (int step = 0; step < STEPS; step++) {
        const double i_a = current_a();
        const double i_b = current_b();
        const double v_a = on ? u_a : diode_voltage(i_a);
        const double v_b = on ? u_b : diode_voltage(i_b);
        const double torque = (double)p->rotor_teeth * p->inductance_H *
                              (-motor.x_a * motor.magnet_b + motor.x_b * motor.magnet_a);
        double slowed;

        motor.x_a += per_L * (v_a - motor.resistance_ohm * i_a);
        motor.x_b += per_L * (v_b - motor.resistance_ohm * i_b);
        if (motor.broken_a || (!on && i_a * current_a() <= 0.0)) {
            motor.x_a = flux_of(motor.magnet_a, motor.saturation);
        }
        if (!on && i_b * current_b() <= 0.0) {
            motor.x_b = flux_of(motor.magnet_b, motor.saturation);
        }
        motor.speed += dt * torque / motor.inertia_kgm2;
        slowed = dt * motor.friction_Nm / motor.inertia_kgm2;
        motor.speed =
            fabs(motor.speed) < slowed ? 0.0 : motor.speed - copysign(slowed, motor.speed);
        turn_to(motor.angle + dt * motor.speed * (double)p->rotor_teeth);
        motor.u_a += v_a / STEPS;
        motor.u_b += v_b / STEPS;
        motor.furthest = fmax(motor.furthest, fabs(motor.angle - motor.began));
        motor.peak_A = fmax(motor.peak_A, fmax(fabs(current_a()), fabs(current_b())));
    }
}

static bool design(const struct motor_params *p, double trip_A, enum impulse_order order)
{
    struct motor_model_params model;
    const struct initial_position_task task = {
        .period_s = PERIOD_S,
        .order = order,
        .current_A_per_code = CODE_A,
        .current_range_A = 6.0,
        .overcurrent_trip_A = trip_A,
        .hold_current_A = 1.5,
        .hold_ramp_s = 0.01,
    };

    base = per_unit_base(p, PERIOD_S);
    model = motor_model_design(p, &base, PERIOD_S, 0.0);
    return initial_position_design(&params, &model, p, &base, &task, error);
}

void setUp(void)
{
    motor = (struct saturable){.saturation = 0.00095,
                               .inertia_kgm2 = bench_params.inertia_kgm2,
                               .friction_Nm = FRICTION,
                               .resistance_ohm = bench_params.resistance_ohm};
    railed_V = 0.0;
    railed_since = INITIAL_POSITION_QUIET;
    TEST_ASSERT_TRUE_MESSAGE(design(&bench_params, TRIP_A, IMPULSE_ORDER_PALINDROMIC), error);
}

void tearDown(void)
{
}

/* Whole codes of the converter. */
static double sampled(double current_A)
{
    return CODE_A * floor(current_A / CODE_A + 0.5);
}

/* Until it is found, or not. What is returned at S(k) acts from S(k+1) on, but off at once. */
static void find(double final_rad)
{
    struct initial_position_output now = {.bridge_on = false};
    struct initial_position_output next;
    bool was_on = false;

    initial_position_start(&detection, &params,
                           (angle_t)(int64_t)(final_rad / TWO_PI * 4294967296.0));
    for (periods = 0; !initial_position_done(&detection); periods++) {
        const double offset_A = was_on ? OFFSET_A : 0.0;
        const double offset_V = was_on ? OFFSET_V : 0.0;
        const double rail_V = detection.stage >= railed_since ? railed_V : 0.0;

        next = initial_position_step(
            &detection, &params,
            bench_phases(sampled(current_a() + offset_A), sampled(current_b() - offset_A),
                         base.current_A),
            bench_phases(motor.u_a + offset_V + rail_V, motor.u_b + offset_V, base.voltage_V));
        was_on = now.bridge_on && next.bridge_on;
        run_motor(was_on, num_to_double(now.voltage.a) * base.voltage_V,
                  num_to_double(now.voltage.b) * base.voltage_V);
        now = next;
        TEST_ASSERT_TRUE_MESSAGE(periods < 20000u, "it never ends");
    }
}

static double error_degrees(void)
{
    return remainder((double)detection.angle / 4294967296.0 * TWO_PI - motor.angle, TWO_PI) /
           DEGREE;
}

static void is_found_by_impulses(void)
{
    TEST_ASSERT_EQUAL(INITIAL_POSITION_FOUND, detection.stage);
    TEST_ASSERT_TRUE(detection.by_impulses);
}

static double confidence(void)
{
    return num_to_double(detection.asymmetry) / num_to_double(detection.uncertainty);
}

/* ---- impulses ---- */

static void test_impulses_find_the_rotor_all_around_and_leave_it_where_it_was(void)
{
    for (int step = 0; step < 24; step += EVERY) {
        setUp();
        place((15.0 * step + 4.0) * DEGREE);
        find(0.0);
        is_found_by_impulses();
        TEST_ASSERT_DOUBLE_WITHIN(3.0, 0.0, error_degrees());
        TEST_ASSERT_DOUBLE_WITHIN(1.0, 0.0, (motor.angle - motor.began) / DEGREE);
        TEST_ASSERT_TRUE(motor.furthest < 2.0 * DEGREE);
        TEST_ASSERT_TRUE(confidence() > 12.0);
    }
}

/* 6 beta L0 I_f Delta^2 of the header; with b = beta L0^3 and Delta = L0 i. */
static void test_the_asymmetry_is_what_saturation_makes(void)
{
    double peak;

    place(0.0);
    motor.inertia_kgm2 = IMPOSED_SPEED;
    find(0.0);
    is_found_by_impulses();
    peak = 0.7 * TRIP_A;
    TEST_ASSERT_DOUBLE_WITHIN(0.15, 1.0,
                              num_to_double(detection.asymmetry) * base.current_A / 8.0 /
                                  (3.0 * motor.saturation * MAGNET_A * peak * peak));
}

/* As impulses of the full response would have shown it: 1/(1 + e)^2 of what these have. */
static void test_the_full_asymmetry_is_that_of_the_response_designed_for(void)
{
    static const double excess[] = {-0.1, 0.0, 0.1, 0.19};

    for (int i = 0; i < 4; i++) {
        const num_t response =
            num_from_double((1.0 + excess[i]) / coef_to_double(params.per_response));

        detection.asymmetry = NUM(0.1);
        detection.response = (struct phases){response, response};
        TEST_ASSERT_NUM_WITHIN(2.5e-3, 0.1 / (1.0 + excess[i]) / (1.0 + excess[i]),
                               initial_position_full_asymmetry(&detection, &params));
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.15, 1.0 / coef_to_double(params.per_response),
                              2.0 * num_to_double(params.response_min));
    TEST_ASSERT_TRUE(params.response_max > params.response_min);
}

/* The times at 10 kHz, the bounds as shares, and what the motor's data say of flux. */
static void test_the_design_in_figures(void)
{
    const double magnet_Vs = bench_params.torque_constant_Nm_A / bench_params.rotor_teeth;

    TEST_ASSERT_EQUAL_UINT32(4, params.quiet_begin);
    TEST_ASSERT_EQUAL_UINT32(64, params.quiet_periods);
    TEST_ASSERT_EQUAL_UINT32(250, params.quarter_periods);
    TEST_ASSERT_EQUAL_UINT32(0x40000000u / 250u, params.quarter_step);
    TEST_ASSERT_EQUAL_UINT32(400, params.rest_periods);
    TEST_ASSERT_EQUAL_UINT32(1, params.lag);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 25.0, coef_to_double(params.certainty));
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.02, params.quiet_voltage_max);
    TEST_ASSERT_NUM_WITHIN(1e-5, 0.01 * 0.7 * TRIP_A / base.current_A, params.quiet_max);
    TEST_ASSERT_DOUBLE_WITHIN(
        1e-3, 3.2, num_to_double(params.response_max) / num_to_double(params.response_min));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, base.voltage_V * PERIOD_S / magnet_Vs,
                              coef_to_double(params.flux));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, bench_params.inductance_H * base.current_A / magnet_Vs,
                              coef_to_double(params.flux_per_current));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1.0 / 64.0,
                              num_to_double(num_mul_unit(NUM(1.0), params.per_quiet_period)));
}

static void test_no_impulse_reaches_the_overcurrent_trip(void)
{
    for (int step = 0; step < 8; step += EVERY) {
        setUp();
        motor.saturation = 0.00095 * 3.0;
        place(45.0 * step * DEGREE);
        find(0.0);
        is_found_by_impulses();
        TEST_ASSERT_TRUE(motor.peak_A > 0.6 * TRIP_A);
        TEST_ASSERT_TRUE(motor.peak_A < 0.9 * TRIP_A);
    }
}

static void test_a_lower_trip_makes_smaller_impulses(void)
{
    TEST_ASSERT_TRUE_MESSAGE(design(&bench_params, 2.4, IMPULSE_ORDER_PALINDROMIC), error);
    place(1.0);
    find(0.0);
    is_found_by_impulses();
    TEST_ASSERT_TRUE(motor.peak_A < 0.9 * 2.4);
    TEST_ASSERT_DOUBLE_WITHIN(6.0, 0.0, error_degrees());
}

static void test_wrong_motor_parameters_leave_no_error(void)
{
    struct motor_params wrong = bench_params;

    wrong.inductance_H *= 1.1;
    wrong.resistance_ohm *= 0.5;
    TEST_ASSERT_TRUE_MESSAGE(design(&wrong, TRIP_A, IMPULSE_ORDER_PALINDROMIC), error);
    place(1.0);
    find(0.0);
    is_found_by_impulses();
    TEST_ASSERT_DOUBLE_WITHIN(2.0, 0.0, error_degrees());
}

/* The first impulse of a pair pushes the rotor, most at 45 degrees. */
static void test_the_published_order_errs_where_the_rotor_turns(void)
{
    double palindromic;

    place(2.4);
    find(0.0);
    palindromic = fabs(error_degrees());
    setUp();
    TEST_ASSERT_TRUE_MESSAGE(design(&bench_params, TRIP_A, IMPULSE_ORDER_PUBLISHED), error);
    place(2.4);
    find(0.0);
    is_found_by_impulses();
    TEST_ASSERT_TRUE(fabs(error_degrees()) > palindromic + 1.0);
    TEST_ASSERT_DOUBLE_WITHIN(15.0, 0.0, error_degrees());
    setUp();
    motor.inertia_kgm2 = IMPOSED_SPEED;
    TEST_ASSERT_TRUE_MESSAGE(design(&bench_params, TRIP_A, IMPULSE_ORDER_PUBLISHED), error);
    place(2.4);
    find(0.0);
    TEST_ASSERT_DOUBLE_WITHIN(2.5, 0.0, error_degrees());
}

static void a_rotor_that_turns_is_found_once_it_rests(void)
{
    place(0.5);
    motor.speed = 6.0;
    motor.friction_Nm = 80e-3;
    find(0.0);
    is_found_by_impulses();
    TEST_ASSERT_TRUE(detection.repetitions > 0u);
}

static void test_a_rotor_that_turns_is_waited_for(void)
{
    a_rotor_that_turns_is_found_once_it_rests();
    TEST_ASSERT_DOUBLE_WITHIN(3.5, 0.0, error_degrees());
}

static void test_each_detection_waits_for_the_rotor_as_often_as_the_first(void)
{
    for (int detections = 0; detections < 8; detections++) {
        setUp();
        a_rotor_that_turns_is_found_once_it_rests();
    }
}

static void test_an_open_winding_is_not_taken_for_a_position(void)
{
    motor.broken_a = true;
    place(0.5);
    find(0.0);
    TEST_ASSERT_EQUAL(INITIAL_POSITION_NOT_FOUND, detection.stage);
    TEST_ASSERT_TRUE(periods < 300u);
}

static void test_a_voltage_at_its_rail_while_there_is_none_ends_the_detection(void)
{
    railed_V = 31.0;
    place(0.5);
    find(0.0);
    TEST_ASSERT_EQUAL(INITIAL_POSITION_NOT_FOUND, detection.stage);
    TEST_ASSERT_EQUAL_UINT32(params.quiet_begin + params.quiet_periods, periods);
}

static void test_a_motor_that_no_impulse_can_fill_is_refused(void)
{
    struct motor_params large = bench_params;

    large.inductance_H = 1.0;
    TEST_ASSERT_FALSE(design(&large, TRIP_A, IMPULSE_ORDER_PALINDROMIC));
    TEST_ASSERT_NOT_NULL(strstr(error, "initial position impulse"));
}

/* ---- alignment ---- */

static void is_found_by_alignment(void)
{
    TEST_ASSERT_EQUAL(INITIAL_POSITION_FOUND, detection.stage);
    TEST_ASSERT_FALSE(detection.by_impulses);
}

static void test_without_saturation_the_rotor_is_aligned(void)
{
    for (int step = 0; step < 12; step += EVERY) {
        setUp();
        motor.saturation = 0.0;
        place((30.0 * step + 7.0) * DEGREE);
        find(1.0);
        is_found_by_alignment();
        TEST_ASSERT_TRUE(confidence() < 5.0);
        TEST_ASSERT_DOUBLE_WITHIN(3.0, 0.0, error_degrees());
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0 / TWO_PI, (double)detection.angle / 4294967296.0);
    }
}

/* Exactly opposite, the vector does not pull before it has turned. */
static void test_the_alignment_leaves_the_angle_without_torque(void)
{
    motor.saturation = 0.0;
    place(1.0 + 0.5 * TWO_PI);
    find(1.0);
    is_found_by_alignment();
    TEST_ASSERT_DOUBLE_WITHIN(3.0, 0.0, error_degrees());
}

static void test_the_alignment_bears_a_wrong_resistance(void)
{
    for (int i = 0; i < 2; i++) {
        setUp();
        motor.saturation = 0.0;
        motor.resistance_ohm = bench_params.resistance_ohm * (i == 0 ? 0.5 : 1.5);
        place(2.0);
        find(1.0);
        is_found_by_alignment();
        TEST_ASSERT_DOUBLE_WITHIN(5.5, 0.0, error_degrees());
    }
}

static void test_the_alignment_is_gentle(void)
{
    motor.saturation = 0.0;
    place(2.0);
    find(1.0);
    is_found_by_alignment();
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 1.5 / base.current_A,
                              num_to_double(detection.current_reference));
    TEST_ASSERT_TRUE(fabs(motor.speed) < 0.05);
}

static void test_a_rotor_that_does_not_follow_is_not_found(void)
{
    motor.saturation = 0.0;
    motor.friction_Nm = 1.0;
    place(1.1);
    find(1.0);
    TEST_ASSERT_EQUAL(INITIAL_POSITION_NOT_FOUND, detection.stage);
}

static void test_a_voltage_at_its_rail_while_the_rotor_turns_is_no_flux(void)
{
    motor.saturation = 0.0;
    railed_V = -31.0;
    railed_since = INITIAL_POSITION_OFFSET;
    place(2.0);
    find(1.0);
    TEST_ASSERT_EQUAL(INITIAL_POSITION_NOT_FOUND, detection.stage);
    TEST_ASSERT_TRUE(num_to_double(num_abs(detection.flux.a)) <= 8.0);
    TEST_ASSERT_TRUE(num_to_double(num_abs(detection.resistance)) <= 8.0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_impulses_find_the_rotor_all_around_and_leave_it_where_it_was);
    RUN_TEST(test_the_asymmetry_is_what_saturation_makes);
    RUN_TEST(test_the_design_in_figures);
    RUN_TEST(test_the_full_asymmetry_is_that_of_the_response_designed_for);
    RUN_TEST(test_no_impulse_reaches_the_overcurrent_trip);
    RUN_TEST(test_a_lower_trip_makes_smaller_impulses);
    RUN_TEST(test_wrong_motor_parameters_leave_no_error);
    RUN_TEST(test_the_published_order_errs_where_the_rotor_turns);
    RUN_TEST(test_a_rotor_that_turns_is_waited_for);
    RUN_TEST(test_each_detection_waits_for_the_rotor_as_often_as_the_first);
    RUN_TEST(test_an_open_winding_is_not_taken_for_a_position);
    RUN_TEST(test_a_voltage_at_its_rail_while_there_is_none_ends_the_detection);
    RUN_TEST(test_a_motor_that_no_impulse_can_fill_is_refused);
    RUN_TEST(test_without_saturation_the_rotor_is_aligned);
    RUN_TEST(test_the_alignment_leaves_the_angle_without_torque);
    RUN_TEST(test_the_alignment_bears_a_wrong_resistance);
    RUN_TEST(test_the_alignment_is_gentle);
    RUN_TEST(test_a_rotor_that_does_not_follow_is_not_found);
    RUN_TEST(test_a_voltage_at_its_rail_while_the_rotor_turns_is_no_flux);
    return UNITY_END();
}
