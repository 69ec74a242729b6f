/*
 * Whatever the converters and the encoder say, at rest and in motion, no number leaves its format:
 * a drive that goes to the ends of its speed and its torque, and whose samples jump between the
 * ends of what its protection lets pass. What overflows is found in fixed point by preset
 * sil-sanitize, which traps it (numeric/num.h); the rest is found by any build.
 */
#include "tests/unit/drive_bench.h"
#include "tests/unit/emulated.h"
#include "tests/unit/servo_frequency.h"

enum { PERIODS = EMULATED ? 300 : 3000, STRETCH = EMULATED ? 1200 : 2000 };

static uint32_t seed;

void setUp(void)
{
    drive_bench_reset();
    board.facts = &encoder_facts;
    seed = 1u;
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
        (int32_t)(drive.settings.overcurrent_trip_A / bench_facts.current_A_per_code) - 1;

    return (struct hal_samples){
        .current_a = (uint16_t)one_of_three(2048 - trip, 2048, 2048 + trip),
        .current_b = (uint16_t)one_of_three(2048 - trip, 2048, 2048 + trip),
        .bus_voltage = (uint16_t)one_of_three(2500, 3151, 3400),
        .phase_voltage_a = (int16_t)one_of_three(-4095, 0, 4095),
        .phase_voltage_b = (int16_t)one_of_three(-4095, 0, 4095),
        .encoder_count = one_of_three(INT32_MIN, (int32_t)draw(4000u), INT32_MAX),
    };
}

/* Enabled anew after each fault; it drives half of the time at least. */
static void nothing_leaves_its_range(void)
{
    struct hal_outputs outputs;
    uint32_t driven = 0;

    power_up();
    for (uint32_t period = 0; period < PERIODS; period++) {
        const struct hal_samples samples = at_the_rails();
        struct drive_signals now;

        drive_signals_read(&drive, &now);
        if (now.state == DRIVE_FAULT) {
            post((struct drive_command){.kind = DRIVE_COMMAND_DISABLE});
        } else if (now.state == DRIVE_SWITCH_ON_DISABLED) {
            post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE});
        }
        drive_control_cycle(&drive, &samples, &outputs);
        for (int leg = 0; leg < HAL_LEGS; leg++) {
            TEST_ASSERT_TRUE(outputs.high_counts[leg] <= bench_facts.pwm_half_period_counts);
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

/* Where the board's range ends. As a rule it is 1.8 times the rated current. */
static void test_a_trip_at_twice_the_rated_current_leaves_a_sensorless_drive_in_range(void)
{
    settings.overcurrent_trip_A = 5.99;
    nothing_leaves_its_range();
    settings.estimator = DRIVE_ESTIMATOR_STEADY_STATE_EKF;
    nothing_leaves_its_range();
}

static void test_samples_at_their_ends_leave_the_detection_of_the_position_in_range(void)
{
    settings.initial_position = DRIVE_INITIAL_POSITION_IMPULSES;
    nothing_leaves_its_range();
}

static void with_encoder(enum position_law law)
{
    setUp();
    encoder_facts.encoder_counts_per_turn = 4000u;
    drive_settings_select_feedback(&settings, DRIVE_FEEDBACK_ENCODER);
    drive_settings_select_law(&settings, law);
    settings.encoder_zero_known = true;
    settings.hold_on_enable = false;
    give_servo_frequency(&settings, 50.0);
}

static void test_samples_at_their_ends_leave_every_law_with_an_encoder_in_range(void)
{
    for (int law = 0; law < POSITION_LAW_COUNT; law++) {
        with_encoder((enum position_law)law);
        nothing_leaves_its_range();
    }
}

/* What has been reached. */
static double fastest_rad_s;
static double most_A;

/* On towards a speed, or towards it again behind a fault. */
static void towards(double speed_rad_s, double load_torque_Nm)
{
    const struct drive_command velocity = {.kind = DRIVE_COMMAND_VELOCITY,
                                           .speed_rad_s = speed_rad_s,
                                           .acceleration_rad_s2 = 1500.0,
                                           .jerk_rad_s3 = 1e6};
    bool commanded = false;

    motor.load_torque_Nm = load_torque_Nm;
    for (int k = 0; k < STRETCH; k++) {
        const enum drive_state state = signals().state;

        TEST_ASSERT_TRUE(bridge.disturb != NULL || k < 10 || /* as the board was mad before */
                         drive.supervision.fault != DRIVE_FAULT_VOLTAGE_SENSOR);
        if (state == DRIVE_FAULT || state == DRIVE_SWITCH_ON_DISABLED) {
            post((struct drive_command){.kind = state == DRIVE_FAULT ? DRIVE_COMMAND_DISABLE
                                                                     : DRIVE_COMMAND_ENABLE});
            commanded = false;
        } else if (state == DRIVE_OPERATION_ENABLED && !commanded) {
            post(velocity);
            commanded = true;
        }
        period();
        fastest_rad_s = fmax(fastest_rad_s, fabs(motor.speed_rad_s));
        most_A = fmax(most_A, hypot(motor.i_a, motor.i_b));
    }
}

static void samples_at_their_ends(struct hal_samples *samples)
{
    *samples = at_the_rails();
}

/* There and back at two thirds of what the supply lets it reach, or at what its law lets it, under
   two fifths of its torque, which the weakest laws do not carry; a board that goes mad meanwhile;
   and on. */
static void in_motion_nothing_leaves_its_range(void)
{
    bridge.background = true;
    fastest_rad_s = 0.0;
    most_A = 0.0;
    power_up();
    const double speed_rad_s = fmin(100.0, 0.99 * drive.settings.speed_limit_rad_s);

    towards(speed_rad_s, 0.0);
    towards(speed_rad_s, 0.2);
    towards(-speed_rad_s, -0.2);
    bridge.disturb = samples_at_their_ends;
    towards(-speed_rad_s, -0.2);
    bridge.disturb = NULL;
    towards(speed_rad_s, 0.2);
    TEST_ASSERT_TRUE_MESSAGE(fastest_rad_s > 20.0, "it hardly moves");
    TEST_ASSERT_TRUE_MESSAGE(most_A > settings.motor.rated_current_A, "it hardly drives");
}

static void test_in_motion_and_under_load_nothing_leaves_its_range(void)
{
    in_motion_nothing_leaves_its_range();
    for (int law = 0; law < POSITION_LAW_COUNT; law++) {
        with_encoder((enum position_law)law);
        in_motion_nothing_leaves_its_range();
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_samples_at_their_ends_leave_a_sensorless_drive_in_range);
    RUN_TEST(test_a_trip_at_twice_the_rated_current_leaves_a_sensorless_drive_in_range);
    RUN_TEST(test_samples_at_their_ends_leave_the_detection_of_the_position_in_range);
    RUN_TEST(test_samples_at_their_ends_leave_every_law_with_an_encoder_in_range);
    RUN_TEST(test_in_motion_and_under_load_nothing_leaves_its_range);
    return UNITY_END();
}
