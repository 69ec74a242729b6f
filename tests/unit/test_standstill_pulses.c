/*
 * Pulses on the hold show the angle of a rotor that a load has displaced: the flux of each phase as
 * in sil/plant/magnetics.h, a bridge without dead time, a hold that keeps its voltage.
 */
#include "firmware/estimator/standstill_pulses.h"
#include "tests/unit/bench.h"
#include "tests/unit/emulated.h"
#include "tests/unit/num_assert.h"

#define DEGREE     (TWO_PI / 360.0)
#define MAGNET_A   3.488 /* Km / (N L) */
#define SATURATION 0.00095
#define HOLD_A     1.5
#define IMPULSE_A  3.78

enum { STEPS = EMULATED ? 20 : 100 }; /* of a period */

static struct per_unit base;
static struct motor_model_params model;
static struct standstill_pulses_params params;
static struct standstill_pulses pulses;
static const struct phases no_loss = {NUM(0.0), NUM(0.0)};
static double inductance_scale; /* of the winding, not of what the drive knows */
static double peak_A;           /* of phase a, in the last look */

/* Of one phase: flux linkage over L, A; the rotor stands. */
struct winding_bench {
    double x;
    double magnet_A; /* share of I_f along the phase */
};

static double current_of(const struct winding_bench *w)
{
    return w->x + SATURATION * w->x * w->x * w->x - w->magnet_A;
}

static void settle(struct winding_bench *w, double magnet_A, double current_A)
{
    w->magnet_A = magnet_A;
    w->x = magnet_A + current_A;
    double last = w->x + 1.0;

    for (int i = 0; i < 50 && w->x != last; i++) {
        last = w->x;
        w->x -= (current_of(w) - current_A) / (1.0 + 3.0 * SATURATION * w->x * w->x);
    }
}

static void drive(struct winding_bench *w, double voltage_V)
{
    for (int step = 0; step < STEPS; step++) {
        w->x += PERIOD_S / STEPS / (inductance_scale * bench_params.inductance_H) *
                (voltage_V - bench_params.resistance_ohm * current_of(w));
    }
}

void setUp(void)
{
    const struct standstill_pulses_task task = {
        .period_s = PERIOD_S,
        .peak_A = 4.3,
        .current_max_A = 5.07,
        .hold_current_A = HOLD_A,
        .hold_ramp_s = 0.01,
        .impulse_peak_A = IMPULSE_A,
    };
    /* What impulses of 3.78 A show of this motor: 3 b I_f i^2, eight times. */
    const double asymmetry_A = 8.0 * 3.0 * SATURATION * 3.45 * IMPULSE_A * IMPULSE_A;

    inductance_scale = 1.0;
    base = per_unit_base(&bench_params, PERIOD_S);
    model = motor_model_design(&bench_params, &base, PERIOD_S, 0.0);
    standstill_pulses_design(&params, &model, &bench_params, &base, &task);
    standstill_pulses_reset(&pulses, &params, num_from_double(asymmetry_A / base.current_A));
}

void tearDown(void)
{
}

static struct standstill_angle shown; /* found last */

/* A hold at angle 0 with the rotor displaced; whether its angle is found. The estimator's current
   is the true one outside the pulses, the model's within. */
static bool look(double rotor_rad, uint32_t *periods)
{
    const double hold_V = bench_params.resistance_ohm * HOLD_A;
    struct winding winding;
    struct winding_bench a, b;
    struct phases estimated = {NUM(0.0), NUM(0.0)};
    struct phases command = {num_from_double(hold_V / base.voltage_V), NUM(0.0)};
    struct phases in_force = command;

    peak_A = 0.0;
    winding_set_resistance(&winding, &model, model.nominal_resistance);
    settle(&a, MAGNET_A * cos(rotor_rad), HOLD_A);
    settle(&b, MAGNET_A * sin(rotor_rad), 0.0);
    for (*periods = 0; *periods < 2000u; (*periods)++) {
        const struct phases measured = bench_phases(current_of(&a), current_of(&b), base.current_A);
        struct phases wanted = {num_from_double(hold_V / base.voltage_V), NUM(0.0)};
        bool found;

        if (standstill_pulses_blanks_sample(&pulses, &params)) {
            static const struct sincos no_turn = {UNIT(1.0), UNIT(0.0)};

            estimated = predict_current(&model, &winding, estimated, NUM(0.0), no_turn, in_force);
            standstill_pulses_sample(&pulses, &params, measured, estimated);
        } else {
            estimated = measured;
        }
        (void)standstill_pulses_add(&pulses, &params, estimated, no_loss, &wanted);
        found = standstill_pulses_result(&pulses, &params, &shown);
        if (found || (pulses.at_rest && *periods > 400u)) {
            return found;
        }
        in_force = command;
        peak_A = fmax(peak_A, current_of(&a));
        drive(&a, num_to_double(command.a) * base.voltage_V);
        drive(&b, num_to_double(command.b) * base.voltage_V);
        command = wanted;
    }
    return false;
}

static double degrees_of(angle_t angle)
{
    return (double)(int32_t)angle / 4294967296.0 * 360.0;
}

/* 2.8 A in one period of 0.9 mH: all but the last of the supply that may be used. */
static void test_the_design_in_figures(void)
{
    const double pulse_A = 4.3 - HOLD_A;
    const double admittance = num_to_double(model.nominal_admittance);
    const double resistance = num_to_double(model.nominal_resistance);
    const double twice = admittance * (2.0 - resistance * admittance);
    const double response = params.pulse_periods == 1u ? admittance : twice;

    TEST_ASSERT_DOUBLE_WITHIN(1e-4, pulse_A / base.current_A,
                              response * num_to_double(params.voltage));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, base.current_A / pulse_A, coef_to_double(params.per_response));
    TEST_ASSERT_NUM_WITHIN(1e-5, 1.15 * pulse_A / base.current_A, params.largest_change);
    TEST_ASSERT_NUM_WITHIN(1e-5, (5.07 - 1.15 * pulse_A) / base.current_A, params.current_max);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, pulse_A * pulse_A / (IMPULSE_A * IMPULSE_A),
                              coef_to_double(params.signal));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, base.current_A / MAGNET_A, coef_to_double(params.per_magnet));
    TEST_ASSERT_EQUAL_UINT32(40, params.pause_periods);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 1.0 / (16.0 * (2.0 * params.pulse_periods + 9.0)),
                              coef_to_double(params.per_period));
}

static void test_the_angle_of_a_displaced_rotor_is_found(void)
{
    for (int degrees = -60; degrees <= 60; degrees += 15) {
        uint32_t periods;

        setUp();
        TEST_ASSERT_TRUE(look(degrees * DEGREE, &periods));
        TEST_ASSERT_DOUBLE_WITHIN(2.0, (double)degrees, degrees_of(shown.angle));
        TEST_ASSERT_DOUBLE_WITHIN(0.02, HOLD_A, num_to_double(shown.current.a) * base.current_A);
    }
}

static void test_the_first_pulse_waits_for_the_hold_to_settle(void)
{
    uint32_t periods;

    (void)look(0.0, &periods);
    TEST_ASSERT_TRUE(periods > 300u + 16u * 8u);
    TEST_ASSERT_TRUE(periods < 300u + 16u * 14u);
}

static void test_only_a_pulse_blanks_samples(void)
{
    uint32_t blanked = 0;

    for (uint32_t k = 0; k < 300u; k++) {
        struct phases voltage = {NUM(0.0), NUM(0.0)};

        TEST_ASSERT_FALSE(standstill_pulses_blanks_sample(&pulses, &params));
        (void)standstill_pulses_add(&pulses, &params, voltage, no_loss, &voltage);
        TEST_ASSERT_NUM_WITHIN(0.0, 0.0, voltage.a);
    }
    for (uint32_t k = 0; k < 12u; k++) {
        struct phases voltage = {NUM(0.0), NUM(0.0)};

        blanked += standstill_pulses_blanks_sample(&pulses, &params) ? 1u : 0u;
        (void)standstill_pulses_add(&pulses, &params, voltage, no_loss, &voltage);
    }
    TEST_ASSERT_EQUAL_UINT32(6u, blanked);
}

static void test_a_disturbance_of_another_size_shows_no_angle(void)
{
    uint32_t periods;

    pulses.signal = pulses.signal + pulses.signal;
    TEST_ASSERT_FALSE(look(0.3, &periods));
}

static void test_pulses_adapt_to_another_inductance(void)
{
    static const double scales[] = {0.85, 1.0, 1.15};
    const double wanted_A = num_to_double(params.largest_change) * base.current_A;

    for (size_t i = 0; i < sizeof scales / sizeof scales[0]; i++) {
        uint32_t periods;

        setUp();
        inductance_scale = scales[i];
        (void)look(0.3, &periods);
        TEST_ASSERT_TRUE(peak_A < HOLD_A + 0.97 * wanted_A);
        for (int again = 0; again < 8; again++) {
            (void)look(0.3, &periods);
            TEST_ASSERT_TRUE(peak_A < HOLD_A + 1.07 * wanted_A);
        }
        /* the change is sampled a period later */
        TEST_ASSERT_DOUBLE_WITHIN(0.1 * wanted_A, HOLD_A + 0.95 * wanted_A, peak_A);
        inductance_scale = 0.8 * scales[i]; /* the iron answers otherwise than it did */
        for (int again = 0; again < 8; again++) {
            (void)look(0.3, &periods);
        }
        TEST_ASSERT_TRUE(peak_A < HOLD_A + 1.07 * wanted_A);
    }
}

static void test_every_hold_begins_with_small_pulses(void)
{
    uint32_t periods;
    double first_A;

    (void)look(0.0, &periods);
    first_A = peak_A;
    for (int again = 0; again < 8; again++) {
        (void)look(0.0, &periods);
    }
    TEST_ASSERT_TRUE(peak_A > first_A + 0.3);
    standstill_pulses_stop(&pulses);
    (void)look(0.0, &periods);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, first_A, peak_A);
}

static void test_a_hold_that_ends_begins_anew(void)
{
    struct phases voltage = {NUM(0.0), NUM(0.0)};

    for (uint32_t k = 0; k < 305u; k++) {
        (void)standstill_pulses_add(&pulses, &params, voltage, no_loss, &voltage);
    }
    TEST_ASSERT_FALSE(pulses.at_rest);
    standstill_pulses_stop(&pulses);
    TEST_ASSERT_TRUE(pulses.at_rest);
    TEST_ASSERT_EQUAL_UINT32(0u, pulses.period);
}

/* From the rest before the first pulse on: adds for this many periods; the last voltage. */
static struct phases go_on(uint32_t periods, struct phases current, struct phases loss)
{
    struct phases voltage = {NUM(0.0), NUM(0.0)};

    for (uint32_t k = 0; k < periods; k++) {
        voltage = (struct phases){NUM(0.05), NUM(0.0)};
        (void)standstill_pulses_add(&pulses, &params, current, loss, &voltage);
    }
    return voltage;
}

static void test_a_load_that_grows_ends_the_pulses_before_the_next(void)
{
    const struct phases hold = {NUM(0.05), NUM(0.05)};
    const struct phases loaded = {NUM(0.05), params.current_max};
    const uint32_t length = 2u * params.pulse_periods + 9u;

    (void)go_on(301u + 2u * length, hold, no_loss);
    TEST_ASSERT_FALSE(pulses.at_rest);
    TEST_ASSERT_EQUAL_UINT32(2u, pulses.number);
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.05, go_on(1u, loaded, no_loss).a);
    TEST_ASSERT_TRUE(pulses.at_rest);
    TEST_ASSERT_EQUAL_UINT32(0u, pulses.number);
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.7, pulses.strength); /* too few have been seen to grow */
}

static void test_the_load_is_the_torque_of_all_current_pulses_included(void)
{
    const struct phases hold = {NUM(0.1), NUM(0.0)}, pulse = {NUM(0.1), NUM(0.06)};
    const uint32_t length = 2u * params.pulse_periods + 9u;

    (void)go_on(301u, hold, no_loss);
    TEST_ASSERT_FALSE(pulses.at_rest);
    for (uint32_t number = 0; number < IMPULSES; number++) {
        (void)go_on(2u, hold, no_loss);
        (void)go_on(1u, pulse, no_loss);
        (void)go_on(length - 3u, hold, no_loss);
    }
    (void)standstill_pulses_result(&pulses, &params, &shown);
    TEST_ASSERT_NUM_WITHIN(1e-5, 0.1, shown.current.a);
    TEST_ASSERT_NUM_WITHIN(1e-5, 0.06 / length, shown.current.b);
}

static void test_the_hold_behind_a_pulse_has_the_loss_of_the_current_it_left(void)
{
    const struct phases hold = {NUM(0.1), NUM(0.01)}, loss = {NUM(-0.02), NUM(-0.005)};
    const uint32_t behind = params.pulse_periods + 1u, others = params.pulse_periods + 8u;

    (void)go_on(301u, hold, loss);
    /* the current stays positive: nothing to change */
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.05, go_on(behind, hold, loss).a);
    (void)go_on(others, hold, loss);
    /* it is negative: what is added for the positive one is taken off, and as much again */
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.05 - 0.04, go_on(behind, hold, loss).a);
    (void)go_on(others + 2u * (behind + others), hold, loss);
    /* in the other phase; the hold's loss there is smaller than that of such a current */
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.015, go_on(behind, hold, loss).b);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_design_in_figures);
    RUN_TEST(test_the_angle_of_a_displaced_rotor_is_found);
    RUN_TEST(test_the_first_pulse_waits_for_the_hold_to_settle);
    RUN_TEST(test_only_a_pulse_blanks_samples);
    RUN_TEST(test_a_disturbance_of_another_size_shows_no_angle);
    RUN_TEST(test_pulses_adapt_to_another_inductance);
    RUN_TEST(test_every_hold_begins_with_small_pulses);
    RUN_TEST(test_a_load_that_grows_ends_the_pulses_before_the_next);
    RUN_TEST(test_a_hold_that_ends_begins_anew);
    RUN_TEST(test_the_load_is_the_torque_of_all_current_pulses_included);
    RUN_TEST(test_the_hold_behind_a_pulse_has_the_loss_of_the_current_it_left);
    return UNITY_END();
}
