/* What a drive is designed to is the same on every core and compiler, and within a version: the
   numbers below. A change that moves them moves the hashes of scenarios, too, and says so. */
#include "firmware/drive/drive_hash.h"
#include "tests/unit/drive_bench.h"
#include "tests/unit/servo_frequency.h"

static uint64_t hash;

void setUp(void)
{
    drive_bench_reset();
    hash = UINT64_C(0xcbf29ce484222325);
    encoder_facts.encoder_counts_per_turn = 4000;
    board.facts = &encoder_facts;
}

void tearDown(void)
{
}

static void add(uint32_t word)
{
    hash = drive_hash_word(hash, word);
}

static void add_number(num_t number)
{
    add(num_bits(number));
}

/* The hold, and what watches. */
static void add_supervision(void)
{
    const struct drive_params *params = &drive.params;
    const uint32_t *monitor = (const void *)&drive.synchronism.params;

    add_number(params->hold.current);
    add_number(params->hold.motion_current);
    add_number(params->hold.ramp_in);
    add_number(params->hold.ramp_out);
    add_number(params->hold.current_limit);
    add_number(params->hold.error_limit);
    add_number(params->hold.speed_limit);
    add(params->hold.delay_periods);
    add_number(params->following.limit);
    add_number(params->following.approach);
    add_number(params->protection.speed_limit);
    add_number(params->protection.load_torque_limit);
    add((uint32_t)params->protection.current_codes.width);
    add((uint32_t)params->protection.bus_codes.width);
    add(params->enabling.hold_on_enable_periods);
    add(params->enabling.balance_periods);
    add_number(params->reference.creep_speed);
    add_number(params->reference.creep_acceleration);
    add_number(drive.idle_params.current);
    add_number(drive.idle_params.fall);
    add(drive.idle_params.delay_periods);
    add_number(drive.phase_watch_params.voltage_error);
    add(drive.phase_watch_params.noise_codes);
    add_number(params->model.nominal_resistance);
    add_number(params->model.resistance_min);
    add_number(params->model.resistance_max);
    add(drive.brake.on_code + ((uint32_t)drive.brake.off_code << 16));
    add(drive.brake.cooling + ((uint32_t)drive.brake.heating << 16));
    for (size_t i = 0; drive.synchronism.monitored && i < sizeof drive.synchronism.params / 4u;
         i++) {
        add(monitor[i]);
    }
}

static void add_design(void)
{
    power_up();
    const uint64_t gains = drive_hash_gains(&drive.params);

    add((uint32_t)gains);
    add((uint32_t)(gains >> 32));
    add_supervision();
}

/* Of float, of fixed point; a host's double is nobody's. */
static void is(uint64_t of_float, uint64_t of_fixed)
{
#if STEADYSTEP_NUM == NUM_FLOAT
    TEST_ASSERT_EQUAL_HEX64(of_float, hash);
    (void)of_fixed;
#elif STEADYSTEP_NUM == NUM_FIXED
    TEST_ASSERT_EQUAL_HEX64(of_fixed, hash);
    (void)of_float;
#else
    (void)of_float;
    (void)of_fixed;
#endif
}

static void add_every_law(enum drive_feedback feedback)
{
    for (int law = 0; law < POSITION_LAW_COUNT; law++) {
        drive_settings_default(&settings, &bench_params);
        drive_settings_select_feedback(&settings, feedback);
        drive_settings_select_law(&settings, (enum position_law)law);
        give_servo_frequency(&settings, 100.0);
        add_design();
    }
}

static void test_without_an_encoder_every_law_has_these_gains(void)
{
    add_every_law(DRIVE_FEEDBACK_SENSORLESS);
    is(UINT64_C(0x9C475F5AD07AC456), UINT64_C(0x09056598FD4125B9));
}

static void test_with_an_encoder_every_law_has_these_gains(void)
{
    add_every_law(DRIVE_FEEDBACK_ENCODER);
    is(UINT64_C(0xafb6408e3c943e48), UINT64_C(0x2f2e80401801cbe3));
}

static void test_the_other_estimators_have_these_gains(void)
{
    settings.estimator = DRIVE_ESTIMATOR_STEADY_STATE_EKF;
    add_design();
    drive_settings_default(&settings, &bench_params);
    drive_settings_select_feedback(&settings, DRIVE_FEEDBACK_ENCODER);
    settings.observer = DRIVE_OBSERVER_HIGH_GAIN;
    settings.detent_learning = false;
    settings.encoder_zero_known = true;
    add_design();
    is(UINT64_C(0x947c740c07c05806), UINT64_C(0xdc6f38e3eb53aba8));
}

/* A small motor on a fast board, with all that is off by default. */
static void test_another_motor_on_another_board_has_these_gains(void)
{
    const struct motor_params small = {
        .resistance_ohm = 2.6,
        .inductance_H = 2.2e-3,
        .torque_constant_Nm_A = 0.09,
        .viscous_friction_Nms_rad = 1e-4,
        .inertia_kgm2 = 4e-6,
        .rated_current_A = 1.2,
        .supply_V = 24.0,
        .rotor_teeth = 50,
    };

    encoder_facts.control_period_s = 5e-5;
    encoder_facts.encoder_counts_per_turn = 16384;
    for (int encoder = 0; encoder < 2; encoder++) {
        drive_settings_default(&settings, &small);
        drive_settings_select_feedback(&settings, encoder ? DRIVE_FEEDBACK_ENCODER
                                                          : DRIVE_FEEDBACK_SENSORLESS);
        settings.motion_current_A = 0.2;
        add_design();
    }
    is(UINT64_C(0x949FE0BC71DEEFE6), UINT64_C(0xBD06C68219B8CAA9));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_without_an_encoder_every_law_has_these_gains);
    RUN_TEST(test_with_an_encoder_every_law_has_these_gains);
    RUN_TEST(test_the_other_estimators_have_these_gains);
    RUN_TEST(test_another_motor_on_another_board_has_these_gains);
    return UNITY_END();
}
