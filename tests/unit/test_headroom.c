/*
 * Whatever the converters and the encoder say, no number leaves its format: a drive whose samples
 * jump between the ends of what its protection lets pass. What overflows is found by the sanitizer
 * of undefined behaviour (preset sil-sanitize), in fixed point; the rest is found by any build.
 */
#include "firmware/drive/drive.h"
#include "tests/unit/emulated.h"
#include "tests/unit/fake_board.h"
#include "tests/unit/num_assert.h"
#include "tests/unit/servo_frequency.h"

enum { PERIODS = EMULATED ? 300 : 3000 };

static struct drive drive;
static struct drive_settings settings;
static struct hal_facts facts;
static struct hal board;
static char error[DRIVE_ERROR_TEXT];
static uint32_t seed;

void setUp(void)
{
    fake_board = (struct fake_board){.trip_latched = false};
    facts = bench_facts;
    board = fake_hal;
    board.facts = &facts;
    seed = 1u;
    drive_settings_default(&settings, &bench_params);
    settings.calibrate_offsets = false;
    settings.hold_on_enable_s = 0.01;
}

void tearDown(void)
{
}

/* Of `choices`. */
static uint32_t draw(uint32_t choices)
{
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 16) % choices;
}

static int32_t one_of_three(int32_t low, int32_t middle, int32_t high)
{
    const int32_t choice[] = {low, middle, high};

    return choice[draw(3u)];
}

static struct hal_samples at_the_rails(void)
{
    const int32_t trip =
        (int32_t)(drive.settings.overcurrent_trip_A / facts.current_A_per_code) - 1;

    return (struct hal_samples){
        .current_a = (uint16_t)one_of_three(2048 - trip, 2048, 2048 + trip),
        .current_b = (uint16_t)one_of_three(2048 - trip, 2048, 2048 + trip),
        .bus_voltage = (uint16_t)one_of_three(2500, 3151, 3400),
        .phase_voltage_a = (int16_t)one_of_three(-4095, 0, 4095),
        .phase_voltage_b = (int16_t)one_of_three(-4095, 0, 4095),
        .encoder_count = one_of_three(INT32_MIN, (int32_t)draw(4000u), INT32_MAX),
    };
}

static void must_post(enum drive_command_kind kind)
{
    const struct drive_command command = {.kind = kind};

    TEST_ASSERT_TRUE_MESSAGE(drive_command(&drive, &command, error), error);
}

/* Enabled anew after each fault; it drives half of the time at least. */
static void nothing_leaves_its_range(void)
{
    struct hal_outputs outputs;
    uint32_t driven = 0;

    TEST_ASSERT_TRUE_MESSAGE(drive_init(&drive, &board, &settings, error), error);
    for (uint32_t period = 0; period < PERIODS; period++) {
        const struct hal_samples samples = at_the_rails();
        struct drive_signals now;

        drive_signals_read(&drive, &now);
        if (now.state == DRIVE_FAULT) {
            must_post(DRIVE_COMMAND_DISABLE);
        } else if (now.state == DRIVE_SWITCH_ON_DISABLED) {
            must_post(DRIVE_COMMAND_ENABLE);
        }
        drive_control_cycle(&drive, &samples, &outputs);
        for (int leg = 0; leg < HAL_LEGS; leg++) {
            TEST_ASSERT_TRUE(outputs.high_counts[leg] <= facts.pwm_half_period_counts);
        }
        driven += outputs.bridge_on ? 1u : 0u;
    }
    TEST_ASSERT_TRUE_MESSAGE(driven > PERIODS / 10u, "it hardly drives");
}

static void test_samples_at_their_ends_leave_a_sensorless_drive_in_range(void)
{
    nothing_leaves_its_range();
    settings.estimator = DRIVE_ESTIMATOR_STEADY_STATE_EKF;
    nothing_leaves_its_range();
}

static void test_samples_at_their_ends_leave_the_detection_of_the_position_in_range(void)
{
    settings.initial_position = DRIVE_INITIAL_POSITION_IMPULSES;
    nothing_leaves_its_range();
}

static void test_samples_at_their_ends_leave_every_law_with_an_encoder_in_range(void)
{
    facts.encoder_counts_per_turn = 4000u;
    for (int law = 0; law < POSITION_LAW_COUNT; law++) {
        drive_settings_default(&settings, &bench_params);
        settings.calibrate_offsets = false;
        settings.hold_on_enable = false;
        settings.feedback = DRIVE_FEEDBACK_ENCODER;
        settings.law = (enum position_law)law;
        give_servo_frequency(&settings, 50.0);
        nothing_leaves_its_range();
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_samples_at_their_ends_leave_a_sensorless_drive_in_range);
    RUN_TEST(test_samples_at_their_ends_leave_the_detection_of_the_position_in_range);
    RUN_TEST(test_samples_at_their_ends_leave_every_law_with_an_encoder_in_range);
    return UNITY_END();
}
