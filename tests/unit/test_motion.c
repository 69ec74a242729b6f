/* The reference generator: where the drive is to be, period by period. */
#include <string.h>
#include <unity.h>

#include "firmware/design/elementary.h"
#include "firmware/motion/reference.h"

static const double two_pi = 6.283185307179586476925;

/* 10 kHz, 50 teeth; 150 rad/s and 6000 rad/s^2 are one per-unit. */
static const struct profile_drive drive = {.period_s = 1e-4,
                                           .rotor_teeth = 50,
                                           .speed_limit_rad_s = 200.0,
                                           .speed_limit_reason = "limit of the drive",
                                           .acceleration_limit_rad_s2 = 12000.0};
static const struct per_unit base = {.speed_rad_s = 150.0,
                                     .acceleration_rad_s2 = 6000.0,
                                     .rad_per_turn = 6.283185307179586476925 / 50.0,
                                     .turns_per_period =
                                         150.0 * 1e-4 * 50.0 / 6.283185307179586476925};
static const struct position origin = {0, 0};

static const struct profile_move trapezoid = {
    .shape = PROFILE_TRAPEZOID, .position_rad = 15.0, .duration_s = 0.43, .ramp_s = 0.1};
static const struct profile_move smooth = {.shape = PROFILE_SMOOTH,
                                           .position_rad = -10.0,
                                           .duration_s = 0.40,
                                           .ramp_s = 0.1,
                                           .jerk_s = 0.03};

static struct reference_params params;
static struct reference reference;
static struct profile profile; /* the one the reference has begun */
static char error[DESIGN_ERROR_TEXT];

void setUp(void)
{
    params = reference_design(&base, drive.period_s, (struct creep_limits){0.0, 0.0});
    reference_reset(&reference, origin);
}

void tearDown(void)
{
}

/* Electrical turns in 2^-32. */
static int64_t angle_of(struct position p)
{
    return p.turns * ((int64_t)1 << 32) + p.fraction;
}

static double turns_of(struct position p)
{
    return (double)angle_of(p) / 4294967296.0;
}

static double turns_of_rad(double rad)
{
    return rad * 50.0 / two_pi;
}

static double round_to_int(double x)
{
    return (double)(int64_t)(x + 0.5);
}

static struct profile plan(const struct profile_move *move)
{
    struct profile planned;

    TEST_ASSERT_TRUE_MESSAGE(profile_plan(&planned, reference.next.position, move, &drive, error),
                             error);
    return planned;
}

static void period(const struct reference_params *with, bool held)
{
    if (!reference_step(&reference, with)) {
        (void)reference_turn(&reference, with, held);
    }
}

static struct reference_sample step(void)
{
    period(&params, false);
    return reference.next;
}

static void load(const struct profile_move *move)
{
    profile = plan(move);
    TEST_ASSERT_TRUE(reference_load(&reference, &profile));
}

/* Loads a move behind a step, which gives the reference at the start of the profile. */
static void begin(const struct profile_move *move)
{
    const struct position start = reference.next.position;

    TEST_ASSERT_FALSE(step().moving);
    load(move);
    TEST_ASSERT_TRUE(reference_busy(&reference));
    TEST_ASSERT_EQUAL_INT64(angle_of(start), angle_of(reference.next.position));
}

static void run_to_rest(void)
{
    while (step().moving) {
    }
}

/* x, v, a of the continuous profile at a time in periods: integrated from the jerk alone. */
struct motion {
    double x, v, a;
};

static struct motion continuous(const struct profile_move *move, double start, double time)
{
    double T = drive.period_s;
    double duration = round_to_int(move->duration_s / T);
    double ramp = round_to_int(move->ramp_s / T);
    double jerk_time = round_to_int(move->jerk_s / T);
    double distance = turns_of(position_from_rad(move->position_rad, 50)) - start;
    double acceleration = distance / (duration - ramp) / (ramp - jerk_time);
    double corner[8] = {0.0,
                        jerk_time,
                        ramp - jerk_time,
                        ramp,
                        duration - ramp,
                        duration - ramp + jerk_time,
                        duration - jerk_time,
                        duration};
    double at_corner[8] = {0.0, acceleration,  acceleration,  0.0,
                           0.0, -acceleration, -acceleration, 0.0};
    struct motion m = {start, 0.0, 0.0};

    for (int i = 0; i < 7; i++) {
        double length = corner[i + 1] - corner[i];
        double t = time < corner[i + 1] ? time - corner[i] : length;

        if (length <= 0.0 || t < 0.0) {
            continue;
        }
        double jerk = (at_corner[i + 1] - at_corner[i]) / length;
        m.x += m.v * t + at_corner[i] * t * t / 2.0 + jerk * t * t * t / 6.0;
        m.v += at_corner[i] * t + jerk * t * t / 2.0;
        m.a = at_corner[i] + jerk * t;
    }
    return m;
}

static void follows_the_continuous_profile(const struct profile_move *move)
{
    const double turn_rad_s = two_pi / 50.0 / drive.period_s;
    const double periods = round_to_int(move->duration_s / drive.period_s);
    const double start = turns_of(reference.next.position);

    begin(move);
    for (double t = 0.0; t <= periods; t += 1.0) {
        struct reference_sample s = step();
        struct motion m = continuous(move, start, t);

        TEST_ASSERT_DOUBLE_WITHIN(1e-9, m.x, turns_of(s.position));
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, m.v * turn_rad_s / 150.0, num_to_double(s.speed));
        if (t < periods && move->shape == PROFILE_SMOOTH) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-4, m.a * turn_rad_s / drive.period_s / 6000.0,
                                      num_to_double(s.acceleration));
        }
        TEST_ASSERT_EQUAL(t < periods, s.moving);
    }
}

static void test_a_trapezoid_follows_its_continuous_profile(void)
{
    follows_the_continuous_profile(&trapezoid);
}

static void test_a_smooth_move_follows_its_continuous_profile(void)
{
    follows_the_continuous_profile(&smooth);
}

static void test_moves_follow_one_another_across_zero_and_back(void)
{
    struct profile_move move = smooth;

    follows_the_continuous_profile(&smooth);
    move.position_rad = 3.0;
    follows_the_continuous_profile(&move);
    follows_the_continuous_profile(&trapezoid);
    move.position_rad = 15.0; /* no distance: a dwell */
    follows_the_continuous_profile(&move);
}

static void test_15_rad_in_430_ms_cruises_at_45_rad_s_and_lands_exactly(void)
{
    struct reference_sample s;
    struct position before;

    begin(&trapezoid);
    for (int k = 0; k < 2000; k++) {
        s = step();
    }
    before = s.position;
    s = step();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 15.0 / 0.33,
                              (turns_of(s.position) - turns_of(before)) * two_pi / 50.0 / 1e-4);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 15.0 / 0.33, num_to_double(s.speed) * 150.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, num_to_double(s.acceleration));
    run_to_rest();
    TEST_ASSERT_EQUAL_INT64(angle_of(position_from_rad(15.0, 50)),
                            angle_of(reference.next.position));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, num_to_double(reference.next.speed));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, num_to_double(reference.next.acceleration));
}

static void test_a_trapezoid_shows_the_acceleration_that_acts_from_the_sample_on(void)
{
    const double acceleration = 15.0 / 0.33 / 0.1 / 6000.0;

    begin(&trapezoid);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, acceleration, num_to_double(step().acceleration));
    for (int k = 1; k < 1000; k++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, acceleration, num_to_double(step().acceleration));
    }
    for (int k = 1000; k < 3300; k++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, num_to_double(step().acceleration));
    }
    for (int k = 3300; k < 4300; k++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, -acceleration, num_to_double(step().acceleration));
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, num_to_double(step().acceleration));
}

static void test_the_speed_shown_is_right_to_1e_5_for_any_base(void)
{
    for (double base_rad_s = 40.0; base_rad_s < 400.0; base_rad_s *= 1.07) {
        struct per_unit other = base;

        other.speed_rad_s = base_rad_s;
        other.turns_per_period = turns_of_rad(base_rad_s * drive.period_s);
        params = reference_design(&other, drive.period_s, (struct creep_limits){0.0, 0.0});
        reference_reset(&reference, origin);
        begin(&trapezoid);
        for (int k = 0; k <= 1001; k++) {
            step();
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, 15.0 / 0.33 / base_rad_s,
                                  num_to_double(reference.next.speed));
    }
}

static void test_slow_and_fast_moves_land_without_a_correction(void)
{
    /* The last period must cover what the profile leaves for it, to 2^-32 turn and rounding. */
    static const struct profile_move moves[] = {
        {PROFILE_TRAPEZOID, 1e-6, 20.0, 10.0, 0.0},
        {PROFILE_TRAPEZOID, -4.7, 0.05, 0.0163, 0.0},
        {PROFILE_TRAPEZOID, 0.0002, 0.0004, 0.0002, 0.0},
        {PROFILE_SMOOTH, 1e-6, 20.0, 10.0, 5.0},
        {PROFILE_SMOOTH, -1234.5678, 30.0, 7.0, 1.0},
        {PROFILE_SMOOTH, 3.3, 0.0501, 0.0250, 0.0125},
        {PROFILE_SMOOTH, 0.0002, 0.0006, 0.0003, 0.0001},
    };

    for (unsigned i = 0; i < sizeof moves / sizeof moves[0]; i++) {
        struct motion before_last;

        reference_reset(&reference, origin);
        begin(&moves[i]);
        run_to_rest();
        before_last =
            continuous(&moves[i], 0.0, round_to_int(moves[i].duration_s / drive.period_s) - 1.0);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, before_last.x, turns_of(reference.now.position));
        TEST_ASSERT_EQUAL_INT64(angle_of(profile.target), angle_of(reference.next.position));
    }
}

static void test_a_million_turns_are_covered_without_loss(void)
{
    const struct profile_move there = {.shape = PROFILE_SMOOTH,
                                       .position_rad = 1e6 * 6.283185307179586476925 / 50.0,
                                       .duration_s = 630.0,
                                       .ramp_s = 1.3,
                                       .jerk_s = 0.31};
    struct profile_move back = there;
    uint32_t periods = 0;
    int64_t last;

    back.position_rad = 0.0;
    begin(&there);
    do {
        periods++;
    } while (step().moving);
    TEST_ASSERT_EQUAL_UINT32(6300001, periods);
    TEST_ASSERT_EQUAL_INT64((int64_t)1000000 << 32, angle_of(reference.next.position));
    /* J/6 of the last period is 4e-9 turn; what the snap to the target adds must be far below. */
    last = angle_of(reference.next.position) - angle_of(reference.now.position);
    TEST_ASSERT_INT64_WITHIN(2, profile.jerk_sixth >> 32, last);

    begin(&back);
    run_to_rest();
    TEST_ASSERT_EQUAL_INT64(0, angle_of(reference.next.position));
}

static void test_positions_go_round_at_two_to_the_31_turns(void)
{
    const struct position last = {INT32_MAX, 0xc0000000u};
    struct motion_state end = {.turns = last.turns, .fraction = (uint64_t)last.fraction << 32};

    reference_reset(&reference, last);
    TEST_ASSERT_EQUAL_INT64(INT32_MAX, position_distance(last, position_add(last, INT32_MAX)));

    end.speed = (int64_t)1 << 62; /* a quarter of a turn per period */
    motion_run(&end, 0, 3u);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, end.turns);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, motion_position(&end).turns);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -0.75, motion_distance(&end, last));
    end.fraction = UINT64_MAX;
    TEST_ASSERT_EQUAL_INT32(INT32_MIN + 1, motion_position(&end).turns);
    end.fraction = (uint64_t)1 << 63;

    reference.at.speed = end.speed;
    reference.periods_left = 4u;
    for (int period = 0; period < 3; period++) {
        reference_advance(&reference);
    }
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, reference.next.position.turns);
    TEST_ASSERT_EQUAL_INT64(angle_of_position(motion_position(&end)),
                            angle_of_position(reference.next.position));
}

static void test_a_smooth_move_has_bounded_jerk_and_continuous_acceleration(void)
{
    /* From the positions alone; 2^-32 turn of resolution is worth 8 x 2^-32 in a third difference.
     */
    const double acceleration = turns_of_rad(10.0) / 3000.0 / 700.0;
    const double jerk = acceleration / 300.0;
    double x[4] = {0.0, 0.0, 0.0, 0.0};
    double largest = 0.0;

    begin(&smooth);
    for (int k = 0; k <= 4003; k++) {
        x[0] = x[1];
        x[1] = x[2];
        x[2] = x[3];
        x[3] = turns_of(step().position);
        double third = magnitude(x[3] - 3.0 * x[2] + 3.0 * x[1] - x[0]);
        largest = third > largest ? third : largest;
        TEST_ASSERT_TRUE(magnitude(x[3] - 2.0 * x[2] + x[1]) <= acceleration + 1e-9);
    }
    TEST_ASSERT_DOUBLE_WITHIN(3e-9, jerk, largest);
}

static uint32_t periods_of(double time_s)
{
    return (uint32_t)(time_s / drive.period_s + 0.5);
}

/*
 * Stops `move` in period `at` and checks how it comes to rest. Returns the periods it still moves
 * for after the one that shows position `at` of the profile.
 */
static uint32_t stops_without_a_kink(const struct profile_move *move, uint32_t at)
{
    const uint32_t duration = periods_of(move->duration_s);
    const uint32_t ramp = periods_of(move->ramp_s);
    const uint32_t jerk = periods_of(move->jerk_s);
    const double distance = turns_of_rad(move->position_rad);
    const double acceleration = magnitude(distance) / (duration - ramp) / (ramp - jerk);
    const double sign = distance < 0.0 ? -1.0 : 1.0;
    double x[4] = {0.0, 0.0, 0.0, 0.0};
    uint32_t periods = 0;
    int at_rest = 0;

    reference_reset(&reference, origin);
    begin(move);
    for (uint32_t k = 0; at_rest < 3; k++) {
        if (k == at) {
            reference_stop(&reference);
        }
        x[0] = x[1];
        x[1] = x[2];
        x[2] = x[3];
        x[3] = sign * turns_of(step().position);
        periods += (k > at && reference.next.moving) ? 1u : 0u;
        at_rest += reference.next.moving ? 0 : 1;

        TEST_ASSERT_TRUE(x[3] - x[2] >= -1e-9); /* never backwards */
        TEST_ASSERT_TRUE(magnitude(x[3] - 2.0 * x[2] + x[1]) <= acceleration + 1e-9);
        if (jerk > 0u) {
            TEST_ASSERT_TRUE(magnitude(x[3] - 3.0 * x[2] + 3.0 * x[1] - x[0]) <=
                             acceleration / jerk + 3e-9);
        }
        TEST_ASSERT_TRUE_MESSAGE(k <= duration + 3u, "does not come to rest");
    }
    return periods;
}

/*
 * Periods from a stop to rest: one more of the present phase, then the ramp up is mirrored from
 * where it stands, its last, easing part run to its end. Where `at` is the corner to a new phase,
 * that phase begins first.
 */
static uint32_t stopping_periods(const struct profile_move *move, uint32_t at)
{
    const uint32_t duration = periods_of(move->duration_s);
    const uint32_t ramp = periods_of(move->ramp_s);
    const uint32_t jerk = periods_of(move->jerk_s);

    if ((jerk > 0u && (at == jerk || at == ramp - jerk)) || at == ramp) {
        return 1u + stopping_periods(move, at + 1u);
    }
    return at < jerk              ? 3u * (at + 1u)
           : at < ramp - jerk     ? 2u * jerk + at + 1u
           : at < ramp            ? 2u * ramp - 1u - at
           : at < duration - ramp ? ramp
                                  : duration - 1u - at;
}

static void stops_from_any_point(const struct profile_move *move)
{
    static const uint32_t corners[] = {1, 300, 700, 1000, 3000, 3300, 3700, 3996};

    for (uint32_t at = 1; at < 4000u; at += 83u) {
        TEST_ASSERT_EQUAL_UINT32(stopping_periods(move, at), stops_without_a_kink(move, at));
    }
    for (unsigned i = 0; i < sizeof corners / sizeof corners[0]; i++) {
        for (uint32_t at = corners[i] - (i > 0u ? 3u : 0u); at <= corners[i] + 3u; at++) {
            TEST_ASSERT_EQUAL_UINT32(stopping_periods(move, at), stops_without_a_kink(move, at));
        }
    }
}

static void test_a_trapezoid_stops_from_any_point_with_its_own_deceleration(void)
{
    struct profile_move move = trapezoid;

    move.duration_s = 0.4;
    stops_from_any_point(&move);
}

static void test_a_smooth_move_stops_from_any_point_with_its_own_jerk(void)
{
    stops_from_any_point(&smooth);
}

static void test_a_move_with_phases_of_one_period_stops_in_any_of_them(void)
{
    static const struct profile_move moves[] = {
        {PROFILE_TRAPEZOID, 0.0002, 0.0004, 0.0002, 0.0},
        {PROFILE_TRAPEZOID, -0.0002, 0.0005, 0.0002, 0.0},
        {PROFILE_SMOOTH, 0.0002, 0.0004, 0.0002, 0.0001},
        {PROFILE_SMOOTH, -0.0002, 0.0005, 0.0002, 0.0001},
        {PROFILE_SMOOTH, 0.0002, 0.0006, 0.0003, 0.0001},
        {PROFILE_SMOOTH, 0.0002, 0.0007, 0.0003, 0.0001},
        {PROFILE_SMOOTH, 0.0002, 0.0011, 0.0005, 0.0002},
    };

    for (unsigned i = 0; i < sizeof moves / sizeof moves[0]; i++) {
        for (uint32_t at = 1; at <= periods_of(moves[i].duration_s) + 1u; at++) {
            struct profile_move onwards = smooth;

            stops_without_a_kink(&moves[i], at);
            onwards.position_rad = 5.0;
            follows_the_continuous_profile(&onwards); /* the stop is over and done with */
        }
    }
}

static void test_a_stop_while_decelerating_still_lands_on_the_target(void)
{
    begin(&trapezoid);
    for (int k = 0; k < 3500; k++) {
        step();
    }
    reference_stop(&reference);
    run_to_rest();
    TEST_ASSERT_EQUAL_INT64(angle_of(position_from_rad(15.0, 50)),
                            angle_of(reference.next.position));
}

static void test_a_move_stopped_before_it_begins_stays_where_it_is(void)
{
    const struct profile_move jump = {.shape = PROFILE_STEP, .position_rad = 1.0};
    const struct profile_move *moves[] = {&trapezoid, &smooth, &jump};

    for (int i = 0; i < 3; i++) {
        load(moves[i]);
        reference_stop(&reference);
        for (int k = 0; k < 3; k++) {
            struct reference_sample s = step();

            TEST_ASSERT_FALSE(s.moving);
            TEST_ASSERT_EQUAL_INT64(0, angle_of(s.position));
            TEST_ASSERT_TRUE(s.speed == NUM(0.0) && s.acceleration == NUM(0.0));
        }
    }
}

static void test_a_stop_at_rest_leaves_the_next_move_alone(void)
{
    reference_stop(&reference);
    begin(&trapezoid);
    run_to_rest();
    TEST_ASSERT_EQUAL_INT64(angle_of(position_from_rad(15.0, 50)),
                            angle_of(reference.next.position));
}

static void test_a_stop_shortens_the_profile_that_was_begun(void)
{
    begin(&trapezoid);
    for (int k = 0; k < 700; k++) {
        step();
    }
    reference_stop(&reference);
    run_to_rest();
    TEST_ASSERT_EQUAL_UINT32(701, profile.acceleration_periods);
    TEST_ASSERT_EQUAL_UINT32(0, profile.cruise_periods);
    TEST_ASSERT_TRUE(turns_of(profile.target) > turns_of(reference.next.position));
}

static void test_a_profile_begins_with_the_step_behind_its_load(void)
{
    const struct profile_move *moves[] = {&trapezoid, &smooth};

    for (int i = 0; i < 2; i++) {
        const int64_t there = angle_of(reference.next.position);

        load(moves[i]);
        TEST_ASSERT_TRUE(reference_busy(&reference));
        TEST_ASSERT_EQUAL_UINT32(0, reference.periods_left);
        TEST_ASSERT_TRUE(step().moving);
        TEST_ASSERT_EQUAL_INT64(there, angle_of(reference.next.position));
        TEST_ASSERT_TRUE(reference.periods_left > 0u);
        step();
        TEST_ASSERT_TRUE(angle_of(reference.next.position) != there);
        run_to_rest();
    }
}

static void test_after_a_stop_a_move_starts_from_where_the_reference_rests(void)
{
    struct profile follow_on;
    struct profile_move back = smooth;

    begin(&trapezoid);
    TEST_ASSERT_TRUE(profile_plan(&follow_on, profile.target, &smooth, &drive, error));
    for (int k = 0; k < 700; k++) {
        step();
    }
    reference_stop(&reference);
    run_to_rest();
    TEST_ASSERT_FALSE(reference_load(&reference, &follow_on)); /* planned from the old target */
    back.position_rad = 0.0;
    follows_the_continuous_profile(&back);
    TEST_ASSERT_EQUAL_INT64(0, angle_of(reference.next.position));
}

static void test_a_move_is_refused_while_another_one_runs(void)
{
    struct profile next;

    begin(&trapezoid);
    next = plan(&smooth);
    TEST_ASSERT_FALSE(reference_load(&reference, &next));
    while (step().moving) {
        TEST_ASSERT_FALSE(reference_load(&reference, &next));
    }
    next = plan(&smooth);
    TEST_ASSERT_TRUE(reference_load(&reference, &next));
    TEST_ASSERT_FALSE(reference_load(&reference, &next));
}

static void test_a_move_planned_from_elsewhere_is_refused(void)
{
    struct profile stray = plan(&trapezoid);

    stray.start = (struct position){1, 0};
    TEST_ASSERT_FALSE(reference_load(&reference, &stray));
    stray.start = (struct position){0, 1};
    TEST_ASSERT_FALSE(reference_load(&reference, &stray));
    TEST_ASSERT_FALSE(step().moving);
}

static void test_a_reset_in_full_motion_leaves_nothing_of_it(void)
{
    const struct position elsewhere = {-3, 0x12345678u};

    begin(&smooth);
    for (int k = 0; k < 500; k++) {
        step();
    }
    reference_stop(&reference);
    reference_reset(&reference, elsewhere);
    TEST_ASSERT_EQUAL_INT64(angle_of(elsewhere), angle_of(reference.now.position));
    for (int k = 0; k < 3; k++) {
        struct reference_sample s = step();

        TEST_ASSERT_EQUAL_INT64(angle_of(elsewhere), angle_of(reference.now.position));
        TEST_ASSERT_EQUAL_INT64(angle_of(elsewhere), angle_of(s.position));
        TEST_ASSERT_TRUE(s.speed == NUM(0.0) && s.acceleration == NUM(0.0) && !s.moving);
    }
    TEST_ASSERT_EQUAL_UINT32(3, reference.slow_periods);

    load(&smooth);
    reference_reset(&reference, elsewhere);
    TEST_ASSERT_FALSE(step().moving);
    begin(&smooth);
    step();
    reference_stop(&reference);
    reference_reset(&reference, elsewhere);
    follows_the_continuous_profile(&trapezoid);
}

static void test_a_step_is_there_at_once(void)
{
    const struct profile_move jump = {.shape = PROFILE_STEP, .position_rad = -0.03142};
    struct reference_sample s;

    begin(&jump);
    s = step();
    TEST_ASSERT_EQUAL_INT64(0, angle_of(reference.now.position));
    TEST_ASSERT_EQUAL_INT64(angle_of(position_from_rad(-0.03142, 50)), angle_of(s.position));
    TEST_ASSERT_FALSE(s.moving);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, num_to_double(s.speed));
    TEST_ASSERT_EQUAL_UINT32(0, reference.slow_periods);
}

static void test_each_step_hands_the_next_sample_on_as_the_present_one(void)
{
    struct reference_sample before = reference.next;

    load(&smooth);
    for (int k = 0; k < 4100; k++) {
        struct reference_sample s = step();

        TEST_ASSERT_EQUAL_INT64(angle_of(before.position), angle_of(reference.now.position));
        TEST_ASSERT_EQUAL_UINT32(num_bits(before.speed), num_bits(reference.now.speed));
        TEST_ASSERT_EQUAL(before.moving, reference.now.moving);
        before = s;
    }
}

static void test_the_time_at_rest_is_counted_from_the_end_of_the_move(void)
{
    step();
    step();
    TEST_ASSERT_EQUAL_UINT32(2, reference.slow_periods);
    begin(&trapezoid);
    step();
    while (step().moving) {
        TEST_ASSERT_EQUAL_UINT32(0, reference.slow_periods);
    }
    step();
    TEST_ASSERT_EQUAL_UINT32(1, reference.slow_periods);
    reference.slow_periods = UINT32_MAX;
    step();
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, reference.slow_periods);
}

/* The smooth move: with a held rotor its begin and end creep, else its cruise alone could. */
static void creep_is_counted(bool held, double speed, double acceleration)
{
    struct reference_params creeping = params;
    uint32_t slow = 0;
    uint32_t most = 0;

    creeping.creep_speed = num_from_double(speed);
    creeping.creep_acceleration = num_from_double(acceleration);
    for (int k = 0; k < 10; k++) {
        period(&creeping, held);
    }
    TEST_ASSERT_EQUAL_UINT32(10, reference.slow_periods);
    load(&smooth);
    reference.creeps = true;
    while (!reference.next.moving) {
        period(&creeping, held);
    }
    while (reference.next.moving) {
        const struct reference_sample *next = &reference.next;
        const bool slowly = num_abs(next->speed) < creeping.creep_speed;
        const bool gently =
            num_abs(next->acceleration) <= (held ? creeping.creep_acceleration : NUM(0.0));

        slow = slowly && gently ? reference.slow_periods + 1u : 0u;
        most = slow > most ? slow : most;
        period(&creeping, held);
        TEST_ASSERT_EQUAL_UINT32(slow, reference.slow_periods);
    }
    TEST_ASSERT_TRUE(most > 3u);
    TEST_ASSERT_TRUE(most < 4000u);
}

static void test_a_held_rotor_stays_so_while_the_reference_is_slow_and_gentle(void)
{
    creep_is_counted(true, 0.05, 0.001);
}

static void test_a_moving_rotor_is_slow_in_a_slow_cruise_alone(void)
{
    creep_is_counted(false, 3.9, 0.001);
}

/* The cruise is at 33.3 rad/s. */
static void test_a_move_creeps_that_is_never_faster_than_creep(void)
{
    struct profile_drive slow = drive;

    TEST_ASSERT_TRUE(profile_plan(&profile, reference.next.position, &smooth, &slow, error));
    TEST_ASSERT_FALSE(profile.creeps);
    slow.creep_rad_s = 34.0;
    TEST_ASSERT_TRUE(profile_plan(&profile, reference.next.position, &smooth, &slow, error));
    TEST_ASSERT_TRUE(profile.creeps);
    slow.creep_rad_s = 33.0;
    TEST_ASSERT_TRUE(profile_plan(&profile, reference.next.position, &smooth, &slow, error));
    TEST_ASSERT_FALSE(profile.creeps);
}

static void test_without_a_creep_speed_whatever_moves_is_not_slow(void)
{
    load(&smooth);
    while (!reference.next.moving) {
        step();
    }
    while (reference.next.moving) {
        step();
        TEST_ASSERT_EQUAL_UINT32(0, reference.slow_periods);
    }
}

/* FNV-1a over the positions of trapezoid, smooth move and a stop. */
static void test_the_positions_are_the_same_bits_in_every_number_format(void)
{
    uint64_t hash = 14695981039346656037u;
    struct profile_move again = trapezoid;

    again.position_rad = 7.0;
    for (int move = 0; move < 3; move++) {
        begin(move == 0 ? &trapezoid : (move == 1 ? &smooth : &again));
        do {
            step();
            for (int byte = 0; byte < 8; byte++) {
                hash ^= (uint64_t)(angle_of(reference.next.position) >> (8 * byte)) & 0xffu;
                hash *= 1099511628211u;
            }
            if (move == 2 && reference.next.position.turns == 0) {
                reference_stop(&reference);
            }
        } while (reference.next.moving);
    }
    TEST_ASSERT_EQUAL_HEX64(0x3769D377FADF97BF, hash);
}

static void refuses(struct profile_move move, const char *text)
{
    struct profile planned;

    error[0] = '\0';
    TEST_ASSERT_FALSE_MESSAGE(profile_plan(&planned, origin, &move, &drive, error), text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, text), error);
}

static void test_a_move_out_of_range_is_refused_with_the_bound_it_breaks(void)
{
    static const double nan = __builtin_nan("");
    static const double infinity = __builtin_inf();
    const struct {
        double position_rad, duration_s, ramp_s, jerk_s;
        const char *text;
    } bad[] = {
        {nan, 0.4, 0.1, 0.02, "position"},
        {infinity, 0.4, 0.1, 0.02, "position"},
        {-1.3e8, 0.4, 0.1, 0.02, "position"},
        {1.0, nan, 0.1, 0.02, "duration"},
        {1.0, infinity, 0.1, 0.02, "duration"},
        {1.0, 0.0, 0.1, 0.02, "duration"},
        {1.0, -0.4, 0.1, 0.02, "duration"},
        {1.0, 0.0003, 0.0001, 0.0001, "duration"},
        {1.0, 1.1e5, 0.1, 0.02, "duration"},
        {1.0, 0.4, nan, 0.02, "ramp"},
        {1.0, 0.4, -0.1, 0.02, "ramp"},
        {1.0, 0.4, 0.0, 0.0, "ramp"},
        {1.0, 0.4, 0.0001, 0.0001, "ramp"},
        {1.0, 0.4, 0.2001, 0.02, "ramp"},
        {1.0, 400.0, 105.0, 0.02, "ramp"},
        {1.0, 0.4, 0.1, nan, "jerk time"},
        {1.0, 0.4, 0.1, 0.0, "jerk time"},
        {1.0, 0.4, 0.1, -0.02, "jerk time"},
        {1.0, 0.4, 0.1, 0.0501, "jerk time"},
        {61.0, 0.4, 0.1, 0.02, "cruise speed"},
        {-61.0, 0.4, 0.1, 0.02, "cruise speed"},
        {12.0, 0.1, 0.01, 0.002, "acceleration"},
        {-12.0, 0.1, 0.01, 0.002, "acceleration"},
    };

    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct profile_move move = {PROFILE_SMOOTH, bad[i].position_rad, bad[i].duration_s,
                                    bad[i].ramp_s, bad[i].jerk_s};
        refuses(move, bad[i].text);
        move.shape = PROFILE_TRAPEZOID;
        if (strcmp(bad[i].text, "jerk time") != 0) {
            refuses(move, bad[i].text);
        }
        move.shape = PROFILE_STEP;
        if (strcmp(bad[i].text, "position") == 0) {
            refuses(move, bad[i].text);
        }
    }
}

static void test_a_refusal_names_the_value_and_the_bound(void)
{
    struct profile_move move = trapezoid;

    move.ramp_s = 0.25;
    refuses(move, "ramp 0.25 s: must be at most 0.215 s");
    move.ramp_s = -1.0;
    refuses(move, "ramp -1 s: must be at least 0.0002 s");
    move = smooth;
    move.jerk_s = 0.06;
    refuses(move, "jerk time 0.06 s: must be at most 0.05 s");
    move.jerk_s = 0.0;
    refuses(move, "jerk time 0 s: must be at least 0.0001 s");
    move = trapezoid;
    move.duration_s = 0.0001;
    refuses(move, "duration 0.0001 s: must be at least 0.0004 s");
    move = trapezoid;
    move.position_rad = 99.0;
    refuses(move, "cruise speed 300 rad/s: must be at most 200 rad/s");
}

static void test_the_range_of_the_reference_binds_where_the_drive_sets_no_limit(void)
{
    const struct profile_drive unlimited = {.period_s = 1e-4,
                                            .rotor_teeth = 50,
                                            .speed_limit_rad_s = 1e9,
                                            .acceleration_limit_rad_s2 = 1e9};
    struct profile_move move = trapezoid;
    struct profile planned;

    /* 0.45 turn per period is 565.49 rad/s */
    move.position_rad = 0.33 * 565.0;
    TEST_ASSERT_TRUE(profile_plan(&planned, origin, &move, &unlimited, error));
    move.position_rad = 0.33 * 566.0;
    TEST_ASSERT_FALSE(profile_plan(&planned, origin, &move, &unlimited, error));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, "at most 565.5 rad/s"), error);
    /* 2^-7 turn per period^2 is 98175 rad/s^2 */
    move.duration_s = 0.1;
    move.ramp_s = 0.005;
    move.position_rad = 0.095 * 0.005 * 98100.0;
    TEST_ASSERT_TRUE(profile_plan(&planned, origin, &move, &unlimited, error));
    move.position_rad = 0.095 * 0.005 * 98200.0;
    TEST_ASSERT_FALSE(profile_plan(&planned, origin, &move, &unlimited, error));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, "acceleration"), error);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_trapezoid_follows_its_continuous_profile);
    RUN_TEST(test_a_smooth_move_follows_its_continuous_profile);
    RUN_TEST(test_moves_follow_one_another_across_zero_and_back);
    RUN_TEST(test_15_rad_in_430_ms_cruises_at_45_rad_s_and_lands_exactly);
    RUN_TEST(test_a_trapezoid_shows_the_acceleration_that_acts_from_the_sample_on);
    RUN_TEST(test_the_speed_shown_is_right_to_1e_5_for_any_base);
    RUN_TEST(test_slow_and_fast_moves_land_without_a_correction);
    RUN_TEST(test_positions_go_round_at_two_to_the_31_turns);
    RUN_TEST(test_a_million_turns_are_covered_without_loss);
    RUN_TEST(test_a_smooth_move_has_bounded_jerk_and_continuous_acceleration);
    RUN_TEST(test_a_trapezoid_stops_from_any_point_with_its_own_deceleration);
    RUN_TEST(test_a_smooth_move_stops_from_any_point_with_its_own_jerk);
    RUN_TEST(test_a_move_with_phases_of_one_period_stops_in_any_of_them);
    RUN_TEST(test_a_stop_while_decelerating_still_lands_on_the_target);
    RUN_TEST(test_a_move_stopped_before_it_begins_stays_where_it_is);
    RUN_TEST(test_a_stop_at_rest_leaves_the_next_move_alone);
    RUN_TEST(test_a_stop_shortens_the_profile_that_was_begun);
    RUN_TEST(test_a_profile_begins_with_the_step_behind_its_load);
    RUN_TEST(test_after_a_stop_a_move_starts_from_where_the_reference_rests);
    RUN_TEST(test_a_move_is_refused_while_another_one_runs);
    RUN_TEST(test_a_move_planned_from_elsewhere_is_refused);
    RUN_TEST(test_a_reset_in_full_motion_leaves_nothing_of_it);
    RUN_TEST(test_a_step_is_there_at_once);
    RUN_TEST(test_each_step_hands_the_next_sample_on_as_the_present_one);
    RUN_TEST(test_the_time_at_rest_is_counted_from_the_end_of_the_move);
    RUN_TEST(test_a_held_rotor_stays_so_while_the_reference_is_slow_and_gentle);
    RUN_TEST(test_a_moving_rotor_is_slow_in_a_slow_cruise_alone);
    RUN_TEST(test_a_move_creeps_that_is_never_faster_than_creep);
    RUN_TEST(test_without_a_creep_speed_whatever_moves_is_not_slow);
    RUN_TEST(test_the_positions_are_the_same_bits_in_every_number_format);
    RUN_TEST(test_a_move_out_of_range_is_refused_with_the_bound_it_breaks);
    RUN_TEST(test_a_refusal_names_the_value_and_the_bound);
    RUN_TEST(test_the_range_of_the_reference_binds_where_the_drive_sets_no_limit);
    return UNITY_END();
}
