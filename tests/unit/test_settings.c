/* What a drive may be set to before it is enabled. */
#include "firmware/drive/default_settings.h"
#include <stddef.h>
#include <string.h>

#include "firmware/interface/settings.h"
#include "firmware/interface/simulation_only.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

static struct drive_settings settings;
static char error[DRIVE_ERROR_TEXT];

void setUp(void)
{
    drive_settings_default(&settings, &bench_params);
    error[0] = '\0';
}

void tearDown(void)
{
}

static void test_the_defaults_are_those_of_the_interface(void)
{
    TEST_ASSERT_EQUAL_MEMORY(&bench_params, &settings.motor, sizeof bench_params);
    TEST_ASSERT_EQUAL(POSITION_LAW_STATE_FEEDBACK, settings.law);
    TEST_ASSERT_EQUAL(DRIVE_ESTIMATOR_INVARIANT_EKF, settings.estimator);
    TEST_ASSERT_TRUE(isnan(settings.law_bandwidth_rad_s)); /* follow from motor and period */
    TEST_ASSERT_TRUE(isnan(settings.current_bandwidth_rad_s));
    TEST_ASSERT_TRUE(isnan(settings.observer_bandwidth_rad_s));
    TEST_ASSERT_TRUE(isnan(settings.hold_bandwidth_rad_s));
    TEST_ASSERT_TRUE(isnan(settings.hold_current_A));
    TEST_ASSERT_TRUE(settings.hold_at_rest);
    TEST_ASSERT_TRUE(settings.bridge_loss_compensation);
    TEST_ASSERT_EQUAL(DRIVE_FEEDBACK_SENSORLESS, settings.feedback);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 3.0, settings.current_limit_A);
    TEST_ASSERT_TRUE(isnan(settings.overcurrent_trip_A)); /* follows from motor and board */
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.3 * 24.0 / 0.157, settings.speed_limit_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.010, settings.hold_ramp_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.150, settings.hold_on_enable_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, settings.initial_angle_rad);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, settings.initial_angle_error_rad);
    TEST_ASSERT_TRUE(settings.feed_forward);
    TEST_ASSERT_TRUE(settings.resistance_adaptation);
    TEST_ASSERT_TRUE(settings.calibrate_offsets);
    TEST_ASSERT_TRUE(settings.hold_on_enable);
}

static void test_what_only_a_simulation_asks_for_is_refused_by_name(void)
{
    TEST_ASSERT_NULL(simulation_only_setting(&settings));
    settings.initial_angle_error_rad = -0.01;
    TEST_ASSERT_EQUAL_STRING("initial_angle_error_rad other than 0",
                             simulation_only_setting(&settings));
    settings.initial_position = DRIVE_INITIAL_POSITION_PUBLISHED_IMPULSES;
    TEST_ASSERT_EQUAL_STRING("initial_position = published-impulses",
                             simulation_only_setting(&settings));
    settings.observer = DRIVE_OBSERVER_HIGH_GAIN; /* of an encoder, which is not asked for yet */
    TEST_ASSERT_EQUAL_STRING("initial_position = published-impulses",
                             simulation_only_setting(&settings));
    settings.feedback = DRIVE_FEEDBACK_ENCODER;
    TEST_ASSERT_EQUAL_STRING("observer = high-gain", simulation_only_setting(&settings));
    settings.law = POSITION_LAW_SMC;
    TEST_ASSERT_EQUAL_STRING("law = smc", simulation_only_setting(&settings));
}

static void test_the_defaults_pass_the_check(void)
{
    TEST_ASSERT_TRUE(drive_settings_check(&settings, error));
}

/* The contract once more, from outside: name, range for a motor rated 3 A, unit, and whether it may
   be left to motor, board and period. */
static const struct {
    const char *name;
    double min, max;
    const char *unit;
    bool follows;
} ranges[] = {
    {"resistance_ohm", 1e-3, 1e3, "ohm", false},
    {"inductance_H", 1e-6, 1.0, "H", false},
    {"torque_constant_Nm_A", 1e-4, 100.0, "N m/A", false},
    {"viscous_friction_Nms_rad", 0.0, 10.0, "N m s/rad", false},
    {"inertia_kgm2", 1e-9, 10.0, "kg m2", false},
    {"supply_V", 5.0, 400.0, "V", false},
    {"law_bandwidth_rad_s", 1.0, 1e4, "rad/s", true},
    {"current_bandwidth_rad_s", 10.0, 1e6, "rad/s", true},
    {"observer_bandwidth_rad_s", 1.0, 1e6, "rad/s", true},
    {"hold_bandwidth_rad_s", 1.0, 1e4, "rad/s", true},
    {"encoder_zero_rad", -1e4, 1e4, "rad", false},
    {"initial_load_torque_Nm", -100.0, 100.0, "N m", false},
    {"initial_torque_constant_change", -0.2, 0.2, "", false},
    {"current_limit_A", 0.01 * 3.0, 2.0 * 3.0, "A", false},
    {"overcurrent_trip_A", 0.1 * 3.0, 6.0 * 3.0, "A", true},
    {"speed_limit_rad_s", 0.1, 1e4, "rad/s", false},
    {"hold_current_A", 0.01 * 3.0, 3.0, "A", true},
    {"hold_ramp_s", 1e-3, 1.0, "s", false},
    {"hold_delay_s", 0.0, 100.0, "s", true},
    {"hold_on_enable_s", 0.01, 10.0, "s", false},
    {"initial_angle_rad", -1e4, 1e4, "rad", false},
    {"initial_angle_error_rad", -10.0, 10.0, "rad", false},
};

static void test_ranges_and_units_are_those_of_the_contract(void)
{
    for (size_t range = 0; range < sizeof ranges / sizeof ranges[0]; range++) {
        size_t i = 0;

        while (setting_number(i) != NULL &&
               strcmp(setting_number(i)->name, ranges[range].name) != 0) {
            i++;
        }
        const struct setting *const row = setting_number(i);

        TEST_ASSERT_NOT_NULL_MESSAGE(row, ranges[range].name);
        TEST_ASSERT_TRUE_MESSAGE(setting_least(&settings, row) == ranges[range].min, row->name);
        TEST_ASSERT_TRUE_MESSAGE(setting_most(&settings, row) == ranges[range].max, row->name);
        TEST_ASSERT_EQUAL_STRING(ranges[range].unit, row->unit);
        TEST_ASSERT_EQUAL_MESSAGE(ranges[range].follows, row->preset_base == SETTING_FOLLOWS,
                                  row->name);
    }
}

/* Every real number but the rated current, of which others are shares; NULL behind the last. */
static const struct setting *next_real(size_t *number)
{
    const struct setting *row = setting_number(*number);

    while (row != NULL && (row->type != SETTING_REAL || row->index == 0x2006)) {
        row = setting_number(++*number);
    }
    ++*number;
    return row;
}

/* In the last of its elements. */
static bool accepts(const struct setting *row, double value)
{
    setUp();
    setting_put(&settings, row, row->count - 1u, value);
    return drive_settings_check(&settings, error);
}

static bool contains(const char *text)
{
    return strstr(error, text) != NULL;
}

static void test_every_setting_may_take_the_bounds_of_its_range(void)
{
    const struct setting *row;

    for (size_t i = 0; (row = next_real(&i)) != NULL;) {
        TEST_ASSERT_TRUE_MESSAGE(accepts(row, setting_least(&settings, row)), error);
        TEST_ASSERT_TRUE_MESSAGE(accepts(row, setting_most(&settings, row)), error);
    }
}

static void refused_with(const struct setting *row, double value, const char *relation)
{
    TEST_ASSERT_FALSE_MESSAGE(accepts(row, value), row->name);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(row->name, error, strlen(row->name), error);
    TEST_ASSERT_TRUE_MESSAGE(contains(relation), error);
    TEST_ASSERT_TRUE_MESSAGE(contains(row->unit), error);
}

static void test_what_is_not_given_follows_from_motor_and_period(void)
{
    default_settings_apply(&settings, 1e-4, 0u);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 300.0, settings.law_bandwidth_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 1500.0, settings.current_bandwidth_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 1000.0, settings.observer_bandwidth_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 3.0, settings.hold_current_A);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 200.0, settings.hold_bandwidth_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 4.2 / 388.3, settings.hold_delay_s);
}

/* Its rated current makes 0.86 times the flux of its magnet. */
static double motion_current_of(double km_share, double rated_A)
{
    drive_settings_default(&settings, &bench_params);
    settings.motor.torque_constant_Nm_A *= km_share;
    settings.motor.rated_current_A = rated_A;
    default_settings_apply(&settings, 1e-4, 0u);
    return settings.motion_current_A;
}

static void test_a_motor_of_little_flux_has_a_d_current_in_motion(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, motion_current_of(1.0, 3.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, motion_current_of(0.29, 3.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.375 * 3.0, motion_current_of(0.28, 3.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, motion_current_of(0.5, 5.2));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.375 * 5.3, motion_current_of(0.5, 5.3));
}

static void test_with_an_encoder_or_as_it_is_given_it_is_not_that(void)
{
    (void)motion_current_of(0.28, 3.0);
    settings.motion_current_A = __builtin_nan("");
    drive_settings_select_feedback(&settings, DRIVE_FEEDBACK_ENCODER);
    default_settings_apply(&settings, 1e-4, 4000u);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, settings.motion_current_A);
    drive_settings_select_feedback(&settings, DRIVE_FEEDBACK_SENSORLESS);
    settings.motion_current_A = 0.1;
    default_settings_apply(&settings, 1e-4, 0u);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.1, settings.motion_current_A);
}

/* They were another law's. */
static void test_bandwidths_that_were_given_do_not_outlive_their_law(void)
{
    settings.law_bandwidth_rad_s = 111.0;
    settings.current_bandwidth_rad_s = 2222.0;
    settings.observer_bandwidth_rad_s = 333.0;
    drive_settings_select_law(&settings, POSITION_LAW_PID);
    TEST_ASSERT_DOUBLE_IS_NAN(settings.law_bandwidth_rad_s);
    TEST_ASSERT_DOUBLE_IS_NAN(settings.current_bandwidth_rad_s);
    TEST_ASSERT_DOUBLE_IS_NAN(settings.observer_bandwidth_rad_s);
}

/* The rotor alone, without its load: it swings seven times as fast in the hold. */
static void test_a_light_rotor_gets_a_wider_and_sooner_hold(void)
{
    settings.motor.inertia_kgm2 /= 49.0;
    default_settings_apply(&settings, 1e-4, 0u);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 0.25 * 7.0 * 388.3, settings.hold_bandwidth_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 3000.0, settings.current_bandwidth_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 4.2 / (7.0 * 388.3), settings.hold_delay_s);
}

/* A strong magnet, a light rotor and a slow winding: a hold that swings faster than it is damped.
 */
static void test_a_hold_that_a_motor_does_not_bear_gets_less_current_in_steps(void)
{
    struct motor_params *motor = &settings.motor;

    motor->inertia_kgm2 *= 0.07;
    motor->inductance_H *= 5.0;
    motor->resistance_ohm *= 0.76;
    motor->torque_constant_Nm_A *= 6.0;
    default_settings_apply(&settings, 1e-4, 0u);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 3.0 * 0.7 * 0.7, settings.hold_current_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, settings.hold_current_A, settings.idle_current_A);
    settings.hold_current_A = __builtin_nan("");
    settings.overcurrent_trip_A = 2.0; /* of which a hold has 0.7 */
    default_settings_apply(&settings, 1e-4, 0u);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.7 * 2.0, settings.hold_current_A);
    settings.overcurrent_trip_A = __builtin_nan("");
    motor->torque_constant_Nm_A *= 10.0; /* nor any */
    settings.hold_current_A = __builtin_nan("");
    default_settings_apply(&settings, 1e-4, 0u);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 3.0 * pow(0.7, 8.0), settings.hold_current_A);
}

/* rad/s: what is wanted, and at a period of 1 ms what its sampling bears. */
static void test_every_law_has_its_bandwidths(void)
{
    for (int law = 0; law < POSITION_LAW_COUNT; law++) {
        for (int encoder = 0; encoder < 2; encoder++) {
            const bool linearises = law == POSITION_LAW_FEEDBACK_LINEARISATION;
            const bool fast = linearises && encoder == 1;
            const bool stiff = linearises || law == POSITION_LAW_STATE_FEEDBACK;
            const bool mechanical = law == POSITION_LAW_STMMS || law == POSITION_LAW_STMMS_PLUS ||
                                    law == POSITION_LAW_FOC;
            struct drive_settings slow;

            setUp();
            drive_settings_select_feedback(&settings, encoder ? DRIVE_FEEDBACK_ENCODER
                                                              : DRIVE_FEEDBACK_SENSORLESS);
            drive_settings_select_law(&settings, (enum position_law)law);
            slow = settings;
            default_settings_apply(&settings, 1e-4, encoder ? 4000u : 0u);
            TEST_ASSERT_TRUE(settings.law_bandwidth_rad_s == (fast    ? 900.0
                                                              : stiff ? 300.0
                                                                      : 200.0));
            TEST_ASSERT_TRUE(settings.current_bandwidth_rad_s == (fast ? 2000.0 : 1500.0));
            TEST_ASSERT_TRUE(settings.observer_bandwidth_rad_s == (fast ? 1400.0 : 1000.0));
            TEST_ASSERT_DOUBLE_WITHIN(1e-12,
                                      law == POSITION_LAW_MICROSTEPPING ? 0.0 : TWO_PI / 50.0,
                                      settings.following_error_rad);
            default_settings_apply(&slow, 1e-3, encoder ? 4000u : 0u);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9,
                                      linearises   ? 150.0
                                      : mechanical ? 37.5
                                                   : 75.0,
                                      slow.law_bandwidth_rad_s);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, 300.0, slow.current_bandwidth_rad_s);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, 500.0, slow.observer_bandwidth_rad_s);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.015, slow.hold_delay_s);
        }
    }
}

static void test_what_is_given_stays(void)
{
    settings.law_bandwidth_rad_s = 123.0;
    settings.current_bandwidth_rad_s = 777.0;
    settings.hold_current_A = 2.5;
    default_settings_apply(&settings, 1e-4, 0u);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 123.0, settings.law_bandwidth_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 777.0, settings.current_bandwidth_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 2.5, settings.hold_current_A);
}

/* 900 and 2000 rad/s at 10 kHz: at 5 kHz no design bears them, and nobody has given them. */
static void test_defaults_fit_a_longer_period(void)
{
    drive_settings_select_feedback(&settings, DRIVE_FEEDBACK_ENCODER);
    default_settings_apply(&settings, 2e-4, 4000u);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 750.0, settings.law_bandwidth_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1500.0, settings.current_bandwidth_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 1400.0, settings.observer_bandwidth_rad_s);
}

/* Behind a spring that gives the law has the rotor alone before it. */
static void test_a_law_s_bandwidth_is_less_where_most_of_the_inertia_is_behind_a_belt(void)
{
    settings.rotor_inertia_percent = 30u;
    default_settings_apply(&settings, 1e-4, 0u);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.3 * 300.0, settings.law_bandwidth_rad_s);
}

/* A heavy load on a winding of much inductance, Km / sqrt(J L) = 419 / 2: sensorless alone. */
static void test_a_sensorless_law_is_no_quicker_than_the_winding_swings(void)
{
    const struct drive_settings light = settings;
    struct drive_settings encoder;

    settings.motor.inertia_kgm2 *= 2.0;
    settings.motor.inductance_H *= 2.0;
    encoder = settings;
    default_settings_apply(&settings, 1e-4, 0u);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9,
                              light.motor.torque_constant_Nm_A /
                                  sqrt(4.0 * light.motor.inertia_kgm2 * light.motor.inductance_H),
                              settings.law_bandwidth_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(10.0, 210.0, settings.law_bandwidth_rad_s);
    drive_settings_select_feedback(&encoder, DRIVE_FEEDBACK_ENCODER);
    default_settings_apply(&encoder, 1e-4, 4000u);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 900.0, encoder.law_bandwidth_rad_s);
}

/* The rotor alone: in the hold of half the rated current, and against a winding of little L. */
static void test_an_observer_follows_a_light_rotor(void)
{
    struct motor_params *motor = &settings.motor;

    motor->inertia_kgm2 /= 49.0;
    settings.feedback = DRIVE_FEEDBACK_ENCODER;
    for (double much = 10.0; much > 0.09; much /= 100.0) {
        struct drive_settings given = settings;

        given.motor.inductance_H *= much;
        const double winding_rad_s =
            motor->torque_constant_Nm_A / sqrt(motor->inertia_kgm2 * given.motor.inductance_H);

        default_settings_apply(&given, 1e-4, 0u);
        TEST_ASSERT_DOUBLE_WITHIN(1.0, much > 1.0 ? 7.0 * 274.6 : 5000.0,
                                  given.observer_bandwidth_rad_s);
        TEST_ASSERT_EQUAL(much<1.0, 0.8 * winding_rad_s> 5000.0);
    }
    motor->inductance_H /= 2.0;
    default_settings_apply(&settings, 1e-4, 0u);
    TEST_ASSERT_DOUBLE_WITHIN(
        1e-6, 0.8 * motor->torque_constant_Nm_A / sqrt(motor->inertia_kgm2 * motor->inductance_H),
        settings.observer_bandwidth_rad_s);
}

/* A heavy rotor on a slow winding; eight times the counts bear twice the bandwidth. */
static void test_an_observer_does_not_chase_counts(void)
{
    settings.motor.inertia_kgm2 *= 20.0;
    settings.motor.inductance_H *= 10.0;
    drive_settings_select_feedback(&settings, DRIVE_FEEDBACK_ENCODER);
    default_settings_apply(&settings, 1e-4, 4000u);

    const double coarse = settings.observer_bandwidth_rad_s;
    const struct motor_params *motor = &settings.motor;
    const double load_Nm = motor->inertia_kgm2 * pow(coarse, 3.0) * 1e-4 * TWO_PI / 4000.0;
    const double voltage_V = load_Nm / motor->torque_constant_Nm_A * motor->inductance_H / 1e-4;

    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5 * motor->supply_V, voltage_V);
    settings.observer_bandwidth_rad_s = __builtin_nan("");
    default_settings_apply(&settings, 1e-4, 32000u);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2.0 * coarse, settings.observer_bandwidth_rad_s);
}

static void test_every_setting_is_refused_beyond_its_range_by_name_bound_and_unit(void)
{
    const struct setting *row;

    for (size_t i = 0; (row = next_real(&i)) != NULL;) {
        const double least = setting_least(&settings, row);

        refused_with(row, least > 0.0 ? 0.999 * least : 1.001 * least - 1e-3, "must be at least");
        refused_with(row, 1.001 * setting_most(&settings, row), "must be at most");
    }
}

static void test_a_setting_that_is_not_finite_is_refused(void)
{
    const struct setting *row;

    for (size_t i = 0; (row = next_real(&i)) != NULL;) {
        const bool may_be_not_given = row->preset_base == SETTING_FOLLOWS;

        TEST_ASSERT_EQUAL(may_be_not_given, accepts(row, __builtin_nan("")));
        TEST_ASSERT_TRUE(may_be_not_given || contains("(not finite)"));
        TEST_ASSERT_FALSE(accepts(row, __builtin_inf()));
        TEST_ASSERT_FALSE(accepts(row, -__builtin_inf()));
    }
}

/* A number is given once and never again: records would be read wrongly. */
static void test_every_element_has_an_index_of_its_own(void)
{
    for (size_t i = 0; setting_number(i) != NULL; i++) {
        for (size_t element = 0; element < setting_number(i)->count; element++) {
            const size_t index = setting_number(i)->index + element;

            TEST_ASSERT_TRUE(setting_of_index((uint16_t)index) == setting_number(i));
            TEST_ASSERT_TRUE(index >= 0x2000u && index < 0x4000u);
        }
    }
    TEST_ASSERT_NULL(setting_of_index(0x2000));
}

static void test_a_setting_is_found_by_its_place_and_its_index(void)
{
    size_t i = 0;

    for (; setting_number(i) != NULL; i++) {
        TEST_ASSERT_TRUE(setting_at(setting_number(i)->offset) == setting_number(i));
    }
    TEST_ASSERT_TRUE(i > 40u);
    TEST_ASSERT_NULL(setting_at(sizeof settings));
    TEST_ASSERT_NULL(setting_of_index(0x3fff));
}

/* So many indices are theirs for good. */
static void test_arrays_keep_their_number_of_elements(void)
{
    TEST_ASSERT_EQUAL_STRING("law_gains", setting_of_index(0x2180)->name);
    TEST_ASSERT_EQUAL_UINT32(12, setting_of_index(0x2180)->count);
    TEST_ASSERT_EQUAL_STRING("detent_torque_Nm", setting_of_index(0x21c0)->name);
    TEST_ASSERT_EQUAL_UINT32(6, setting_of_index(0x21c0)->count);
}

static void test_a_refusal_says_what_was_asked_and_what_is_allowed(void)
{
    settings.hold_current_A = 3.5;
    TEST_ASSERT_FALSE(drive_settings_check(&settings, error));
    TEST_ASSERT_EQUAL_STRING("hold_current_A 3.5 A: must be at most 3 A, the range of this setting",
                             error);
    setUp();
    settings.motor.rotor_teeth = 0;
    TEST_ASSERT_FALSE(drive_settings_check(&settings, error));
    TEST_ASSERT_EQUAL_MEMORY("rotor_teeth 0:", error, 14);
    settings.motor.rotor_teeth = 1;
    TEST_ASSERT_TRUE(drive_settings_check(&settings, error));
    settings.motor.rotor_teeth = 1001;
    TEST_ASSERT_FALSE(drive_settings_check(&settings, error));
    TEST_ASSERT_TRUE(contains("1000"));
}

/* The currents are bounded in shares of it, so it comes with them. */
static void test_the_rated_current_has_a_range_of_its_own(void)
{
    static const double accepted[] = {0.01, 1.0, 50.0};
    static const double refused[] = {0.0, 0.0099, 50.1, -3.0};

    for (unsigned i = 0; i < sizeof accepted / sizeof accepted[0]; i++) {
        struct motor_params motor = bench_params;

        motor.rated_current_A = accepted[i];
        drive_settings_default(&settings, &motor);
        TEST_ASSERT_TRUE_MESSAGE(drive_settings_check(&settings, error), error);
    }
    for (unsigned i = 0; i < sizeof refused / sizeof refused[0]; i++) {
        struct motor_params motor = bench_params;

        motor.rated_current_A = refused[i];
        drive_settings_default(&settings, &motor);
        TEST_ASSERT_FALSE(drive_settings_check(&settings, error));
        TEST_ASSERT_EQUAL_MEMORY("rated_current_A ", error, 16);
    }
}

static void test_names_are_spelt_as_scenarios_and_the_serial_line_do(void)
{
    static const char *const states[DRIVE_STATES] = {"switch-on-disabled", "calibrating-offsets",
                                                     "detecting-position", "aligning",
                                                     "operation-enabled",  "fault"};
    static const char *const faults[DRIVE_FAULTS] = {"none",
                                                     "overcurrent",
                                                     "hardware-overcurrent",
                                                     "deadline-missed",
                                                     "bus-voltage",
                                                     "estimate-range",
                                                     "offset-range",
                                                     "position-not-found",
                                                     "lost-synchronism",
                                                     "stalled",
                                                     "phase-imbalance",
                                                     "following-error",
                                                     "open-phase-a",
                                                     "open-phase-b",
                                                     "current-sensor-a",
                                                     "current-sensor-b",
                                                     "motor-overheated",
                                                     "bridge-overheated",
                                                     "encoder",
                                                     "inductance",
                                                     "voltage-sensor"};

    for (int i = 0; i < DRIVE_STATES; i++) {
        TEST_ASSERT_EQUAL_STRING(states[i], drive_state_name((enum drive_state)i));
    }
    for (int i = 0; i < DRIVE_FAULTS; i++) {
        TEST_ASSERT_EQUAL_STRING(faults[i], drive_fault_name((enum drive_fault)i));
    }
    TEST_ASSERT_EQUAL_STRING("state-feedback", drive_law_name(POSITION_LAW_STATE_FEEDBACK));
    TEST_ASSERT_EQUAL_STRING("pid", drive_law_name(POSITION_LAW_PID));
    TEST_ASSERT_EQUAL_STRING("commanded", drive_voltage_source_name(DRIVE_VOLTAGE_COMMANDED));
    TEST_ASSERT_EQUAL_STRING("impulses",
                             drive_initial_position_name(DRIVE_INITIAL_POSITION_IMPULSES));
    TEST_ASSERT_EQUAL_STRING("warn", drive_synchronism_policy_name(DRIVE_SYNCHRONISM_WARN));
    TEST_ASSERT_EQUAL_STRING("doubtful", drive_synchronism_name(DRIVE_SYNCHRONISM_DOUBTFUL));
    TEST_ASSERT_EQUAL_STRING("stalled", drive_synchronism_name(DRIVE_SYNCHRONISM_STALLED));
    TEST_ASSERT_EQUAL_STRING("lost", drive_synchronism_name(DRIVE_SYNCHRONISM_LOST));
    TEST_ASSERT_EQUAL_STRING("invariant-ekf", drive_estimator_name(DRIVE_ESTIMATOR_INVARIANT_EKF));
    TEST_ASSERT_EQUAL_STRING("steady-state-ekf",
                             drive_estimator_name(DRIVE_ESTIMATOR_STEADY_STATE_EKF));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_defaults_are_those_of_the_interface);
    RUN_TEST(test_what_only_a_simulation_asks_for_is_refused_by_name);
    RUN_TEST(test_the_defaults_pass_the_check);
    RUN_TEST(test_ranges_and_units_are_those_of_the_contract);
    RUN_TEST(test_every_setting_may_take_the_bounds_of_its_range);
    RUN_TEST(test_what_is_not_given_follows_from_motor_and_period);
    RUN_TEST(test_a_motor_of_little_flux_has_a_d_current_in_motion);
    RUN_TEST(test_with_an_encoder_or_as_it_is_given_it_is_not_that);
    RUN_TEST(test_bandwidths_that_were_given_do_not_outlive_their_law);
    RUN_TEST(test_a_light_rotor_gets_a_wider_and_sooner_hold);
    RUN_TEST(test_a_hold_that_a_motor_does_not_bear_gets_less_current_in_steps);
    RUN_TEST(test_every_law_has_its_bandwidths);
    RUN_TEST(test_what_is_given_stays);
    RUN_TEST(test_defaults_fit_a_longer_period);
    RUN_TEST(test_a_law_s_bandwidth_is_less_where_most_of_the_inertia_is_behind_a_belt);
    RUN_TEST(test_a_sensorless_law_is_no_quicker_than_the_winding_swings);
    RUN_TEST(test_an_observer_follows_a_light_rotor);
    RUN_TEST(test_an_observer_does_not_chase_counts);
    RUN_TEST(test_every_setting_is_refused_beyond_its_range_by_name_bound_and_unit);
    RUN_TEST(test_a_setting_that_is_not_finite_is_refused);
    RUN_TEST(test_every_element_has_an_index_of_its_own);
    RUN_TEST(test_a_setting_is_found_by_its_place_and_its_index);
    RUN_TEST(test_arrays_keep_their_number_of_elements);
    RUN_TEST(test_a_refusal_says_what_was_asked_and_what_is_allowed);
    RUN_TEST(test_the_rated_current_has_a_range_of_its_own);
    RUN_TEST(test_names_are_spelt_as_scenarios_and_the_serial_line_do);
    return UNITY_END();
}
