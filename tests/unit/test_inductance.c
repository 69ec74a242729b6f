/* The inductance that is found while the drive is enabled, and what is made of it. */
#include "firmware/drive/inductance.h"

#include "firmware/drive/inductance_measurement.h"
#include "tests/unit/drive_bench.h"

static const double hold_current_A = 3.0;
static const double unsaturated = 1.04; /* more than is measured */
static const uint32_t look = 450u;

static struct per_unit base;
static struct inductance_measurement_params params;
static struct inductance_measurement measurement;
static struct winding winding; /* as the drive knows it */

/* The winding as it is, and its converters. */
static struct {
    double resistance_ohm, inductance_H;
    double offset_V;
    double current_A;
    double noise_codes;
    double stuck;                   /* share of a step that does not come */
    double iron_A, iron_Vs, turned; /* the iron's current is turned x iron_A; it turns within the
                                       flux linkage iron_Vs */
    uint32_t seed;
} world;

static double level_sum; /* of the current's reference beside the hold's */

void setUp(void)
{
    struct motor_model_params model;

    drive_bench_reset();
    base = per_unit_base(&bench_params, PERIOD_S);
    model = motor_model_design(&bench_params, &base, PERIOD_S, 0.0);
    winding_set_resistance(&winding, &model, model.nominal_resistance);
    params = inductance_measurement_design(&base, hold_current_A, look);
    memset(&world, 0, sizeof world);
    world.resistance_ohm = bench_params.resistance_ohm;
    world.inductance_H = bench_params.inductance_H;
    world.current_A = hold_current_A;
    world.seed = 1;
}

void tearDown(void)
{
}

static num_t measured(double value, double code, double in)
{
    world.seed = world.seed * 1664525u + 1013904223u;
    const double noise = world.noise_codes * ((double)(world.seed >> 8) / 8388608.0 - 1.0);

    return num_from_double(code * floor(value / code + noise + 0.5) / in);
}

/* One period of a winding on iron that turns with its flux: dh = (d lambda - |d lambda| h) / l0. */
static void run_winding_on_iron(double voltage_V)
{
    enum { PARTS = 200 };

    for (int part = 0; part < PARTS; part++) {
        const double flux_Vs =
            (voltage_V - world.resistance_ohm * world.current_A) * PERIOD_S / PARTS;
        const double turns = (flux_Vs - fabs(flux_Vs) * world.turned) / world.iron_Vs;

        world.turned += turns;
        world.current_A += flux_Vs / world.inductance_H + world.iron_A * turns;
    }
}

/* One period of the winding under the mean voltage, solved exactly. */
static void run_winding(double voltage_V)
{
    if (world.iron_A > 0.0) {
        run_winding_on_iron(voltage_V);
        return;
    }
    const double final_A = voltage_V / world.resistance_ohm;
    const double decay = exp(-PERIOD_S * world.resistance_ohm / world.inductance_H);

    world.current_A = final_A + (world.current_A - final_A) * decay;
}

/* A current control that goes a seventh of its way in a period. */
static double control(double reference_A)
{
    return world.resistance_ohm * world.current_A +
           world.inductance_H / PERIOD_S / 7.0 * (reference_A - world.current_A);
}

/* As long as the phases are compared; what is found. */
static double measure(void)
{
    const double A = bench_facts.current_A_per_code, V = bench_facts.phase_voltage_V_per_code;
    double voltage_V = world.resistance_ohm * world.current_A;

    inductance_measurement_start(&measurement);
    level_sum = 0.0;
    for (uint32_t k = 0u; k < look; k++) {
        (void)inductance_measurement_step(&measurement, &params, winding.resistance,
                                          measured(voltage_V + world.offset_V, V, base.voltage_V),
                                          measured(world.current_A, A, base.current_A));
        level_sum += num_to_double(measurement.level);
        voltage_V = control(hold_current_A + (1.0 - world.stuck) * base.current_A *
                                                 num_to_double(measurement.level));
        run_winding(voltage_V);
    }
    return num_to_double(inductance_measurement_result(&measurement, &params, winding.admittance));
}

/* b, the current per voltage of a period. */
static double admittance(double resistance_ohm, double inductance_H)
{
    return (1.0 - exp(-PERIOD_S * resistance_ohm / inductance_H)) / resistance_ohm;
}

static void finds_it_to(double share)
{
    const double known = admittance(bench_params.resistance_ohm, bench_params.inductance_H);
    const double is = admittance(world.resistance_ohm, world.inductance_H);

    TEST_ASSERT_DOUBLE_WITHIN(share, unsaturated * known / is - 1.0, measure());
}

static void test_an_inductance_of_less_and_of_more_is_found(void)
{
    static const double scales[] = {0.65, 0.8, 0.95, 1.0, 1.1, 1.2, 1.3};

    for (size_t i = 0; i < sizeof scales / sizeof scales[0]; i++) {
        setUp();
        world.inductance_H *= scales[i];
        world.noise_codes = 0.5;
        finds_it_to(0.01);
    }
}

static void test_offset_and_resistance_that_are_wrong_do_not_err_it(void)
{
    world.inductance_H *= 0.8;
    world.offset_V = 0.1;
    world.resistance_ohm *= 1.03;
    world.noise_codes = 0.5;
    finds_it_to(0.01);
}

static void test_the_current_swings_about_the_hold_s_and_ends_there(void)
{
    (void)measure();
    TEST_ASSERT_EQUAL_DOUBLE(0.0, num_to_double(measurement.level));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, hold_current_A, world.current_A);
    /* nine small swings, the first and the last up, and nine large ones, the first and the last
       down */
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, num_to_double(params.small - params.large) * params.half,
                              level_sum);
}

/* 4 % of the rated current, as wide as the plant `as-built` may have it, and turned within what a
   fifteenth of that current makes: of a motor whose magnet has little flux. */
static void test_iron_that_a_small_swing_turns_leaves_it(void)
{
    world.iron_A = 0.04 * hold_current_A;
    world.iron_Vs = hold_current_A * world.inductance_H / 15.0;
    world.turned = 1.0;
    finds_it_to(0.015);
}

static void test_a_current_that_does_not_follow_is_no_winding_s(void)
{
    world.stuck = 0.9;
    TEST_ASSERT_EQUAL_DOUBLE(1.0, measure());
}

static void test_where_it_is_not_asked_for_nothing_swings(void)
{
    params = inductance_measurement_design(&base, hold_current_A, 0u);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, measure());
    TEST_ASSERT_EQUAL_DOUBLE(0.0, level_sum);
}

/* ---- what is made of it ---- */

static double of(coef_t gain)
{
    return 1024.0 * num_to_double(num_mul_coef(NUM(1.0 / 1024.0), gain));
}

/* The same design for a motor that has the inductance. */
static struct drive_params designed_for(double inductance_H)
{
    settings.motor.inductance_H = inductance_H;
    power_up();
    settings.motor.inductance_H = bench_params.inductance_H;
    return drive.params;
}

/* Until all of it is in force. */
static bool put(num_t more)
{
    const bool is_sound = inductance_put(&drive, more);

    while (drive.enabling.inductance_put.left > 0u) {
        inductance_put_part(&drive);
    }
    return is_sound;
}

static void is_scaled(double by, coef_t gain, coef_t as_designed)
{
    TEST_ASSERT_DOUBLE_WITHIN(2e-4 * fabs(of(as_designed)) + 5e-5, by * of(as_designed), of(gain));
}

static void are_scaled(double by, const struct invariant_ekf_gain_set *gain,
                       const struct invariant_ekf_gain_set *as_designed)
{
    is_scaled(by, gain->speed_q, as_designed->speed_q);
    is_scaled(by, gain->angle_d, as_designed->angle_d);
    is_scaled(by, gain->angle_q, as_designed->angle_q);
    is_scaled(by, gain->load_q, as_designed->load_q);
    is_scaled(by, gain->bias_q, as_designed->bias_q);
    is_scaled(by, gain->resistance, as_designed->resistance);
    is_scaled(1.0, gain->current, as_designed->current);
    is_scaled(1.0, gain->bias_per_turn, as_designed->bias_per_turn);
}

static void test_in_force_the_model_is_that_of_the_inductance_and_each_gain_goes_with_it(void)
{
    static const double scales[] = {0.75, 1.25, 1.55};

    settings.current_bandwidth_rad_s = 1500.0;
    for (size_t i = 0; i < 3; i++) {
        const struct drive_params anew = designed_for(scales[i] * bench_params.inductance_H);
        const struct drive_params nominal = designed_for(bench_params.inductance_H);
        const struct invariant_ekf_params *before = &nominal.estimator.invariant_ekf;
        const struct invariant_ekf_params *ekf = &drive.params.estimator.invariant_ekf;

        TEST_ASSERT_TRUE(put(num_from_double(scales[i] - 1.0)));
        /* T R/L of the bench is 0.04, and b of (1 - T R/2L) T/L */
        TEST_ASSERT_DOUBLE_WITHIN(0.008 * num_to_double(anew.model.nominal_admittance),
                                  num_to_double(anew.model.nominal_admittance),
                                  num_to_double(drive.params.model.nominal_admittance));
        TEST_ASSERT_EQUAL_MEMORY(&drive.params.model, &ekf->model, sizeof ekf->model);
        is_scaled(1.0, drive.params.model.rate, anew.model.rate);
        is_scaled(1.0, drive.params.current_control.proportional,
                  anew.current_control.proportional);
        is_scaled(1.0, drive.params.current_control.reactance, anew.current_control.reactance);
        is_scaled(1.0, drive.params.current_control.integral, anew.current_control.integral);
        is_scaled(1.0, drive.params.current_control.unwind, anew.current_control.unwind);
        are_scaled(scales[i], &ekf->moving, &before->moving);
        are_scaled(scales[i], &ekf->holding, &before->holding);
        are_scaled(scales[i], &ekf->unloaded, &before->unloaded);
        are_scaled(scales[i], &ekf->following, &before->following);
    }
}

static void test_what_is_found_again_and_again_counts_from_the_settings(void)
{
    const struct drive_params nominal = designed_for(bench_params.inductance_H);
    const double admittance = num_to_double(drive.estimator.estimate.winding.admittance);

    TEST_ASSERT_TRUE(put(NUM(0.2)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.2, signals().inductance_change);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * admittance, admittance / 1.2,
                              num_to_double(drive.estimator.estimate.winding.admittance));
    TEST_ASSERT_TRUE(put(NUM(-0.25)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -0.1, signals().inductance_change);
    is_scaled(0.9, drive.params.current_control.proportional, nominal.current_control.proportional);
    TEST_ASSERT_TRUE(put(NUM(0.15))); /* 3.5 % more: confirms them */
    TEST_ASSERT_EQUAL_DOUBLE(0.0, signals().inductance_change);
    is_scaled(1.0, drive.params.current_control.proportional, nominal.current_control.proportional);
    TEST_ASSERT_TRUE(put(NUM(0.5)));
    TEST_ASSERT_FALSE(put(NUM(0.1))); /* 65 % more than the settings */
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.5, signals().inductance_change);
}

static void test_what_no_sound_motor_has_is_refused(void)
{
    static const double beyond[] = {-0.36, 0.61, 1.0};

    power_up();
    for (size_t i = 0; i < 3; i++) {
        TEST_ASSERT_FALSE(put(num_from_double(beyond[i])));
        TEST_ASSERT_EQUAL_DOUBLE(0.0, signals().inductance_change);
    }
}

static void test_a_drive_is_enabled_with_the_inductance_of_its_motor(void)
{
    motor.motor.inductance_H *= 0.8;
    bridge.loss_V = 0.0;
    settings.balance_phases = true;
    settings.hold_on_enable_s = 0.15;
    power_up();
    post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE});
    while (drive.supervision.state != DRIVE_OPERATION_ENABLED) {
        run(1);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.03, unsaturated * 0.8 - 1.0, signals().inductance_change);
    settings.identify_inductance = false;
    power_up();
    post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE});
    while (drive.supervision.state != DRIVE_OPERATION_ENABLED) {
        run(1);
    }
    TEST_ASSERT_EQUAL_DOUBLE(0.0, signals().inductance_change);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_an_inductance_of_less_and_of_more_is_found);
    RUN_TEST(test_offset_and_resistance_that_are_wrong_do_not_err_it);
    RUN_TEST(test_the_current_swings_about_the_hold_s_and_ends_there);
    RUN_TEST(test_iron_that_a_small_swing_turns_leaves_it);
    RUN_TEST(test_a_current_that_does_not_follow_is_no_winding_s);
    RUN_TEST(test_where_it_is_not_asked_for_nothing_swings);
    RUN_TEST(test_in_force_the_model_is_that_of_the_inductance_and_each_gain_goes_with_it);
    RUN_TEST(test_what_is_found_again_and_again_counts_from_the_settings);
    RUN_TEST(test_what_no_sound_motor_has_is_refused);
    RUN_TEST(test_a_drive_is_enabled_with_the_inductance_of_its_motor);
    return UNITY_END();
}
