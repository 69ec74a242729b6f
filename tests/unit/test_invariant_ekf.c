/* The default estimator on the simulated motor: no noise, what remains is the estimator's own. */
#include "firmware/estimator/invariant_ekf_step.h"
#include "tests/unit/bench.h"
#include "tests/unit/emulated.h"
#include "tests/unit/num_assert.h"

#define HOLD_A 1.5

enum { EVERY = EMULATED ? 3 : 1 }; /* of many speeds or frequencies */

static struct per_unit base;
static struct motor_model_params model;
static struct invariant_ekf_gains moving;
static struct invariant_ekf_hold_gains holding;
static struct invariant_ekf_params params;
static struct invariant_ekf ekf;
static struct bench_motor motor;

static void start_at(double angle_rad, double assumed_rad)
{
    motor = (struct bench_motor){.motor = bench_params, .angle_rad = angle_rad};
    invariant_ekf_reset(&ekf, &params, position_from_rad(assumed_rad, 50), model.nominal_resistance,
                        0);
}

void setUp(void)
{
    static bool designed = false;

    if (!designed) {
        char error[DESIGN_ERROR_TEXT];

        base = per_unit_base(&bench_params, PERIOD_S);
        model = motor_model_design(&bench_params, &base, PERIOD_S, 0.0);
        TEST_ASSERT_TRUE(invariant_ekf_motion_design(&bench_params, PERIOD_S, &moving, error));
        TEST_ASSERT_TRUE(
            invariant_ekf_hold_design(&bench_params, PERIOD_S, HOLD_A, &holding, error));
        invariant_ekf_find_angle_in_step(&moving, &holding);
        params = invariant_ekf_scale(&model, &base, &moving, &holding);
        designed = true;
    }
    start_at(0.0, 0.0);
}

void tearDown(void)
{
}

static double electrical_deg(double mechanical_rad)
{
    return mechanical_rad * 50.0 * 360.0 / TWO_PI;
}

static double angle_error_electrical_deg(void)
{
    return electrical_deg(motor.angle_rad - position_to_rad(ekf.estimate.rotor.position, 50));
}

static double estimated_speed_rad_s(void)
{
    return num_to_double(ekf.estimate.rotor.speed) * base.speed_rad_s;
}

static double estimated_load_Nm(void)
{
    return num_to_double(ekf.estimate.rotor.load_torque) * base.torque_Nm;
}

static double estimated_resistance_ohm(void)
{
    return num_to_double(ekf.estimate.winding.resistance) * base.resistance_ohm;
}

static angle_t hold_angle; /* electrical, of the frame of the hold's current */

/* As in the drive: in a hold the resistance moves in every fourth period. */
#define ADAPTING_PERIODS 4u
static uint32_t periods_held;

static void correct(struct bench_vector current, struct phases surprise, bool in_hold)
{
    const struct sincos hold_frame = sincos_of(hold_angle);
    const struct estimator_input input = {
        .winding.current = bench_phases(current.a, current.b, base.current_A),
        .surprise = surprise,
        .hold = {in_hold, &hold_frame},
    };

    (void)invariant_ekf_observe(&ekf, &params, &input);
    if (in_hold && ++periods_held % ADAPTING_PERIODS == 0u) {
        invariant_ekf_work_on_hold(&ekf, &params, false);
    }
}

/* Under a voltage that is as it was expected. */
static void step(struct bench_vector voltage, struct bench_vector current, bool in_hold)
{
    static const struct phases none = {NUM(0.0), NUM(0.0)};

    (void)invariant_ekf_look_ahead(&ekf, &params,
                                   bench_phases(voltage.a, voltage.b, base.voltage_V));
    correct(current, none, in_hold);
}

/* Once a block of the synchronism monitor. */
static void watch_hold(void)
{
    invariant_ekf_watch_hold(&ekf, &params, false);
    invariant_ekf_settle_bias(&ekf, &params);
}

static void period(struct bench_vector voltage, bool in_hold)
{
    bench_run(&motor, voltage.a, voltage.b);
    step(voltage, (struct bench_vector){motor.i_a, motor.i_b}, in_hold);
}

static void turn(double speed_rad_s, int periods)
{
    for (int k = 0; k < periods; k++) {
        period(bench_regulate(&motor, 0.0, bench_speed_current(&motor, speed_rad_s)), false);
    }
}

/* i_d in a frame fixed at angle 0, as the drive holds a reference of 0. */
static void hold_at(double i_d, double i_q, int periods)
{
    for (int k = 0; k < periods; k++) {
        const double stiffness = 0.3 * motor.motor.inductance_H / PERIOD_S;
        const struct bench_vector voltage = {
            motor.motor.resistance_ohm * motor.i_a + stiffness * (i_d - motor.i_a),
            motor.motor.resistance_ohm * motor.i_b + stiffness * (i_q - motor.i_b)};

        period(voltage, true);
    }
}

static void hold(double i_q, int periods)
{
    hold_at(HOLD_A, i_q, periods);
}

/* The state of the header's equations, SI. */
struct state {
    double i_a, i_b, speed, angle, load, settled, bias_a, bias_b, resistance;
};

static struct state predicted(struct state x, struct bench_vector u)
{
    const struct motor_params *m = &bench_params;
    const double h = 50.0 * PERIOD_S * x.speed;
    const double mid = 50.0 * x.angle + 0.5 * h;
    const double b = (1.0 - exp(-PERIOD_S * x.resistance / m->inductance_H)) / x.resistance;
    const double emf = m->torque_constant_Nm_A * x.speed * (1.0 - h * h / 24.0);
    const struct bench_vector lost = bench_to_phases(0.0, emf, mid);
    struct state y = x;
    double i_q;

    y.i_a += b * (u.a - x.bias_a - lost.a - x.resistance * x.i_a);
    y.i_b += b * (u.b - x.bias_b - lost.b - x.resistance * x.i_b);
    i_q = bench_to_rotor(0.5 * (x.i_a + y.i_a), 0.5 * (x.i_b + y.i_b), mid).b;
    y.speed += PERIOD_S / m->inertia_kgm2 *
               (m->torque_constant_Nm_A * i_q - m->viscous_friction_Nms_rad * x.speed - x.load);
    y.angle += 0.5 * PERIOD_S * (x.speed + y.speed);
    return y;
}

/* `hold_rad`: electrical angle of the hold's frame, NULL in motion. */
static struct state corrected(struct state x, struct state y, const struct invariant_ekf_gains *k,
                              struct bench_vector i, const double *hold_rad)
{
    const double h = 50.0 * PERIOD_S * x.speed;
    const struct bench_vector nu = bench_to_rotor(i.a - y.i_a, i.b - y.i_b, 50.0 * x.angle + h);
    const double direction = fmin(fmax(y.speed / k->angle_d_full_speed_rad_s, -1.0), 1.0);
    const double odd = hold_rad == NULL ? k->k_angle_d_rad_A * direction * nu.a : 0.0;
    const double k_current = 0.5 * (k->k_current_d + k->k_current_q);
    const double away = x.load - x.settled;
    const struct bench_vector bias = bench_to_phases(
        0.0,
        k->k_bias_d_V_A * direction * nu.a + k->k_bias_q_V_A * nu.b - k->bias_return_V_Nm * away,
        hold_rad != NULL ? *hold_rad : 50.0 * x.angle + h);

    y.i_a += k_current * (i.a - y.i_a);
    y.i_b += k_current * (i.b - y.i_b);
    y.angle += odd + k->k_angle_q_rad_A * nu.b + k->angle_return_rad_Nm * away;
    y.speed += k->k_speed_q_rad_As * nu.b;
    y.load += k->k_load_q_Nm_A * nu.b - k->load_return * away;
    y.bias_a += bias.a;
    y.bias_b += bias.b;
    return y;
}

/* What a hold that has corrected x predicted by y, and looked ahead without voltage, has for the
   resistance, had nu_d been the same in `periods`. */
static double adapted_resistance(struct state x, struct state y,
                                 const struct invariant_ekf_gains *k, struct bench_vector i,
                                 int periods)
{
    static const struct bench_vector none = {0.0, 0.0};
    const double turned = 50.0 * x.angle + 50.0 * PERIOD_S * x.speed;
    const double nu_d = bench_to_rotor(i.a - y.i_a, i.b - y.i_b, turned).a;
    const struct state now = corrected(x, y, k, i, NULL);
    const struct state next = predicted(now, none);
    const double i_d =
        bench_to_rotor(next.i_a, next.i_b, 50.0 * (now.angle + PERIOD_S * now.speed)).a;

    return y.resistance + k->k_resistance_ohm_A2 * i_d * nu_d * periods;
}

static void set(struct state x)
{
    struct estimate *estimate = &ekf.estimate;

    invariant_ekf_reset(&ekf, &params, position_from_rad(x.angle, 50),
                        num_from_double(x.resistance / base.resistance_ohm), 0);
    estimate->current = bench_phases(x.i_a, x.i_b, base.current_A);
    estimate->rotor.speed = num_from_double(x.speed / base.speed_rad_s);
    estimate->rotor.load_torque = num_from_double(x.load / base.torque_Nm);
    ekf.settled_load = num_from_double(x.settled / base.torque_Nm);
    ekf.bias = bench_phases(x.bias_a, x.bias_b, base.voltage_V);
    ekf.settled_bias = ekf.bias;
}

static void is_state(struct state x)
{
    const struct estimate *estimate = &ekf.estimate;
    /* 1e-4: the admittance is linear about the nominal resistance. */
    const double rounding = 1e-4 + 20.0 * (NUM_ROUNDING + COEF_ROUNDING) + 4.0 * SINE_ERROR;

    TEST_ASSERT_NUM_WITHIN(rounding, x.i_a / base.current_A, estimate->current.a);
    TEST_ASSERT_NUM_WITHIN(rounding, x.i_b / base.current_A, estimate->current.b);
    TEST_ASSERT_NUM_WITHIN(rounding, x.speed / base.speed_rad_s, estimate->rotor.speed);
    TEST_ASSERT_NUM_WITHIN(rounding, x.load / base.torque_Nm, estimate->rotor.load_torque);
    TEST_ASSERT_NUM_WITHIN(0.02 * rounding + 4.0 * NUM_ROUNDING, x.bias_a / base.voltage_V,
                           ekf.bias.a);
    TEST_ASSERT_NUM_WITHIN(0.02 * rounding + 4.0 * NUM_ROUNDING, x.bias_b / base.voltage_V,
                           ekf.bias.b);
    TEST_ASSERT_NUM_WITHIN(0.02 * rounding, x.resistance / base.resistance_ohm,
                           estimate->winding.resistance);
    TEST_ASSERT_DOUBLE_WITHIN(rounding * base.rad_per_turn, x.angle,
                              position_to_rad(estimate->rotor.position, 50));
}

static void test_a_step_is_that_of_the_equations_in_motion_and_in_hold(void)
{
    static const struct state starts[] = {
        {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.37},
        {0.8, -0.5, 45.0, 0.02, 0.05, 0.05, 0.0, 0.0, 0.37},
        {-0.4, 1.2, -30.0, -0.7, -0.1, -0.09, 0.02, 0.0, 0.5},
        {1.4, 0.3, 0.4, 3.3, 0.1, 0.11, 0.1, -0.05, 0.3},
        {-1.2, 0.9, -0.6, 1.02, -0.2, -0.1, -0.2, 0.1, 0.45}, /* a load step */
    };
    static const struct bench_vector voltage = {3.0, -2.0};
    static const struct bench_vector current = {0.95, -0.4};
    static const double hold_rad = TWO_PI / 16.0;

    hold_angle = 0x10000000u; /* a sixteenth turn */
    for (unsigned i = 0; i < sizeof starts / sizeof starts[0]; i++) {
        const struct state x = starts[i];
        const bool load_step = fabs(x.load - x.settled) > holding.load_step_Nm;

        periods_held = 0u;
        set(x);
        step(voltage, current, true);
        is_state(corrected(x, predicted(x, voltage),
                           load_step ? &holding.following : &holding.quiet, current, &hold_rad));

        set(x);
        step(voltage, current, false);
        is_state(corrected(x, predicted(x, voltage), &moving, current, NULL));
    }
    hold_angle = 0u;
}

static double resistance_after(struct state start, int sums, bool leads)
{
    static const struct bench_vector voltage = {3.0, -2.0};
    static const struct bench_vector current = {0.95, -0.4};
    num_t nu_d;

    periods_held = 0u;
    set(start);
    step(voltage, current, true);
    nu_d = ekf.innovation_sum;
    for (int k = 1; k < sums; k++) {
        ekf.innovation_sum += nu_d;
    }
    ekf.adapted_at = park(ekf.estimate.next.current, ekf.estimate.next.frame).d;
    invariant_ekf_work_on_hold(&ekf, &params, leads);
    TEST_ASSERT_TRUE(ekf.innovation_sum == NUM(0.0));
    return estimated_resistance_ohm();
}

/* As much as if it had moved in each of the periods. */
static void test_the_resistance_moves_by_all_innovations_since_it_moved_last(void)
{
    static const struct state start = {1.4, 0.3, 0.4, 3.3, 0.1, 0.11, 0.0, 0.0, 0.37};
    static const struct bench_vector voltage = {3.0, -2.0};
    static const struct bench_vector current = {0.95, -0.4};

    for (int periods = 1; periods <= 4; periods++) {
        const double expected =
            adapted_resistance(start, predicted(start, voltage), &holding.quiet, current, periods);

        TEST_ASSERT_TRUE(fabs(expected - start.resistance) > 1e-4);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * fabs(expected - start.resistance) + 1e-5, expected,
                                  resistance_after(start, periods, false));
    }
}

static void test_a_hold_that_leads_its_rotor_leaves_the_resistance_alone(void)
{
    static const struct state start = {1.4, 0.3, 0.4, 3.3, 0.1, 0.11, 0.0, 0.0, 0.37};

    TEST_ASSERT_DOUBLE_WITHIN(1e-6, start.resistance, resistance_after(start, 4, true));
}

/* What a swing up makes of the resistance the swing down takes back. */
static void test_a_current_that_swings_is_no_resistance_whatever_the_inductance(void)
{
    static const double scales[] = {0.75, 0.8, 1.25};

    for (unsigned i = 0; i < sizeof scales / sizeof scales[0]; i++) {
        start_at(0.0, 0.0);
        motor.motor.inductance_H *= scales[i];
        hold(0.0, 1500);
        const double before = estimated_resistance_ohm();

        for (int swing = 0; swing < 24; swing++) {
            hold_at(swing % 2 == 0 ? 1.25 * HOLD_A : 0.75 * HOLD_A, 0.0, 22);
        }
        hold(0.0, 22);
        TEST_ASSERT_DOUBLE_WITHIN(0.003 * before, before, estimated_resistance_ohm());
    }
}

/* Of a hold only those that the resistance has taken; the others come with the next block. */
static void test_each_innovation_is_taken_once_by_the_monitor(void)
{
    ekf.innovation_sum = NUM(0.25);
    invariant_ekf_work_on_hold(&ekf, &params, false);
    ekf.innovation_sum = NUM(0.125);
    TEST_ASSERT_TRUE(invariant_ekf_take_innovation_sum(&ekf, true) == NUM(0.25));
    TEST_ASSERT_TRUE(invariant_ekf_take_innovation_sum(&ekf, true) == NUM(0.0));
    TEST_ASSERT_TRUE(invariant_ekf_take_innovation_sum(&ekf, false) == NUM(0.125));
    TEST_ASSERT_TRUE(invariant_ekf_take_innovation_sum(&ekf, false) == NUM(0.0));
}

/* The surprise moves the predicted current; what it does to the rotor in a period is left out. */
static void test_a_voltage_that_was_another_than_expected_is_made_up_for(void)
{
    static const struct state start = {0.8, -0.5, 45.0, 0.02, 0.05, 0.05, 0.0, 0.0, 0.37};
    static const struct bench_vector expected = {3.0, -2.0}, voltage = {3.4, -1.5};
    static const struct bench_vector current = {0.95, -0.4};
    const struct estimate *x = &ekf.estimate;
    struct phases right;

    set(start);
    step(voltage, current, false);
    right = x->current;
    set(start);
    (void)invariant_ekf_look_ahead(&ekf, &params,
                                   bench_phases(expected.a, expected.b, base.voltage_V));
    correct(current, bench_phases(voltage.a - expected.a, voltage.b - expected.b, base.voltage_V),
            false);
    TEST_ASSERT_NUM_WITHIN(4.0 * NUM_ROUNDING + COEF_ROUNDING, num_to_double(right.a),
                           x->current.a);
    TEST_ASSERT_NUM_WITHIN(4.0 * NUM_ROUNDING + COEF_ROUNDING, num_to_double(right.b),
                           x->current.b);
}

static void test_a_right_start_is_tracked_from_rest_through_an_acceleration(void)
{
    for (int k = 0; k < 40; k++) {
        turn(45.0, 10);
        TEST_ASSERT_DOUBLE_WITHIN(0.4, 0.0, angle_error_electrical_deg());
        TEST_ASSERT_DOUBLE_WITHIN(0.3, motor.speed_rad_s, estimated_speed_rad_s());
    }
}

static void test_the_estimate_locks_from_thirty_electrical_degrees_either_way(void)
{
    const double off = 30.0 / 360.0 * TWO_PI / 50.0;
    static const double speeds[] = {45.0, -45.0};

    for (unsigned i = 0; i < 2u; i++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            start_at(0.0, sign * off);
            TEST_ASSERT_DOUBLE_WITHIN(1.0, -30.0 * sign, angle_error_electrical_deg());
            turn(speeds[i], 400);
            TEST_ASSERT_DOUBLE_WITHIN(1.0, 0.0, angle_error_electrical_deg());
            TEST_ASSERT_EQUAL_INT32(position_from_rad(motor.angle_rad, 50).turns,
                                    ekf.estimate.rotor.position.turns);
        }
    }
}

static void test_steady_rotation_is_tracked_both_ways(void)
{
    static const double speeds[] = {45.0, -45.0, 2.0, -2.0, 120.0, -120.0};

    for (unsigned i = 0; i < sizeof speeds / sizeof speeds[0]; i++) {
        start_at(0.0, 0.0);
        turn(speeds[i], 1500);
        TEST_ASSERT_DOUBLE_WITHIN(0.2, 0.0, angle_error_electrical_deg());
        TEST_ASSERT_DOUBLE_WITHIN(0.05, motor.speed_rad_s, estimated_speed_rad_s());
        TEST_ASSERT_DOUBLE_WITHIN(0.3, speeds[i], motor.speed_rad_s);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.0, estimated_load_Nm());
    }
}

static void test_a_reversal_through_rest_keeps_the_lock(void)
{
    turn(45.0, 500);
    for (int k = 0; k < 100; k++) {
        turn(-45.0, 10);
        TEST_ASSERT_DOUBLE_WITHIN(1.0, 0.0, angle_error_electrical_deg());
    }
}

static void test_a_load_of_a_tenth_Nm_is_estimated_within_ten_milliseconds(void)
{
    turn(45.0, 500);
    motor.load_torque_Nm = 0.1;
    turn(45.0, 100);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.1, estimated_load_Nm());
    turn(45.0, 200);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.1, estimated_load_Nm());
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 0.0, angle_error_electrical_deg());
}

/* Seen in a mirror (a the mirror's plane) the motor turns the other way; so must the estimate. */
static void test_the_estimator_knows_no_preferred_direction(void)
{
    double speed[2];
    double load[2];
    double error[2];

    for (int i = 0; i < 2; i++) {
        const double sign = i == 0 ? 1.0 : -1.0;

        start_at(0.0, sign * 0.005);
        turn(sign * 30.0, 100);
        motor.load_torque_Nm = sign * 0.1;
        turn(sign * 30.0, 100);
        speed[i] = estimated_speed_rad_s();
        load[i] = estimated_load_Nm();
        error[i] = angle_error_electrical_deg();
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.02, -speed[0], speed[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, -load[0], load[1]);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, -error[0], error[1]);
}

/* In motion an EMF error is an angle error, not a resistance. */
static void test_in_motion_the_resistance_is_left_alone(void)
{
    motor.motor.resistance_ohm = 0.45;
    turn(45.0, 300);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.37, estimated_resistance_ohm());
    turn(0.0, 300);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.37, estimated_resistance_ohm());
}

/* What the voltage measurement shows too much. */
static void offset_period(double regulated_speed_rad_s, struct bench_vector offset, bool in_hold)
{
    const double stiffness = 0.3 * motor.motor.inductance_H / PERIOD_S;
    const struct bench_vector held = {
        motor.motor.resistance_ohm * motor.i_a + stiffness * (HOLD_A - motor.i_a),
        motor.motor.resistance_ohm * motor.i_b + stiffness * (0.0 - motor.i_b)};
    const struct bench_vector u =
        in_hold ? held
                : bench_regulate(&motor, 0.0, bench_speed_current(&motor, regulated_speed_rad_s));

    bench_run(&motor, u.a, u.b);
    step((struct bench_vector){u.a + offset.a, u.b + offset.b},
         (struct bench_vector){motor.i_a, motor.i_b}, in_hold);
}

static void test_a_voltage_offset_is_found_in_motion_at_every_speed(void)
{
    static const double speeds[] = {1.0, -1.0, 5.0, -30.0, 100.0};
    const struct bench_vector offset = {0.02, -0.01};

    for (unsigned i = 0; i < sizeof speeds / sizeof speeds[0]; i += EVERY) {
        start_at(0.0, 0.0);
        for (int k = 0; k < 20000; k++) {
            offset_period(speeds[i], offset, false);
        }
        TEST_ASSERT_DOUBLE_WITHIN(1.5e-3, offset.a, num_to_double(ekf.bias.a) * base.voltage_V);
        TEST_ASSERT_DOUBLE_WITHIN(1.5e-3, offset.b, num_to_double(ekf.bias.b) * base.voltage_V);
    }
}

/* Across the current; along it an offset and a resistance are the same. */
static void test_a_voltage_offset_across_the_current_is_found_in_hold(void)
{
    const struct bench_vector offset = {0.0, 0.02};

    ekf.unloaded_periods = UINT32_MAX;
    for (int k = 0; k < 10000; k++) {
        offset_period(0.0, offset, true);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, offset.b, num_to_double(ekf.bias.b) * base.voltage_V);
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0.0, estimated_load_Nm());
}

static void test_a_hold_of_150_ms_calibrates_the_resistance_from_half_to_one_and_a_half(void)
{
    static const double shares[] = {0.5, 0.75, 1.0, 1.25, 1.5};

    for (unsigned i = 0; i < sizeof shares / sizeof shares[0]; i++) {
        start_at(0.0, 0.0);
        motor.motor.resistance_ohm = shares[i] * 0.37;
        hold(0.0, 1500);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * motor.motor.resistance_ohm, motor.motor.resistance_ohm,
                                  estimated_resistance_ohm());
        TEST_ASSERT_DOUBLE_WITHIN(0.1, 0.0, angle_error_electrical_deg());
    }
}

/*
 * Left to the d current alone, 0.05 N m would turn the rotor by asin(T_L / (Km i_d)) = 12.3
 * degrees. With the q current of the drive's hold, T_L/Km - 2 K_w w, it goes half as far.
 */
static void test_a_load_step_in_hold_is_followed_before_the_rotor_has_turned_far(void)
{
    static const double loads[] = {0.05, -0.05};

    for (unsigned i = 0; i < 2u; i++) {
        start_at(0.0, 0.0);
        hold(0.0, 1000);
        motor.load_torque_Nm = loads[i];
        for (int k = 1; k <= 500; k++) {
            hold(estimated_load_Nm() / 0.157 - 2.0 * 0.39 * estimated_speed_rad_s(), 1);
            TEST_ASSERT_DOUBLE_WITHIN(0.5 * 12.3, 0.0, electrical_deg(motor.angle_rad));
            if (k == 60) {
                TEST_ASSERT_DOUBLE_WITHIN(0.2 * 0.05, loads[i], estimated_load_Nm());
            }
        }
        TEST_ASSERT_EQUAL_UINT32(0, ekf.following_periods); /* and is over */
    }
}

/*
 * 15 % of the rated torque, of the hold's twice as much, for 2 s. The first half-cycles look like
 * steps of the load; to follow all of them would pull the rotor out. A correction of the offset
 * that swings with the rotor would add up along the current, and turn the resistance away.
 */
static void test_a_load_that_vibrates_is_no_load_and_no_resistance(void)
{
    static const double frequencies_Hz[] = {60.0, 50.0, 20.0}, amplitude_Nm = 0.07;

    for (unsigned i = 0; i < 3u; i += EVERY) {
        start_at(0.0, 0.0);
        hold(0.0, 1000);
        for (int k = 0; k < 20000; k++) {
            motor.load_torque_Nm = amplitude_Nm * sin(TWO_PI * frequencies_Hz[i] * k * PERIOD_S);
            hold(estimated_load_Nm() / 0.157 - 2.0 * 0.39 * estimated_speed_rad_s(), 1);
            if (k % 16 == 0) {
                watch_hold();
            }
        }
        TEST_ASSERT_DOUBLE_WITHIN(2.0 * amplitude_Nm, 0.0,
                                  num_to_double(ekf.settled_load) * base.torque_Nm);
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * 0.37, 0.37, estimated_resistance_ohm());
        TEST_ASSERT_DOUBLE_WITHIN(5e-3, 0.0, num_to_double(ekf.bias.a) * base.voltage_V);
    }
}

/* By how much, electrical turns. */
static double found_in_step(double speed, num_t nu_d)
{
    start_at(0.0, 0.0);
    ekf.following_periods = params.rest_periods + 1u;
    ekf.innovation_sum = nu_d;
    ekf.estimate.next.position = position_from_rad(0.0, 50);
    ekf.estimate.next.speed = num_from_double(speed);
    invariant_ekf_work_on_hold(&ekf, &params, false);
    return position_to_rad(ekf.estimate.next.position, 50) * 50.0 / TWO_PI;
}

static void test_behind_its_estimate_a_rotor_is_found_half_as_fast_as_ahead_of_it(void)
{
    for (int way = -1; way <= 1; way += 2) {
        const double ahead = found_in_step(way * 0.01, NUM(0.01));
        const double behind = found_in_step(way * 0.01, -NUM(0.01));

        TEST_ASSERT_TRUE(ahead * way > 1e-3);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, -0.5 * ahead, behind);
    }
    ekf.following_periods = params.rest_periods; /* the step is over */
    ekf.innovation_sum = NUM(0.01);
    const struct position before = ekf.estimate.next.position;

    invariant_ekf_work_on_hold(&ekf, &params, false);
    TEST_ASSERT_EQUAL_UINT32(before.fraction, ekf.estimate.next.position.fraction);
}

/* Without motion nothing may drift: a minute of hold is 600,000 such periods. */
static void test_a_settled_hold_stays_where_it_is(void)
{
    hold(0.0, 3000);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.0, angle_error_electrical_deg());
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.0, estimated_load_Nm());
    TEST_ASSERT_EQUAL_UINT32(0, ekf.following_periods);
}

/*
 * What load and angle have drifted together, in balance: x' = -x/T + y, y' = -x/(2.8 T)^2 with T =
 * 3/w_h, and y the rate that the offset learned meanwhile makes; after 10 ms x is 0.371 of what it
 * was.
 */
static void test_a_settled_hold_returns_to_its_load_with_the_angle(void)
{
    const double stiffness_Nm_rad = 50.0 * 0.157 * HOLD_A;
    const double away_Nm = 0.02;

    hold(0.0, 500);
    ekf.estimate.rotor.load_torque += num_from_double(away_Nm / base.torque_Nm);
    ekf.estimate.rotor.position = position_from_rad(-away_Nm / stiffness_Nm_rad, 50);
    hold(0.0, 100);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * away_Nm, 0.371 * away_Nm, estimated_load_Nm());
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.371 * electrical_deg(away_Nm / stiffness_Nm_rad),
                              angle_error_electrical_deg());
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, -0.157 * 6.88 * away_Nm / stiffness_Nm_rad,
                              num_to_double(ekf.bias.b) * base.voltage_V);
}

/* 60 mV that come at once are taken for a load step, but where no load is expected. */
static void test_in_an_unloaded_hold_an_offset_is_no_load(void)
{
    const struct bench_vector offset = {0.0, 0.06};

    hold(0.0, 100);
    ekf.unloaded_periods = 3000;
    ekf.swing_end = 2500;
    for (int k = 0; k < 3000; k++) {
        offset_period(0.0, offset, true);
        TEST_ASSERT_EQUAL_UINT32(0, ekf.following_periods);
        TEST_ASSERT_DOUBLE_WITHIN(holding.load_step_Nm, 0.0, estimated_load_Nm());
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, offset.b, num_to_double(ekf.bias.b) * base.voltage_V);
    offset_period(0.0, (struct bench_vector){0.0, -0.05}, true);
    for (int k = 0; k < 300 && ekf.following_periods == 0; k++) {
        offset_period(0.0, (struct bench_vector){0.0, -0.05}, true);
    }
    TEST_ASSERT_TRUE(ekf.following_periods > 0u);
}

/* The back-EMF of 0.3 rad/s, with which a slow load drew the rotor along until it stopped. The
   offset that it was taken for turns the load's estimate back, and is dropped when that is a step.
 */
static void test_a_rotor_that_crept_under_a_slow_load_is_no_offset_once_it_stops(void)
{
    hold(0.0, 1000);
    ekf.bias.b += num_from_double(0.3 * 0.157 / base.voltage_V);
    hold(0.0, 1500);
    TEST_ASSERT_DOUBLE_WITHIN(2.0 * holding.load_step_Nm, 0.0, estimated_load_Nm());
    TEST_ASSERT_DOUBLE_WITHIN(0.1 * 0.3 * 0.157, 0.0, num_to_double(ekf.bias.b) * base.voltage_V);
}

static void test_a_hold_begins_with_the_load_of_the_motion(void)
{
    motor.load_torque_Nm = 0.1;
    turn(10.0, 2000);
    invariant_ekf_settle(&ekf, &params);
    TEST_ASSERT_NUM_WITHIN(0.0, num_to_double(ekf.estimate.rotor.load_torque), ekf.settled_load);
}

/* Its current comes, and a wrong inductance looks like a load. */
static void test_until_a_hold_has_been_calm_more_is_a_step(void)
{
    turn(10.0, 200);
    invariant_ekf_settle(&ekf, &params);
    TEST_ASSERT_TRUE(ekf.step_limit > params.load_step + num_half(params.load_step));
    watch_hold();
    TEST_ASSERT_TRUE(ekf.step_limit > params.load_step + num_half(params.load_step));
    for (int block = 0; block < 80; block++) {
        watch_hold();
    }
    TEST_ASSERT_NUM_WITHIN(0.0, num_to_double(params.load_step), ekf.step_limit);
}

/* The load on either side of the settled one, by turns. */
static void step_of_load(double more)
{
    ekf.estimate.rotor.load_torque = ekf.settled_load + num_from_double(more);
    invariant_ekf_follow_step(&ekf, &params);
}

/* Beginning calm, the first counts one, or three on the other side than the last. */
static void test_steps_of_the_load_to_and_fro_are_a_vibration_sooner_than_those_to_one_side(void)
{
    step_of_load(-0.1);
    TEST_ASSERT_EQUAL_UINT8(1, ekf.swings);
    TEST_ASSERT_FALSE(ekf.swung_up);
    step_of_load(-0.1);
    TEST_ASSERT_EQUAL_UINT8(2, ekf.swings);
    start_at(0.0, 0.0);
    step_of_load(0.1);
    TEST_ASSERT_EQUAL_UINT8(3, ekf.swings);
    TEST_ASSERT_TRUE(ekf.swung_up);
}

/* What counts as a step of a load that differs by this from the one settled at. */
static num_t step_limit_at(double away)
{
    ekf.estimate.rotor.load_torque = ekf.settled_load + num_from_double(away);
    watch_hold();
    return ekf.step_limit;
}

/* The q current that compensates a load, through a resistance that is off. */
static void
test_of_a_load_that_has_grown_more_is_a_step_only_beyond_what_its_current_may_feign(void)
{
    const double share = coef_to_double(params.feigned_share);
    const double limit = num_to_double(params.load_step);

    TEST_ASSERT_DOUBLE_WITHIN(1e-4, holding.feigned_share, share);
    for (int side = -1; side <= 1; side += 2) {
        start_at(0.0, 0.0);
        ekf.settled_load = num_from_double(side * 0.25);
        TEST_ASSERT_NUM_WITHIN(1e-3, limit + share * 0.25, step_limit_at(side * 0.01));
        TEST_ASSERT_NUM_WITHIN(1e-4, limit, step_limit_at(side * -0.01));
        for (int block = 0; block < 2000; block++) { /* the offset is found */
            (void)step_limit_at(0.0);
        }
        TEST_ASSERT_NUM_WITHIN(1e-3, limit, step_limit_at(side * 0.01));
        ekf.estimate.rotor.load_torque = NUM(0.125);
        invariant_ekf_settle(&ekf, &params);
        TEST_ASSERT_NUM_WITHIN(0.0, 0.125, ekf.offset_load);
    }
}

static void test_a_step_of_the_load_brings_the_lasting_offset_back(void)
{
    ekf.settled_bias = (struct phases){NUM(0.25), NUM(-0.125)};
    ekf.bias = (struct phases){NUM(0.5), NUM(0.5)};
    step_of_load(0.1);
    TEST_ASSERT_TRUE(ekf.bias.a == NUM(0.25) && ekf.bias.b == NUM(-0.125));
    TEST_ASSERT_EQUAL_UINT32(params.following_periods + params.rest_periods, ekf.following_periods);
    invariant_ekf_forget_bias(&ekf);
    TEST_ASSERT_TRUE(ekf.bias.a == NUM(0.0) && ekf.settled_bias.a == NUM(0.0));
    TEST_ASSERT_TRUE(ekf.bias.b == NUM(0.0) && ekf.settled_bias.b == NUM(0.0));
}

/* While a hold has not followed a step for long. */
static void test_the_lasting_offset_goes_to_the_offset_by_its_time_constant(void)
{
    const double share = coef_to_double(params.bias_settle);
    double left = 1.0;

    ekf.bias = (struct phases){NUM(0.25), NUM(-0.5)};
    for (int n = 0; n < 20; n++) {
        left *= 1.0 - share;
        watch_hold();
    }
    TEST_ASSERT_NUM_WITHIN(1e-4, 0.25 * (1.0 - left), ekf.settled_bias.a);
    TEST_ASSERT_NUM_WITHIN(1e-4, -0.5 * (1.0 - left), ekf.settled_bias.b);
    ekf.following_periods = 1u;
    ekf.bias = (struct phases){NUM(0.0), NUM(0.0)};
    watch_hold();
    TEST_ASSERT_NUM_WITHIN(1e-4, 0.25 * (1.0 - left), ekf.settled_bias.a);
}

static void test_a_hold_returns_to_no_more_load_than_its_current_bears(void)
{
    ekf.settled_load = NUM(0.25);
    invariant_ekf_bear(&ekf, NUM(0.25));
    TEST_ASSERT_NUM_WITHIN(0.0, 0.25, ekf.settled_load);
    ekf.settled_load = NUM(-0.5);
    invariant_ekf_bear(&ekf, NUM(0.25));
    TEST_ASSERT_NUM_WITHIN(0.0, -0.25, ekf.settled_load);
}

static void test_a_reset_forgets_all_but_what_it_is_set_to(void)
{
    turn(45.0, 300);
    hold(0.0, 50);
    ekf.following_periods = 7;
    ekf.bias.a = NUM(0.1);
    ekf.settled_load = NUM(0.1);
    ekf.adapted_at = NUM(0.1);
    invariant_ekf_reset(&ekf, &params, position_from_rad(1.0, 50), NUM(0.1), 9);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, position_to_rad(ekf.estimate.rotor.position, 50));
    TEST_ASSERT_NUM_WITHIN(0.0, 0.0, ekf.estimate.rotor.speed);
    TEST_ASSERT_NUM_WITHIN(0.0, 0.0, ekf.estimate.rotor.load_torque);
    TEST_ASSERT_NUM_WITHIN(0.0, 0.0, ekf.estimate.current.a);
    TEST_ASSERT_NUM_WITHIN(0.0, 0.0, ekf.bias.a);
    TEST_ASSERT_NUM_WITHIN(0.0, 0.0, ekf.settled_load);
    TEST_ASSERT_NUM_WITHIN(0.0, 0.0, ekf.adapted_at);
    TEST_ASSERT_EQUAL_UINT32(9, ekf.unloaded_periods);
    TEST_ASSERT_EQUAL_UINT32(0, ekf.following_periods);
    TEST_ASSERT_NUM_WITHIN(NUM_ROUNDING, 0.1, ekf.estimate.winding.resistance);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_step_is_that_of_the_equations_in_motion_and_in_hold);
    RUN_TEST(test_the_resistance_moves_by_all_innovations_since_it_moved_last);
    RUN_TEST(test_a_hold_that_leads_its_rotor_leaves_the_resistance_alone);
    RUN_TEST(test_a_current_that_swings_is_no_resistance_whatever_the_inductance);
    RUN_TEST(test_each_innovation_is_taken_once_by_the_monitor);
    RUN_TEST(test_a_voltage_that_was_another_than_expected_is_made_up_for);
    RUN_TEST(test_a_right_start_is_tracked_from_rest_through_an_acceleration);
    RUN_TEST(test_the_estimate_locks_from_thirty_electrical_degrees_either_way);
    RUN_TEST(test_steady_rotation_is_tracked_both_ways);
    RUN_TEST(test_a_reversal_through_rest_keeps_the_lock);
    RUN_TEST(test_a_load_of_a_tenth_Nm_is_estimated_within_ten_milliseconds);
    RUN_TEST(test_the_estimator_knows_no_preferred_direction);
    RUN_TEST(test_in_motion_the_resistance_is_left_alone);
    RUN_TEST(test_a_voltage_offset_is_found_in_motion_at_every_speed);
    RUN_TEST(test_a_voltage_offset_across_the_current_is_found_in_hold);
    RUN_TEST(test_a_hold_of_150_ms_calibrates_the_resistance_from_half_to_one_and_a_half);
    RUN_TEST(test_a_load_step_in_hold_is_followed_before_the_rotor_has_turned_far);
    RUN_TEST(test_a_load_that_vibrates_is_no_load_and_no_resistance);
    RUN_TEST(test_behind_its_estimate_a_rotor_is_found_half_as_fast_as_ahead_of_it);
    RUN_TEST(test_a_settled_hold_stays_where_it_is);
    RUN_TEST(test_a_settled_hold_returns_to_its_load_with_the_angle);
    RUN_TEST(test_in_an_unloaded_hold_an_offset_is_no_load);
    RUN_TEST(test_a_rotor_that_crept_under_a_slow_load_is_no_offset_once_it_stops);
    RUN_TEST(test_a_hold_begins_with_the_load_of_the_motion);
    RUN_TEST(test_until_a_hold_has_been_calm_more_is_a_step);
    RUN_TEST(test_steps_of_the_load_to_and_fro_are_a_vibration_sooner_than_those_to_one_side);
    RUN_TEST(test_of_a_load_that_has_grown_more_is_a_step_only_beyond_what_its_current_may_feign);
    RUN_TEST(test_a_step_of_the_load_brings_the_lasting_offset_back);
    RUN_TEST(test_the_lasting_offset_goes_to_the_offset_by_its_time_constant);
    RUN_TEST(test_a_hold_returns_to_no_more_load_than_its_current_bears);
    RUN_TEST(test_a_reset_forgets_all_but_what_it_is_set_to);
    return UNITY_END();
}
