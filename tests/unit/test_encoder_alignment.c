/* The zero of an encoder from a rotor that a current holds: the rotor is a pendulum. */
#include <stdlib.h>

#include <unity.h>

#include "firmware/estimator/encoder_alignment.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"
#include "tests/unit/emulated.h"

#define DEGREES (360.0 / TWO_PI)
#define COUNTS  4000u

enum { EVERY = EMULATED ? 10 : 1 }; /* of many alignments alike */

static const struct motor_params light = {
    .resistance_ohm = 5.6,
    .inductance_H = 3.4e-3,
    .torque_constant_Nm_A = 0.0633,
    .viscous_friction_Nms_rad = 2e-5,
    .inertia_kgm2 = 0.9e-6,
    .rated_current_A = 0.67,
    .supply_V = 24.0,
    .rotor_teeth = 50,
};

static struct motor_params motor;
static uint32_t counts;
static struct per_unit base;
static struct encoder_alignment_params params;
static struct encoder_alignment alignment;
static enum encoder_alignment_event event;

/* Torques as shares of Km times the stronger current, angles in electrical rad from the final
 * angle. */
static struct {
    double damping; /* ratio, at the stronger current */
    double friction;
    double load, load_begins_s, load_ends_s;
    double detent[3]; /* once, twice, four times an electrical turn */
    double detent_phase;
    double encoder_phase;   /* rad by which the first count begins before the final angle */
    double counts_ratio;    /* counts that come per count that is set */
    unsigned loaded_ways;   /* a bit for each */
    double stop;            /* an end stop's angle */
    bool jammed;            /* from the first stop on */
    double current_ratio;   /* of what flows */
    double frequency_ratio; /* of the true swing to that of the file */

    double angle, speed; /* speed in rad per strong swing / 2 pi */
    double time_s;
    double furthest;
} rotor;

void setUp(void)
{
    motor = bench_params;
    counts = COUNTS;
    rotor.damping = 0.2;
    rotor.friction = 0.0;
    rotor.load = 0.0;
    rotor.load_begins_s = 0.0;
    rotor.load_ends_s = (double)INFINITY;
    rotor.loaded_ways = ~0u;
    rotor.stop = (double)INFINITY;
    rotor.detent[0] = rotor.detent[1] = rotor.detent[2] = 0.0;
    rotor.detent_phase = 0.0;
    rotor.encoder_phase = 0.01;
    rotor.counts_ratio = 1.0;
    rotor.jammed = false;
    rotor.current_ratio = 1.0;
    rotor.frequency_ratio = 1.0;
    rotor.angle = 0.0;
    rotor.speed = 0.0;
}

void tearDown(void)
{
}

static bool is_loaded(void)
{
    return rotor.time_s >= rotor.load_begins_s && rotor.time_s <= rotor.load_ends_s &&
           (rotor.loaded_ways >> alignment.way & 1u) == 1u;
}

/* Torques of all kinds but friction, without the damping. */
static double torque(double held, double strength)
{
    static const double harmonic[3] = {1.0, 2.0, 4.0};
    double sum = strength * sin(held - rotor.angle);

    for (int i = 0; i < 3; i++) {
        sum -= rotor.detent[i] * sin(harmonic[i] * (rotor.angle + rotor.detent_phase));
    }
    return is_loaded() ? sum - rotor.load : sum;
}

static void swing(double held, double strength, double step)
{
    const double driving = torque(held, strength) - 2.0 * rotor.damping * rotor.speed;
    const double change = (driving - copysign(rotor.friction, rotor.speed)) * step;

    if (rotor.jammed && alignment.stage == ALIGNMENT_SWEEPING) {
        rotor.speed = 0.0;
    } else if (rotor.speed == 0.0 && fabs(driving) <= rotor.friction) {
        return;
    } else if (rotor.speed == 0.0) {
        rotor.speed = (driving - copysign(rotor.friction, driving)) * step;
    } else if (rotor.speed * (rotor.speed + change) < 0.0) {
        rotor.speed = 0.0;
    } else {
        rotor.speed += change;
    }
    rotor.angle += rotor.speed * step;
    if (rotor.angle > rotor.stop) {
        rotor.angle = rotor.stop;
        rotor.speed = 0.0;
    }
    rotor.furthest = fmax(rotor.furthest, fabs(rotor.angle));
}

static double count_rad(void)
{
    return TWO_PI * motor.rotor_teeth / (double)counts;
}

static int32_t count(void)
{
    return (int32_t)floor((rotor.angle + rotor.encoder_phase) / count_rad() * rotor.counts_ratio);
}

/* Rad of a strong hold's swing in a period, by 2 pi. */
static double swing_step(void)
{
    const double stiffness = motor.rotor_teeth * motor.torque_constant_Nm_A * motor.rated_current_A;

    return sqrt(stiffness / motor.inertia_kgm2) * PERIOD_S * rotor.frequency_ratio;
}

static void design(void)
{
    base = per_unit_base(&motor, PERIOD_S);
    const struct encoder_alignment_task task = {
        .base = &base,
        .motor = &motor,
        .counts_per_turn = counts,
        .period_s = PERIOD_S,
        .current_A = motor.rated_current_A,
        .settling_s = 0.075,
    };
    params = encoder_alignment_design(&task);
}

static void period(void)
{
    const double current = num_to_double(encoder_alignment_current(&alignment, &params));
    const double held = (double)alignment.held.offset / 4294967296.0 * TWO_PI;

    for (int i = 0; i < 4; i++) {
        swing(held, 2.0 * current, 0.25 * swing_step()); /* the base is twice the rated current */
    }
    rotor.time_s += PERIOD_S;
    event = encoder_alignment_step(&alignment, &params, count(),
                                   num_from_double(rotor.current_ratio * current));
}

/* To its end. */
static void align(void)
{
    design();
    rotor.speed = 0.0;
    rotor.time_s = 0.0;
    rotor.furthest = 0.0;
    encoder_alignment_start(&alignment, count());
    while (alignment.stage < ALIGNMENT_FOUND) {
        period();
    }
}

/* Degrees electrical between where the rotor is said to be and the middle of its count. */
static double error_deg(void)
{
    const double middle =
        (floor((rotor.angle + rotor.encoder_phase) / count_rad()) + 0.5) * count_rad() -
        rotor.encoder_phase;

    return ((double)alignment.rotor / 4294967296.0 * TWO_PI - middle) * DEGREES;
}

static double count_deg(void)
{
    return count_rad() * DEGREES;
}

static void is_found_within(double counts_max)
{
    TEST_ASSERT_EQUAL(ALIGNMENT_FOUND, alignment.stage);
    TEST_ASSERT_EQUAL(ALIGNMENT_PLACES, event);
    TEST_ASSERT_DOUBLE_WITHIN(counts_max * count_deg() + 0.2, 0.0, error_deg());
}

static void is_not_found(void)
{
    TEST_ASSERT_EQUAL(ALIGNMENT_NOT_FOUND, alignment.stage);
    TEST_ASSERT_EQUAL(ALIGNMENT_FAILS, event);
}

/* ---- what it finds ---- */

static void test_the_zero_is_found_to_a_tenth_of_a_count_on_any_motor_and_encoder(void)
{
    static const uint32_t encoders[] = {400, 1024, 1400, 4000, 16384, 1u << 20};

    for (int m = 0; m < (EMULATED ? 1 : 2); m++) {
        motor = m == 0 ? light : bench_params;
        for (unsigned e = 0; e < sizeof encoders / sizeof encoders[0]; e++) {
            counts = encoders[e];
            for (int phase = 0; phase < 5; phase += EMULATED ? 4 : 1) {
                rotor.encoder_phase = 0.2 * phase * count_rad();
                rotor.angle = 0.5 * phase - 1.0;
                align();
                is_found_within(0.1);
            }
        }
    }
}

static void test_wherever_the_rotor_stands_it_is_drawn_in(void)
{
    for (int angle_deg = -180; angle_deg <= 180; angle_deg += EMULATED ? 180 : 30) {
        rotor.angle = angle_deg / DEGREES;
        align();
        TEST_ASSERT_EQUAL(ALIGNMENT_FOUND, alignment.stage);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1.0, cos(rotor.angle));
        if (abs(angle_deg) < 180) { /* opposite the hold it may come from either side */
            TEST_ASSERT_DOUBLE_WITHIN(0.1, 0.0, rotor.angle);
            is_found_within(0.1);
        }
    }
}

/* Offsets of the current sensors act once, their gains twice an electrical turn. */
static void test_what_repeats_with_the_electrical_angle_cancels(void)
{
    rotor.detent[0] = 0.02;
    rotor.detent[1] = 0.03;
    rotor.detent[2] = 0.07;
    for (int phase = 0; phase < 8; phase += EMULATED ? 5 : 1) {
        rotor.detent_phase = phase * TWO_PI / 8.0;
        align();
        is_found_within(0.1);
    }
}

static void test_dry_friction_cancels_though_it_leaves_the_rotor_a_count_behind(void)
{
    rotor.damping = 0.5;
    rotor.friction = 0.08;
    for (int phase = 0; phase < 5; phase += EMULATED ? 4 : 1) {
        rotor.encoder_phase = 0.2 * phase * count_rad();
        align();
        is_found_within(0.15);
    }
    TEST_ASSERT_TRUE(num_to_double(alignment.deviation_on_way[ALIGNMENT_DOWN_STRONG] -
                                   alignment.deviation_on_way[ALIGNMENT_UP_STRONG]) *
                         360.0 >
                     6.0);
}

static void test_a_lasting_load_is_taken_out(void)
{
    for (int tenths = -3; tenths <= 3; tenths += EMULATED ? 6 : 1) {
        rotor.load = 0.1 * tenths;
        align();
        is_found_within(0.2);
    }
}

static void test_a_load_that_two_means_do_not_show_shifts_the_zero_by_a_third_of_a_count(void)
{
    for (int i = -12; i <= 12; i += EMULATED ? 8 : 1) {
        rotor.load = 0.005 * i;
        align();
        is_found_within(0.4);
    }
}

/* ---- what it refuses ---- */

static void test_a_load_beyond_a_third_of_the_hold_is_refused(void)
{
    rotor.load = 0.36;
    align();
    is_not_found();
    rotor.load = -0.36;
    align();
    is_not_found();
}

/* Never a zero that is wrong by more than the bound; count and bound leave a quarter for it. */
static void test_a_load_that_begins_on_the_way_does_not_become_a_wrong_zero(void)
{
    int refused = 0;

    align();
    const double lasts_s = rotor.time_s;

    for (int load = 1; load <= 3; load++) {
        for (int i = 0; i < 30; i += EVERY) {
            setUp();
            rotor.load = 0.08 * load;
            rotor.load_begins_s = lasts_s * i / 30.0;
            align();
            if (alignment.stage == ALIGNMENT_FOUND) {
                TEST_ASSERT_DOUBLE_WITHIN(0.75 * count_deg(), 0.0, error_deg());
            } else {
                refused++;
            }
        }
    }
    TEST_ASSERT_GREATER_THAN(40 / EVERY, refused);
}

static void test_a_load_on_some_of_the_ways_alone_is_refused(void)
{
    static const unsigned ways[] = {
        1u << ALIGNMENT_DOWN_STRONG,
        1u << ALIGNMENT_UP_STRONG,
        1u << ALIGNMENT_UP_WEAK_AGAIN,
        1u << ALIGNMENT_DOWN_WEAK,
        1u << ALIGNMENT_UP_WEAK_AGAIN | 1u << ALIGNMENT_DOWN_WEAK,
    };

    for (unsigned i = 0; i < sizeof ways / sizeof ways[0]; i++) {
        rotor.load = 0.08;
        rotor.loaded_ways = ways[i];
        align();
        is_not_found();
    }
}

static void test_a_load_that_comes_and_goes_on_the_way_does_not_become_a_wrong_zero(void)
{
    int refused = 0;

    align();
    const double lasts_s = rotor.time_s;

    for (int length = 1; length <= 3; length++) {
        for (int i = 0; i < 30; i += EVERY) {
            setUp();
            rotor.load = 0.15;
            rotor.load_begins_s = lasts_s * i / 30.0;
            rotor.load_ends_s = rotor.load_begins_s + lasts_s * length / 6.0;
            align();
            if (alignment.stage == ALIGNMENT_FOUND) {
                TEST_ASSERT_DOUBLE_WITHIN(0.75 * count_deg(), 0.0, error_deg());
            } else {
                refused++;
            }
        }
    }
    TEST_ASSERT_GREATER_THAN(60 / EVERY, refused);
}

/* It lets the rotor follow but for the outermost angle, on each way as far. */
static void test_an_end_stop_within_the_turn_is_not_taken_for_a_zero(void)
{
    for (int beyond_deg = 10; beyond_deg <= 40; beyond_deg += 10) {
        rotor.stop = (154.3 - beyond_deg) / DEGREES;
        align();
        if (alignment.stage == ALIGNMENT_FOUND) {
            TEST_ASSERT_DOUBLE_WITHIN(0.75 * count_deg(), 0.0, error_deg());
        }
    }
    is_not_found();
}

static void test_a_rotor_that_is_held_is_refused(void)
{
    rotor.jammed = true;
    align();
    is_not_found();
    TEST_ASSERT_TRUE(rotor.time_s < 0.5);
}

static void test_an_encoder_that_counts_otherwise_than_it_should_is_refused(void)
{
    static const double ratio[] = {0.0, -1.0, 0.5, 2.0, 0.8, 1.25};

    for (unsigned i = 0; i < sizeof ratio / sizeof ratio[0]; i++) {
        rotor.counts_ratio = ratio[i];
        align();
        is_not_found();
    }
}

static void test_without_current_nothing_is_believed(void)
{
    rotor.current_ratio = 0.85;
    align();
    is_not_found();
    TEST_ASSERT_TRUE(rotor.time_s < 2.0);
}

/* The counts of a swing stand at its turning points, but never for all of it. */
static void test_a_turning_point_is_not_taken_for_rest(void)
{
    rotor.damping = 0.0;
    rotor.angle = 1.6 * count_rad();
    align();
    is_not_found();
    TEST_ASSERT_EQUAL(0, alignment.stop);
    TEST_ASSERT_TRUE(rotor.time_s < 2.0);
}

static void test_a_swing_that_dies_out_slowly_is_waited_for(void)
{
    rotor.damping = 0.02;
    rotor.angle = 2.0;
    align();
    is_found_within(0.15);
    TEST_ASSERT_DOUBLE_WITHIN(1.5 * count_rad() * swing_step(), 0.0, rotor.speed * swing_step());
}

static void test_four_times_the_inertia_that_it_assumes_does_no_harm(void)
{
    rotor.frequency_ratio = 0.5;
    rotor.damping = 0.1;
    for (int phase = 0; phase < 5; phase += EMULATED ? 4 : 1) {
        rotor.encoder_phase = 0.2 * phase * count_rad();
        align();
        is_found_within(0.15);
    }
}

/* ---- what it costs ---- */

static void test_it_stays_within_half_a_turn_and_takes_as_long_as_it_says(void)
{
    align();
    const double strong_swing_s = TWO_PI / swing_step() * PERIOD_S;

    TEST_ASSERT_TRUE(rotor.furthest < 3.3);
    TEST_ASSERT_TRUE(rotor.furthest > 2.9);
    TEST_ASSERT_DOUBLE_WITHIN(20.0, 250.0, (rotor.time_s - 0.075) / strong_swing_s);
}

static void test_the_rotor_is_placed_before_it_is_led_so_that_the_hold_can_damp(void)
{
    double placed = 0.0;

    design();
    rotor.angle = 2.0;
    encoder_alignment_start(&alignment, count());
    while (alignment.stage == ALIGNMENT_ALIGNING) {
        period();
        if (event == ALIGNMENT_PLACES) {
            placed = (double)alignment.rotor / 4294967296.0 * TWO_PI - rotor.angle;
            TEST_ASSERT_DOUBLE_WITHIN(1.2, 0.0, remainder(placed, TWO_PI));
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(count_rad(), 0.0, remainder(placed, TWO_PI));
}

/* 80 counts in an electrical turn: bounds in turns, spacing of the angles in 2^-32 of one. */
static void test_the_design_in_figures(void)
{
    const double count = 1.0 / 80.0;
    const double turn = 4294967296.0;

    motor = bench_params;
    counts = 4000;
    design();
    const struct alignment_hold *weak = &params.hold[ALIGNMENT_WEAK];
    const struct alignment_hold *strong = &params.hold[ALIGNMENT_STRONG];

    TEST_ASSERT_NUM_WITHIN(1e-6, 0.5 * num_to_double(strong->current), weak->current);
    TEST_ASSERT_NUM_WITHIN(1e-6, 3.0 / base.current_A, strong->current);
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.1 * 3.0 / base.current_A, strong->tolerance);
    TEST_ASSERT_EQUAL_UINT32(2u * weak->lead.swing, weak->look);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5 / weak->look, 1.0 / weak->look, coef_to_double(weak->per_look));
    TEST_ASSERT_EQUAL_UINT32(1, params.band);
    TEST_ASSERT_EQUAL_UINT32(750, params.settling);
    TEST_ASSERT_EQUAL_UINT32(750u + 40u * weak->lead.swing, params.patience);
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.125 + count, params.deviation_max);
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.3 * count, params.load_min);
    TEST_ASSERT_NUM_WITHIN(1e-6, 1.0 / 16.0, params.load_max);
    TEST_ASSERT_NUM_WITHIN(1e-6, 1.0 / 32.0, params.friction_max);
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.75 * count, params.error_max);
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.25 * count, params.zero_error_max);
    TEST_ASSERT_NUM_WITHIN(1e-6, 0.45 * count, params.outlier_max);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, turn / 7.0, params.spacing);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 0.5 * count / 7.0 * turn, params.interleave);
    counts = 4200; /* 84 in a turn, which seven divides: one less */
    design();
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 83.0 / 84.0 * turn / 7.0, params.spacing);
    counts = 40000; /* of which rest may be more than one, and 3 degrees are more than 3/4 */
    design();
    TEST_ASSERT_EQUAL_UINT32(2, params.band);
    TEST_ASSERT_NUM_WITHIN(1e-6, 3.0 / 360.0, params.error_max);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_zero_is_found_to_a_tenth_of_a_count_on_any_motor_and_encoder);
    RUN_TEST(test_wherever_the_rotor_stands_it_is_drawn_in);
    RUN_TEST(test_what_repeats_with_the_electrical_angle_cancels);
    RUN_TEST(test_dry_friction_cancels_though_it_leaves_the_rotor_a_count_behind);
    RUN_TEST(test_a_lasting_load_is_taken_out);
    RUN_TEST(test_a_load_that_two_means_do_not_show_shifts_the_zero_by_a_third_of_a_count);
    RUN_TEST(test_a_load_beyond_a_third_of_the_hold_is_refused);
    RUN_TEST(test_a_load_that_begins_on_the_way_does_not_become_a_wrong_zero);
    RUN_TEST(test_a_load_on_some_of_the_ways_alone_is_refused);
    RUN_TEST(test_a_load_that_comes_and_goes_on_the_way_does_not_become_a_wrong_zero);
    RUN_TEST(test_an_end_stop_within_the_turn_is_not_taken_for_a_zero);
    RUN_TEST(test_a_rotor_that_is_held_is_refused);
    RUN_TEST(test_an_encoder_that_counts_otherwise_than_it_should_is_refused);
    RUN_TEST(test_without_current_nothing_is_believed);
    RUN_TEST(test_a_turning_point_is_not_taken_for_rest);
    RUN_TEST(test_a_swing_that_dies_out_slowly_is_waited_for);
    RUN_TEST(test_four_times_the_inertia_that_it_assumes_does_no_harm);
    RUN_TEST(test_it_stays_within_half_a_turn_and_takes_as_long_as_it_says);
    RUN_TEST(test_the_rotor_is_placed_before_it_is_led_so_that_the_hold_can_damp);
    RUN_TEST(test_the_design_in_figures);
    return UNITY_END();
}
