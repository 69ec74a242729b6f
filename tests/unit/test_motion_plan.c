/* Motion planned in segments of constant jerk, and the reference that follows it. */
#include <stddef.h>
#include <string.h>
#include <unity.h>

#include "firmware/design/elementary.h"
#include "firmware/motion/reference.h"
#include "firmware/motion/set_points.h"
#include "firmware/motion/sine.h"

static const double two_pi = 6.283185307179586476925;
static const struct position origin = {0, 0};

/* 150 rad/s and 6000 rad/s^2 are one per-unit; 50 teeth; 10 kHz. */
static const struct per_unit base = {.speed_rad_s = 150.0,
                                     .acceleration_rad_s2 = 6000.0,
                                     .rad_per_turn = 6.283185307179586476925 / 50.0,
                                     .turns_per_period =
                                         150.0 * 1e-4 * 50.0 / 6.283185307179586476925};

/* 40 rad/s, 800 rad/s^2, 40000 rad/s^3 at 50 teeth and 10 kHz. */
static const struct motion_limits limits = {
    .speed = 40.0 * 7.957747154594767 * 1e-4,
    .acceleration = 800.0 * 7.957747154594767 * 1e-8,
    .jerk = 40000.0 * 7.957747154594767 * 1e-12,
};

static struct reference_params params;
static struct reference reference;
static struct motion_plan plans[2];
static struct motion_state end; /* of the last plan */

void setUp(void)
{
    params = reference_design(&base, 1e-4, (struct creep_limits){0.0, 0.0});
    reference_reset(&reference, origin);
}

void tearDown(void)
{
}

static void step(void)
{
    if (!reference_step(&reference, &params)) {
        (void)reference_turn(&reference, &params, false);
    }
}

/* Where the reference is, as an exact 96-bit difference turned to turns. */
static double turns_since(const struct motion_state *then)
{
    const struct motion_state *now = &reference.at;

    return (double)(now->turns - then->turns) +
           ((double)now->fraction - (double)then->fraction) / 18446744073709551616.0;
}

static void is_at(const struct motion_state *expected)
{
    TEST_ASSERT_EQUAL_INT32(expected->turns, reference.at.turns);
    TEST_ASSERT_EQUAL_UINT64(expected->fraction, reference.at.fraction);
    TEST_ASSERT_EQUAL_INT64(expected->speed, reference.at.speed);
    TEST_ASSERT_EQUAL_INT64(expected->acceleration, reference.at.acceleration);
}

/* A plan from where the reference will be when it preempts in the next interrupt. */
static struct motion_plan *new_plan(void)
{
    struct motion_plan *plan = reference.plan == &plans[0] ? &plans[1] : &plans[0];

    motion_plan_begin(plan, &reference.at, reference.epoch);
    end = reference.at;
    if (reference.periods_left > 0u) {
        motion_run(&end, reference_jerk_sixth(&reference), 1u);
    }
    return plan;
}

static void must_preempt(const struct motion_plan *plan)
{
    TEST_ASSERT_TRUE(reference_preempt(&reference, plan));
}

static void go_at(double speed)
{
    struct motion_plan *plan = new_plan();

    motion_plan_speed(plan, &end, speed, &limits);
    if (speed != 0.0) {
        motion_plan_cruise(plan);
    }
    must_preempt(plan);
}

static void go_to(struct position target)
{
    struct motion_plan *plan = new_plan();

    motion_plan_move(plan, &end, target, &limits);
    must_preempt(plan);
}

/*
 * No kink, exactly: in every period the speed changes by the mean of the accelerations at its ends
 * (less j/12, within rounding), and neither acceleration nor jerk is beyond its limit, whole
 * periods and the rounding of a landing allowed for.
 */
static void step_without_a_kink(double excess)
{
    const struct motion_state before = reference.at;
    const double a0 = motion_to_turns(before.acceleration);
    double a1;
    double mean;

    step();
    a1 = motion_to_turns(reference.at.acceleration);
    mean = motion_to_turns(reference.at.speed) - motion_to_turns(before.speed);
    TEST_ASSERT_DOUBLE_WITHIN(1e-13, (a0 + a1) / 2.0, mean);
    TEST_ASSERT_DOUBLE_WITHIN(2e-10, motion_to_turns(before.speed) + a0 / 3.0 + a1 / 6.0,
                              turns_since(&before));
    TEST_ASSERT_TRUE(magnitude(a1) <= limits.acceleration * (1.0 + excess) + 1e-15);
    TEST_ASSERT_TRUE(magnitude(a1 - a0) <= limits.jerk * (1.0 + excess) + 1e-14);
}

static void run_without_a_kink(uint32_t periods)
{
    for (uint32_t k = 0; k < periods; k++) {
        step_without_a_kink(0.0);
    }
}

static void test_the_closed_form_is_the_sum_of_the_additions_bit_for_bit(void)
{
    static const uint32_t periods[] = {1, 2, 3, 10, 333, 5000};

    for (unsigned i = 0; i < sizeof periods / sizeof periods[0]; i++) {
        for (int64_t sign = -1; sign <= 1; sign += 2) {
            struct motion_plan *plan = new_plan();
            struct motion_state expected;

            plan->speed_jump = sign * 123456789012345678;
            end.speed += plan->speed_jump;
            plan->segment[0] = (struct motion_segment){.periods = periods[i],
                                                       .acceleration = end.acceleration,
                                                       .jerk_sixth = -sign * 98765432109};
            plan->segment[1] = (struct motion_segment){.periods = 1};
            plan->segments = 2;
            must_preempt(plan);
            step();
            expected = end;
            motion_run(&expected, -sign * 98765432109, periods[i]);
            for (uint32_t k = 1; k < periods[i]; k++) {
                step();
            }
            step();
            expected.acceleration = 0; /* of the segment that begins */
            is_at(&expected);
            reference_reset(&reference, reference.next.position);
        }
    }
}

static void test_a_speed_is_reached_without_a_kink_and_kept(void)
{
    go_at(limits.speed);
    TEST_ASSERT_FALSE(reference.next.moving);
    run_without_a_kink(700); /* 40 rad/s / 800 rad/s^2 + 800 / 40000 s = 700 periods */
    TEST_ASSERT_TRUE(reference.next.moving);
    run_without_a_kink(1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, limits.speed, motion_to_turns(reference.at.speed));
    TEST_ASSERT_EQUAL_INT64(0, reference.at.acceleration);
    const int64_t speed = reference.at.speed;

    run_without_a_kink(100000);
    TEST_ASSERT_EQUAL_INT64(speed, reference.at.speed);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 40.0 / 150.0, num_to_double(reference.next.speed));
}

/* Else what rounding has left would be the beginning of what follows. */
static void test_where_a_speed_is_reached_there_is_no_acceleration(void)
{
    for (int i = 1; i <= 20; i++) {
        struct motion_state end = {.acceleration = 2 * i * 123457, .speed = 1000003 * i};
        struct motion_plan plan;

        motion_plan_begin(&plan, &end, 0);
        motion_plan_speed(&plan, &end, limits.speed * i / 20.0, &limits);
        TEST_ASSERT_EQUAL_INT64(0, end.acceleration);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, limits.speed * i / 20.0, motion_to_turns(end.speed));
    }
}

/* Whatever the reference does, a new speed preempts without a kink. */
static void test_speeds_follow_one_another_in_mid_change(void)
{
    static const double speeds[] = {1.0, -1.0, 0.3, 0.31, -0.9, 0.0, 0.5, 0.4999, -0.2, 0.0};

    for (uint32_t gap = 1; gap < 900; gap = gap * 5 / 3 + 1) {
        for (unsigned i = 0; i < sizeof speeds / sizeof speeds[0]; i++) {
            go_at(limits.speed * speeds[i]);
            run_without_a_kink(gap);
        }
        run_without_a_kink(2000);
        TEST_ASSERT_FALSE(reference_busy(&reference));
        TEST_ASSERT_EQUAL_INT64(0, reference.at.speed);
    }
}

static void test_a_new_target_is_reached_exactly_from_any_motion(void)
{
    static const double targets_rad[] = {3.0, -2.0, 0.0, 0.004, 0.003, 1.5, -8.0};

    for (uint32_t gap = 1; gap < 2000; gap = gap * 5 / 3 + 1) {
        struct position target = origin;

        for (unsigned i = 0; i < sizeof targets_rad / sizeof targets_rad[0]; i++) {
            target = position_from_rad(targets_rad[i], 50);
            go_to(target);
            for (uint32_t k = 0; k < gap; k++) {
                step_without_a_kink(0.05);
            }
        }
        for (uint32_t k = 0; reference_busy(&reference); k++) {
            step_without_a_kink(0.05);
            TEST_ASSERT_TRUE(k < 10000u);
        }
        TEST_ASSERT_EQUAL_INT32(target.turns, reference.next.position.turns);
        TEST_ASSERT_EQUAL_UINT32(target.fraction, reference.next.position.fraction);
    }
}

static void test_a_retarget_takes_the_time_of_a_jerk_limited_move(void)
{
    uint32_t periods = 0;

    /* 4 rad at 40 rad/s: 0.1 s of cruise speed, 70 ms of ramp: 1700 periods */
    go_to(position_from_rad(4.0, 50));
    while (reference_busy(&reference)) {
        step();
        periods++;
    }
    TEST_ASSERT_UINT32_WITHIN(3, 1702, periods);
}

static void test_a_plan_preempts_a_profile_in_any_phase(void)
{
    static const struct profile_drive drive = {.period_s = 1e-4,
                                               .rotor_teeth = 50,
                                               .speed_limit_rad_s = 200.0,
                                               .speed_limit_reason = "limit of the drive",
                                               .acceleration_limit_rad_s2 = 12000.0};
    static const struct profile_move move = {.shape = PROFILE_SMOOTH,
                                             .position_rad = 3.0,
                                             .duration_s = 0.2,
                                             .ramp_s = 0.08,
                                             .jerk_s = 0.02};
    char error[DESIGN_ERROR_TEXT];

    for (uint32_t at = 0; at < 2100u; at += 97u) {
        struct profile profile;

        reference_reset(&reference, origin);
        TEST_ASSERT_TRUE(profile_plan(&profile, origin, &move, &drive, error));
        TEST_ASSERT_TRUE(reference_load(&reference, &profile));
        for (uint32_t k = 0; k < at; k++) {
            step_without_a_kink(0.1);
        }
        go_to(position_from_rad(-1.0, 50));
        while (reference_busy(&reference)) {
            step_without_a_kink(0.1);
        }
        TEST_ASSERT_EQUAL_INT32(position_from_rad(-1.0, 50).turns, reference.next.position.turns);
    }
}

/* The copy that is run ahead is where the reference itself will be, bit for bit. */
static void test_what_is_foreseen_is_what_comes(void)
{
    go_at(limits.speed);
    for (uint32_t k = 0; k < 40; k++) {
        struct reference copy = reference;
        const uint32_t ahead = 1u + 37u * k;

        reference_skip(&copy, ahead);
        for (uint32_t i = 0; i < ahead; i++) {
            step();
        }
        is_at(&copy.at);
        TEST_ASSERT_EQUAL(reference.phase, copy.phase);
        if (k % 7u == 0u) {
            go_to(position_from_rad(k % 2u == 0u ? 5.0 : -5.0, 50));
        }
    }
}

static void test_a_plan_made_for_another_state_or_epoch_is_refused(void)
{
    struct motion_plan *plan;

    go_at(limits.speed);
    run_without_a_kink(100);
    plan = new_plan();
    motion_plan_speed(plan, &end, 0.0, &limits);
    step();
    TEST_ASSERT_FALSE(reference_preempt(&reference, plan));
    run_without_a_kink(700); /* the plan in force goes on */
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, limits.speed, motion_to_turns(reference.at.speed));

    plan = new_plan();
    motion_plan_speed(plan, &end, 0.0, &limits);
    reference_stop(&reference);
    TEST_ASSERT_FALSE(reference_preempt(&reference, plan));
    reference_reset(&reference, origin);
    plan = new_plan();
    motion_plan_speed(plan, &end, limits.speed, &limits);
    reference_reset(&reference, origin);
    TEST_ASSERT_FALSE(reference_preempt(&reference, plan));
}

/* ---- sine ---- */

static struct sine sine_of(double amplitude_rad, double frequency_Hz, double cycles, double ramp_s,
                           double period_s)
{
    const struct sine_task task = {.amplitude_turns = amplitude_rad * 50.0 / two_pi,
                                   .frequency_Hz = frequency_Hz,
                                   .cycles = cycles,
                                   .ramp_s = ramp_s,
                                   .period_s = period_s};

    return sine_design(&task);
}

/* Starts the sine; offers each continuation as soon as the one before is in force. */
static struct sine running;
static bool more;

static void append_tail(struct motion_plan *plan)
{
    struct motion_state tail = end;
    const struct motion_limits peaks = sine_peaks(&running);

    motion_plan_speed(plan, &tail, 0.0, &peaks);
}

static void start_sine(struct sine sine)
{
    struct motion_plan *plan = new_plan();

    running = sine;
    more = sine_continue(&running, plan, &end);
    if (more) {
        append_tail(plan);
    }
    must_preempt(plan);
}

static void supply_sine(void)
{
    if (more && reference.continuation == NULL) {
        struct motion_plan *plan = reference.plan == &plans[0] ? &plans[1] : &plans[0];

        motion_plan_begin(plan, &end, reference.epoch);
        more = sine_continue(&running, plan, &end);
        if (more) {
            append_tail(plan);
        }
        reference_continue(&reference, plan);
    }
}

/* Largest error in rad against the true sine, between the knots too. */
static double worst_error_of(struct sine sine, uint64_t periods)
{
    double worst = 0.0;

    reference_reset(&reference, origin);
    start_sine(sine);
    step();
    for (uint64_t t = 0; t <= periods; t++) {
        const double x =
            (double)reference.at.turns + (double)reference.at.fraction / 18446744073709551616.0;
        const double error = magnitude(x - sine_at(&sine, t).distance) * two_pi / 50.0;

        worst = error > worst ? error : worst;
        supply_sine();
        step();
    }
    return worst;
}

static void test_a_sine_is_followed_to_1e_8_rad_at_any_control_period(void)
{
    static const double periods_s[] = {1e-6, 7e-6, 5e-5, 1e-4, 2e-4, 1e-3};

    for (unsigned i = 0; i < sizeof periods_s / sizeof periods_s[0]; i++) {
        const double T = periods_s[i];
        const struct sine sine = sine_of(0.5, 5.0, 2.5, 0.1, T);

        TEST_ASSERT_DOUBLE_WITHIN(T > 2e-4 ? 2e-6 : 1e-8, 0.0, worst_error_of(sine, sine.periods));
        TEST_ASSERT_FALSE(reference_busy(&reference));
        TEST_ASSERT_EQUAL_INT32(0, reference.next.position.turns);
        TEST_ASSERT_EQUAL_UINT32(0, reference.next.position.fraction);
    }
}

/* An hour of it: no drift of the sum of so many segments. */
static void test_a_sine_without_end_does_not_drift(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.0,
                              worst_error_of(sine_of(0.5, 5.0, 0.0, 0.2, 1e-4), 4000000));
}

static void test_the_sine_itself_is_that_of_mathematics(void)
{
    const struct sine sine = sine_of(0.5, 4.0, 3.0, 0.0, 1e-4); /* 2500 periods */
    const double A = 0.5 * 50.0 / two_pi;
    const double root_half = 0.70710678118654752440;
    /* sin and cos of eighths of a cycle */
    const double values[8] = {0.0, root_half, 1.0, root_half, 0.0, -root_half, -1.0, -root_half};

    for (uint64_t eighth = 0; eighth < 24; eighth++) {
        const struct motion_target s = sine_at(&sine, eighth * 2500u / 8u);
        const double phase_error = (double)(eighth * 2500u % 8u) / 8.0 * sine.omega;

        if (phase_error == 0.0) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-13, A * values[eighth % 8u], s.distance);
            TEST_ASSERT_DOUBLE_WITHIN(1e-16, A * sine.omega * values[(eighth + 2u) % 8u], s.speed);
            TEST_ASSERT_DOUBLE_WITHIN(1e-18, -A * sine.omega * sine.omega * values[eighth % 8u],
                                      s.acceleration);
        }
    }
}

/* Its derivatives are those of its value, in the ramps too. */
static void test_the_speed_of_a_ramped_sine_is_the_slope_of_its_position(void)
{
    const struct sine sine = sine_of(0.5, 5.0, 4.0, 0.25, 1e-4);
    const struct motion_limits peaks = sine_peaks(&sine);

    for (uint64_t t = 1; t < sine.periods; t++) {
        const struct motion_target before = sine_at(&sine, t - 1);
        const struct motion_target here = sine_at(&sine, t);
        const struct motion_target after = sine_at(&sine, t + 1);

        TEST_ASSERT_DOUBLE_WITHIN(peaks.jerk, (after.distance - before.distance) / 2.0, here.speed);
        TEST_ASSERT_DOUBLE_WITHIN(peaks.jerk / 100.0,
                                  after.distance - 2.0 * here.distance + before.distance,
                                  here.acceleration);
        TEST_ASSERT_TRUE(magnitude(here.speed) <= peaks.speed);
        TEST_ASSERT_TRUE(magnitude(here.acceleration) <= peaks.acceleration);
        TEST_ASSERT_TRUE(magnitude(after.acceleration - here.acceleration) <= peaks.jerk);
    }
}

static void test_a_ramped_sine_begins_and_ends_without_a_kink(void)
{
    const struct sine sine = sine_of(0.5, 5.0, 3.0, 0.2, 1e-4);
    const struct motion_limits peaks = sine_peaks(&sine);
    double a0 = 0.0;
    double v0 = 0.0;

    start_sine(sine);
    for (int k = 0; k < 6010; k++) {
        supply_sine();
        step();
        const double a1 = motion_to_turns(reference.at.acceleration);
        const double v1 = motion_to_turns(reference.at.speed);

        TEST_ASSERT_TRUE(magnitude(a1 - a0) <= 1.01 * peaks.jerk);
        TEST_ASSERT_DOUBLE_WITHIN(1e-14, (a0 + a1) / 2.0, v1 - v0);
        a0 = a1;
        v0 = v1;
    }
    TEST_ASSERT_FALSE(reference_busy(&reference));
}

static void test_a_sine_without_a_ramp_begins_at_full_speed_with_no_acceleration(void)
{
    const double speed = two_pi * 5.0 * 0.5 * 50.0 / two_pi * 1e-4;

    start_sine(sine_of(0.5, 5.0, 0.5, 0.0, 1e-4));
    step();
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, speed, motion_to_turns(reference.at.speed));
    TEST_ASSERT_EQUAL_INT64(0, reference.at.acceleration);
    for (int k = 0; k < 1000; k++) {
        TEST_ASSERT_TRUE(reference.next.moving);
        supply_sine();
        step();
    }
    TEST_ASSERT_FALSE(reference.next.moving);
    TEST_ASSERT_EQUAL_INT64(0, reference.at.speed);
    TEST_ASSERT_EQUAL_UINT32(0, reference.next.position.fraction);
}

static void test_a_sine_whose_continuation_does_not_come_ends_at_rest(void)
{
    const struct sine sine = sine_of(0.5, 5.0, 0.0, 0.0, 1e-4);
    const struct motion_limits peaks = sine_peaks(&sine);

    start_sine(sine);
    step();
    for (int k = 0; reference_busy(&reference); k++) {
        const double a0 = motion_to_turns(reference.at.acceleration);

        step();
        TEST_ASSERT_TRUE(magnitude(motion_to_turns(reference.at.acceleration) - a0) <=
                         1.01 * peaks.jerk);
        TEST_ASSERT_TRUE(k < 5000);
    }
    TEST_ASSERT_EQUAL_INT64(0, reference.at.speed);
}

/* ---- set-points ---- */

/* A parabola is its own interpolation: nothing is lost in the set-points. */
static void test_set_points_on_a_parabola_give_the_parabola(void)
{
    enum { INTERVAL = 10, POINTS = 12 };
    const double a = 1e-6; /* turns per period^2 */
    struct set_points points;
    char error[DESIGN_ERROR_TEXT];

    set_points_begin(&points, origin, INTERVAL, &limits);
    for (int i = 1; i <= POINTS; i++) {
        const double t = (double)(i * INTERVAL);

        TEST_ASSERT_TRUE_MESSAGE(
            set_points_put(&points, position_from_rad(a / 2.0 * t * t * two_pi / 50.0, 50), error),
            error);
    }
    new_plan();
    for (int i = 1; i < POINTS; i++) {
        struct motion_plan plan;
        const double t = (double)(i * INTERVAL);

        motion_plan_begin(&plan, &end, reference.epoch);
        TEST_ASSERT_TRUE(set_points_continue(&points, &plan, &end));
        TEST_ASSERT_EQUAL_UINT32(3, plan.continues_after);
        TEST_ASSERT_DOUBLE_WITHIN(3e-10, a / 2.0 * t * t,
                                  (double)end.turns +
                                      (double)end.fraction / 18446744073709551616.0);
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, a * t, motion_to_turns(end.speed));
        TEST_ASSERT_DOUBLE_WITHIN(1e-11, a, motion_to_turns(end.acceleration));
    }
    TEST_ASSERT_FALSE(set_points_continue(&points, &plans[0], &end)); /* waits for the next one */
}

static void test_any_number_of_periods_from_three_on_reaches_its_target(void)
{
    const struct motion_target target = {.distance = 1e-3, .speed = 2e-4, .acceleration = -3e-6};

    for (uint32_t periods = 3; periods < 100; periods++) {
        struct motion_plan *plan = new_plan();

        motion_plan_transfer(plan, &end, &target, periods);
        TEST_ASSERT_EQUAL_UINT32(3, plan->segments);
        TEST_ASSERT_DOUBLE_WITHIN(
            1e-12, 1e-3, (double)end.turns + (double)end.fraction / 18446744073709551616.0);
        TEST_ASSERT_DOUBLE_WITHIN(1e-14, 2e-4, motion_to_turns(end.speed));
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, -3e-6, motion_to_turns(end.acceleration));
    }
}

static void test_a_set_point_too_far_away_is_refused(void)
{
    struct set_points points;
    char error[DESIGN_ERROR_TEXT];

    set_points_begin(&points, origin, 10, &limits);
    /* 800 rad/s^2 x (1 ms)^2 = 0.8 mrad from rest */
    TEST_ASSERT_FALSE(set_points_put(&points, position_from_rad(0.81e-3, 50), error));
    TEST_ASSERT_NOT_NULL(strstr(error, "acceleration"));
    TEST_ASSERT_TRUE(set_points_put(&points, position_from_rad(0.79e-3, 50), error));
    points.limits.acceleration = 1.0;
    TEST_ASSERT_FALSE(set_points_put(&points, position_from_rad(0.0415, 50), error));
    TEST_ASSERT_NOT_NULL(strstr(error, "speed"));
}

/* ---- what a sample shows ---- */

static void test_the_jerk_shown_is_the_change_of_the_acceleration_shown(void)
{
    go_to(position_from_rad(2.0, 50));
    step();
    for (int k = 0; reference.next.moving; k++) {
        const double jerk = num_to_double(reference_jerk(&reference, &params));
        const double before = num_to_double(reference.next.acceleration);

        step();
        TEST_ASSERT_DOUBLE_WITHIN(3e-6, num_to_double(reference.next.acceleration) - before, jerk);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, num_to_double(reference_jerk(&reference, &params)));
}

static double jerk_shown(int64_t jerk)
{
    reference.jerks = true;
    reference.jerk = jerk;
    return num_to_double(reference_jerk(&reference, &params));
}

/* 2^-11 turn, 61e6 rad/s^3: 61e6 x 1e-4 s of 6000 rad/s^2 in a period. */
static void test_a_jerk_beyond_its_range_is_shown_as_the_end_of_it(void)
{
    const int64_t range = (int64_t)1 << 53;
    const double most = two_pi / 50.0 / 2048.0 / 1e-12 * 1e-4 / 6000.0;

    TEST_ASSERT_DOUBLE_WITHIN(1e-4, most, jerk_shown(range - 1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, most, jerk_shown(range));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, most, jerk_shown(INT64_MAX));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, -most, jerk_shown(-range));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, -most, jerk_shown(-range - 1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, -most, jerk_shown(INT64_MIN));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, most / 2.0, jerk_shown(range / 2));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, -most / 2.0, jerk_shown(-range / 2));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_closed_form_is_the_sum_of_the_additions_bit_for_bit);
    RUN_TEST(test_a_speed_is_reached_without_a_kink_and_kept);
    RUN_TEST(test_where_a_speed_is_reached_there_is_no_acceleration);
    RUN_TEST(test_speeds_follow_one_another_in_mid_change);
    RUN_TEST(test_a_new_target_is_reached_exactly_from_any_motion);
    RUN_TEST(test_a_retarget_takes_the_time_of_a_jerk_limited_move);
    RUN_TEST(test_a_plan_preempts_a_profile_in_any_phase);
    RUN_TEST(test_what_is_foreseen_is_what_comes);
    RUN_TEST(test_a_plan_made_for_another_state_or_epoch_is_refused);
    RUN_TEST(test_a_sine_is_followed_to_1e_8_rad_at_any_control_period);
    RUN_TEST(test_a_sine_without_end_does_not_drift);
    RUN_TEST(test_the_sine_itself_is_that_of_mathematics);
    RUN_TEST(test_the_speed_of_a_ramped_sine_is_the_slope_of_its_position);
    RUN_TEST(test_a_ramped_sine_begins_and_ends_without_a_kink);
    RUN_TEST(test_a_sine_without_a_ramp_begins_at_full_speed_with_no_acceleration);
    RUN_TEST(test_a_sine_whose_continuation_does_not_come_ends_at_rest);
    RUN_TEST(test_set_points_on_a_parabola_give_the_parabola);
    RUN_TEST(test_any_number_of_periods_from_three_on_reaches_its_target);
    RUN_TEST(test_a_set_point_too_far_away_is_refused);
    RUN_TEST(test_the_jerk_shown_is_the_change_of_the_acceleration_shown);
    RUN_TEST(test_a_jerk_beyond_its_range_is_shown_as_the_end_of_it);
    return UNITY_END();
}
