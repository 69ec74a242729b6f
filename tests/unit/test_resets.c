/*
 * A block that begins anew is the same whatever came before: begun in cleared memory and in memory
 * full of a past, it is equal but for padding and for what it leaves on purpose.
 */
#include <stddef.h>
#include <string.h>

#include "firmware/drive/following_error.h"
#include "firmware/estimator/encoder_alignment.h"
#include "firmware/estimator/synchronism_monitor.h"
#include "tests/unit/drive_bench.h"

/* Bytes of a block that may differ. */
struct left {
    size_t from, to;
};

#define END_OF(type, member) (offsetof(type, member) + sizeof(((type *)NULL)->member))
#define LEAVES(type, member)                                                                       \
    {                                                                                              \
        offsetof(type, member), END_OF(type, member)                                               \
    }
#define LEAVES_UP_TO(type, a, b)                                                                   \
    {                                                                                              \
        offsetof(type, a), END_OF(type, b)                                                         \
    }
#define PADDING(type, behind, next)                                                                \
    {                                                                                              \
        END_OF(type, behind), offsetof(type, next)                                                 \
    }
#define PADDING_BEHIND(type, last)                                                                 \
    {                                                                                              \
        END_OF(type, last), sizeof(type)                                                           \
    }
#define NOTHING                                                                                    \
    {                                                                                              \
        0, 0                                                                                       \
    }

static bool may_differ(size_t byte, const struct left *left, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (byte >= left[i].from && byte < left[i].to) {
            return true;
        }
    }
    return false;
}

/* `begin` begins `block`. */
#define BEGINS_ANEW(type, begin, ...)                                                              \
    do {                                                                                           \
        static const struct left left[] = {__VA_ARGS__};                                           \
        static union {                                                                             \
            type block;                                                                            \
            uint8_t byte[sizeof(type)];                                                            \
        } cleared, used;                                                                           \
        type *block = &cleared.block;                                                              \
                                                                                                   \
        memset(&cleared, 0, sizeof cleared);                                                       \
        memset(&used, 1, sizeof used);                                                             \
        begin;                                                                                     \
        block = &used.block;                                                                       \
        begin;                                                                                     \
        for (size_t i = 0; i < sizeof(type); i++) {                                                \
            if (!may_differ(i, left, sizeof left / sizeof left[0])) {                              \
                TEST_ASSERT_EQUAL_HEX8_MESSAGE(cleared.byte[i], used.byte[i], #type);              \
            }                                                                                      \
        }                                                                                          \
    } while (0)

static const struct position at = {3, 0x40000000u};

void setUp(void)
{
    drive_bench_reset();
    power_up();
}

void tearDown(void)
{
}

/* All that it is begins at zero. */
#define BEGINS_AT_ZERO(type, begin)                                                                \
    do {                                                                                           \
        static const type zero;                                                                    \
        static type used;                                                                          \
        type *block = &used;                                                                       \
                                                                                                   \
        memset(&used, 1, sizeof used);                                                             \
        begin;                                                                                     \
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&zero, &used, sizeof used, #type);                        \
    } while (0)

static void test_blocks_that_begin_at_zero(void)
{
    BEGINS_AT_ZERO(struct current_control, current_control_reset(block));
    BEGINS_AT_ZERO(struct actuation, actuation_reset(block));
    BEGINS_AT_ZERO(union position_law_state, position_law_reset(block));
    BEGINS_AT_ZERO(struct following_error, following_error_reset(block));
    BEGINS_AT_ZERO(struct held_angle, held_angle_start(block));
    expectation_reset(&drive.expectation);
    TEST_ASSERT_TRUE(drive.expectation.demanded_voltage.a == NUM(0.0));
    TEST_ASSERT_TRUE(drive.expectation.demanded_voltage.b == NUM(0.0));
    TEST_ASSERT_TRUE(drive.expectation.current.a == NUM(0.0));
    TEST_ASSERT_TRUE(drive.expectation.current.b == NUM(0.0));
    TEST_ASSERT_TRUE(drive.expectation.frame.cos == UNIT(1.0));
    TEST_ASSERT_TRUE(drive.expectation.frame.sin == UNIT(0.0));
}

static void test_the_blocks_of_the_control(void)
{
    const struct drive_params *p = &drive.params;

    BEGINS_ANEW(struct measurement, measurement_reset(block, &p->measurement), NOTHING);
    BEGINS_ANEW(struct current_control, current_control_reset(block), NOTHING);
    BEGINS_ANEW(struct modulator, modulator_reset(block), NOTHING);
    BEGINS_ANEW(struct actuation, actuation_reset(block), NOTHING);
    BEGINS_ANEW(struct expectation, expectation_reset(block), NOTHING);
    BEGINS_ANEW(union position_law_state, position_law_reset(block), NOTHING);
    BEGINS_ANEW(struct following_error, following_error_reset(block), NOTHING);
    BEGINS_ANEW(struct synchronism_monitor,
                synchronism_monitor_reset(block, &drive.synchronism.params), NOTHING);
    /* a hold that is not active has no frame */
    BEGINS_ANEW(
        struct standstill_hold, standstill_hold_reset(block, &p->hold),
        LEAVES(struct standstill_hold, leads), PADDING(struct standstill_hold, leads, frame),
        LEAVES_UP_TO(struct standstill_hold, frame, place), LEAVES(struct standstill_hold, offset));
    /* what was learned stays */
    BEGINS_ANEW(struct detent_compensation, detent_compensation_reset(block),
                LEAVES(struct detent_compensation, coefficient),
                PADDING(struct detent_compensation, unsettled_periods, torque),
                PADDING(struct detent_compensation, followed, follower),
                PADDING_BEHIND(struct detent_compensation, follower),
                LEAVES(struct detent_compensation, follower));
}

static void test_the_reference(void)
{
    /* at rest there is neither profile nor plan */
    BEGINS_ANEW(
        struct reference, reference_reset(block, at), PADDING(struct reference, course, now),
        PADDING(struct reference, now.moving, next),
        PADDING(struct reference, next.moving, slow_periods),
        PADDING(struct reference, slow_periods, profile),
        PADDING(struct reference, phase, periods_left), LEAVES(struct reference, profile),
        LEAVES(struct reference, creeps), LEAVES(struct reference, stopped),
        PADDING(struct reference, jerks, at), PADDING(struct reference, at.turns, at.fraction),
        LEAVES_UP_TO(struct reference, plan, segment), LEAVES(struct reference, epoch),
        PADDING(struct reference, epoch, continuation), LEAVES(struct reference, continuation));
    TEST_ASSERT_EQUAL_INT64(0, drive.reference.at.speed);
    TEST_ASSERT_EQUAL_INT64(0, drive.reference.at.acceleration);
    TEST_ASSERT_EQUAL_INT64(0, drive.reference.jerk);
    TEST_ASSERT_EQUAL_INT64(0, drive.reference.jerk_sixth);
    TEST_ASSERT_EQUAL_UINT32(0, drive.reference.slow_periods);
    TEST_ASSERT_EQUAL_UINT32(0, drive.reference.periods_left);
    TEST_ASSERT_EQUAL_UINT32(drive.reference.epoch, 1u); /* plans of before are void */
    reference_reset(&drive.reference, at);
    TEST_ASSERT_EQUAL_UINT32(drive.reference.epoch, 2u);
}

static void test_a_plan(void)
{
    const struct motion_state from = {.turns = 3, .fraction = 5, .speed = 7, .acceleration = 8};

    /* where it lands is set last; segments follow */
    BEGINS_ANEW(struct motion_plan, motion_plan_begin(block, &from, 9u),
                PADDING(struct motion_plan, from.turns, from.fraction),
                PADDING(struct motion_plan, epoch, speed_jump),
                PADDING(struct motion_plan, lands, target), LEAVES(struct motion_plan, target),
                PADDING(struct motion_plan, target, segment), LEAVES(struct motion_plan, segment));
}

static void test_the_estimators(void)
{
    const struct estimator_params *p = &drive.params.estimator;
    const struct estimator_start start = {.position = at,
                                          .encoder_position = at,
                                          .load_torque = NUM(0.125),
                                          .resistance = NUM(0.5),
                                          .unloaded_periods = 7,
                                          .encoder_count = 11};

    BEGINS_ANEW(struct invariant_ekf, invariant_ekf_begin(block, &p->invariant_ekf, &start),
                PADDING(struct invariant_ekf, swung_up, following_periods));
    BEGINS_ANEW(struct steady_state_ekf,
                steady_state_ekf_begin(block, &p->steady_state_ekf, &start), NOTHING);
    BEGINS_ANEW(struct encoder_observer,
                encoder_observer_begin(block, &p->encoder_observer, &start),
                PADDING(struct encoder_observer, estimate, encoder),
                PADDING(struct encoder_observer, encoder.turns, encoder.fraction),
                PADDING(struct encoder_observer, encoder.count, known_torque),
                PADDING_BEHIND(struct encoder_observer, known_torque));
    BEGINS_ANEW(struct high_gain_observer,
                high_gain_observer_begin(block, &p->high_gain_observer, &start),
                PADDING(struct high_gain_observer, estimate, encoder),
                PADDING(struct high_gain_observer, encoder.turns, encoder.fraction),
                PADDING(struct high_gain_observer, encoder.count, measured),
                PADDING_BEHIND(struct high_gain_observer, x));
}

static void test_what_runs_between_switched_off_and_operation(void)
{
    struct initial_position in_start;

    initial_position_start(&in_start, &drive.enabling.detection_params, 5u);
    BEGINS_ANEW(struct held_angle, held_angle_start(block), NOTHING);
    BEGINS_ANEW(struct offset_calibration, offset_calibration_reset(block),
                PADDING_BEHIND(struct offset_calibration, bridge_on));
    BEGINS_ANEW(struct initial_position,
                initial_position_start(block, &drive.enabling.detection_params, 5u),
                PADDING(struct initial_position, stage, periods),
                PADDING(struct initial_position, impulse, expected),
                PADDING(struct initial_position, repetitions, final_angle),
                PADDING(struct initial_position, direction, current_reference),
                PADDING(struct initial_position, attempts, by_impulses),
                PADDING(struct initial_position, by_impulses, angle),
                PADDING(struct initial_position, angle, asymmetry));
    TEST_ASSERT_TRUE(in_start.resistance == NUM(0.0) && in_start.voltage == NUM(0.0) &&
                     in_start.current_reference == NUM(0.0) && in_start.asymmetry == NUM(0.0) &&
                     in_start.uncertainty == NUM(0.0));
    TEST_ASSERT_TRUE(in_start.attempts == 0u && in_start.repetitions == 0u &&
                     in_start.periods == 0u && in_start.impulse == 0u && !in_start.by_impulses);
    /* found anew before they are asked for */
    BEGINS_ANEW(struct encoder_alignment, encoder_alignment_start(block, 5),
                LEAVES_UP_TO(struct encoder_alignment, lowest, mean),
                PADDING(struct encoder_alignment, way, stop),
                PADDING(struct encoder_alignment, held, looked),
                PADDING(struct encoder_alignment, deviation, deviation_on_way),
                PADDING_BEHIND(struct encoder_alignment, rotor));
    BEGINS_ANEW(struct phase_balance, phase_balance_start(block, 5u),
                PADDING(struct phase_balance, stage, held),
                PADDING(struct phase_balance, periods, mean),
                LEAVES_UP_TO(struct phase_balance, difference, sum));
    BEGINS_ANEW(struct standstill_pulses,
                standstill_pulses_reset(block, &drive.standstill.params, NUM(0.1)),
                PADDING(struct standstill_pulses, at_rest, command),
                LEAVES(struct standstill_pulses, command), LEAVES(struct standstill_pulses, start));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_blocks_that_begin_at_zero);
    RUN_TEST(test_the_blocks_of_the_control);
    RUN_TEST(test_the_reference);
    RUN_TEST(test_a_plan);
    RUN_TEST(test_the_estimators);
    RUN_TEST(test_what_runs_between_switched_off_and_operation);
    return UNITY_END();
}
