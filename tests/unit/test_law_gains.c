/* The gains that a law can be given by name: which there are, and what a drive refuses. */
#include "firmware/control/position_law_dispatch.h"
#include "tests/unit/drive_bench.h"

void setUp(void)
{
    drive_bench_reset();
    encoder_facts.encoder_counts_per_turn = 40000;
    board.facts = &encoder_facts;
    drive_settings_select_feedback(&settings, DRIVE_FEEDBACK_ENCODER);
    settings.encoder_zero_known = true;
}

void tearDown(void)
{
}

/* The contract once more, from outside: of each law in its order. */
static const struct {
    enum position_law law;
    const char *name;
    double min, max;
} gains[] = {
    {POSITION_LAW_FEEDBACK_LINEARISATION, "damping", 0.1, 1.0},
    {POSITION_LAW_FEEDBACK_LINEARISATION, "voltage_disturbance_rad_s", 0.0, 1e6},
    {POSITION_LAW_FEEDBACK_LINEARISATION, "jerk_feed_forward", 0.0, 1.0},
    {POSITION_LAW_FEEDBACK_LINEARISATION, "load_compensation", 0.0, 1.0},
    {POSITION_LAW_MICROSTEPPING, "current_A", 0.0, 100.0},
    {POSITION_LAW_MICROSTEPPING, "voltage_V", 0.0, 1000.0},
    {POSITION_LAW_STMMS, "k1p_per_s", 0.0, 1e6},
    {POSITION_LAW_STMMS, "k0_per_s3", 0.0, 1e12},
    {POSITION_LAW_STMMS, "k1_per_s2", 0.0, 1e9},
    {POSITION_LAW_STMMS, "k2_per_s", 0.0, 1e6},
    {POSITION_LAW_STMMS, "load_compensation", 0.0, 1.0},
    {POSITION_LAW_STMMS_PLUS, "k1p_per_s", 0.0, 1e6},
    {POSITION_LAW_STMMS_PLUS, "k0_per_s3", 0.0, 1e12},
    {POSITION_LAW_STMMS_PLUS, "k1_per_s2", 0.0, 1e9},
    {POSITION_LAW_STMMS_PLUS, "k2_per_s", 0.0, 1e6},
    {POSITION_LAW_STMMS_PLUS, "load_compensation", 0.0, 1.0},
    {POSITION_LAW_STMMS_PLUS, "inductance_feed_forward", 0.0, 1.0},
    {POSITION_LAW_FOC, "k1p_per_s", 0.0, 1e6},
    {POSITION_LAW_FOC, "k0_per_s3", 0.0, 1e12},
    {POSITION_LAW_FOC, "k1_per_s2", 0.0, 1e9},
    {POSITION_LAW_FOC, "k2_per_s", 0.0, 1e6},
    {POSITION_LAW_FOC, "load_compensation", 0.0, 1.0},
    {POSITION_LAW_FOC, "rho_per_s", 0.0, 1e6},
    {POSITION_LAW_FOC, "inductance_feed_forward", 0.0, 1.0},
    {POSITION_LAW_CSMC, "k1", 0.0, 1e9},
    {POSITION_LAW_CSMC, "k2", 0.0, 1e5},
    {POSITION_LAW_CSMC, "mu_d", 0.0001, 1000.0},
    {POSITION_LAW_CSMC, "mu_q", 0.01, 1e7},
    {POSITION_LAW_CSMC, "k0_d", 0.0, 1e5},
    {POSITION_LAW_CSMC, "k0_q", 0.0, 1e5},
    {POSITION_LAW_CSMC, "M_V", 0.01, 1000.0},
    {POSITION_LAW_CSMC_EQUIVALENT, "k1", 0.0, 1e9},
    {POSITION_LAW_CSMC_EQUIVALENT, "k2", 0.0, 1e5},
    {POSITION_LAW_CSMC_EQUIVALENT, "mu_d", 0.0001, 1000.0},
    {POSITION_LAW_CSMC_EQUIVALENT, "mu_q", 0.01, 1e7},
    {POSITION_LAW_CSMC_EQUIVALENT, "k0_d", 0.0, 1e5},
    {POSITION_LAW_CSMC_EQUIVALENT, "k0_q", 0.0, 1e5},
    {POSITION_LAW_CSMC_EQUIVALENT, "resistance_tolerance_ohm", 0.0, 1000.0},
    {POSITION_LAW_CSMC_EQUIVALENT, "inductance_tolerance_H", 0.0, 1.0},
    {POSITION_LAW_CSMC_EQUIVALENT, "q_d_V", 0.0, 1000.0},
    {POSITION_LAW_CSMC_EQUIVALENT, "q_q_V", 0.0, 1000.0},
    {POSITION_LAW_CSMC_SERVO, "k1", 0.0, 1e9},
    {POSITION_LAW_CSMC_SERVO, "k2", 0.0, 1e5},
    {POSITION_LAW_CSMC_SERVO, "mu_d", 0.0001, 1000.0},
    {POSITION_LAW_CSMC_SERVO, "mu_q", 0.01, 1e7},
    {POSITION_LAW_CSMC_SERVO, "M_V", 0.01, 1000.0},
    {POSITION_LAW_CSMC_SERVO, "servo_frequency_rad_s", 0.01, 1e5},
    {POSITION_LAW_CSMC_SERVO, "servo_decay_1_s", 0.01, 1e5},
    {POSITION_LAW_SMC, "k1", 0.0, 1e9},
    {POSITION_LAW_SMC, "k2", 0.0, 1e5},
    {POSITION_LAW_SMC, "M_V", 0.01, 1000.0},
    {POSITION_LAW_SMC, "M_d_V", 0.01, 1000.0},
};

enum { GAINS = sizeof gains / sizeof gains[0] };

/* Of its law, the place of the row. */
static size_t place_of(size_t row)
{
    size_t first = row;

    while (first > 0 && gains[first - 1].law == gains[row].law) {
        first--;
    }
    return row - first;
}

static void test_names_and_ranges_are_those_of_the_contract(void)
{
    for (size_t row = 0; row < GAINS; row++) {
        const struct law_gain_list list = position_law_gains(gains[row].law);
        const bool last = row + 1 == GAINS || gains[row + 1].law != gains[row].law;

        TEST_ASSERT_TRUE(place_of(row) < list.count);
        TEST_ASSERT_EQUAL(last, place_of(row) + 1 == list.count);
        TEST_ASSERT_EQUAL_STRING(gains[row].name, list.gain[place_of(row)].name);
        TEST_ASSERT_TRUE_MESSAGE(list.gain[place_of(row)].min == gains[row].min, gains[row].name);
        TEST_ASSERT_TRUE_MESSAGE(list.gain[place_of(row)].max == gains[row].max, gains[row].name);
    }
    TEST_ASSERT_EQUAL(0, position_law_gains(POSITION_LAW_STATE_FEEDBACK).count);
    TEST_ASSERT_EQUAL(0, position_law_gains(POSITION_LAW_COUNT).count);
}

/* The words with which a drive with this gain is refused; "" if it is not. */
static const char *refusal_of(size_t row, double value)
{
    setUp();
    drive_settings_select_law(&settings, gains[row].law);
    settings.law_gains[place_of(row)] = value;
    error[0] = '\0';
    return drive_init(&drive, &board, &settings, error) ? "" : error;
}

static void test_a_gain_beyond_its_range_is_refused_by_name_and_bound(void)
{
    for (size_t row = 0; row < GAINS; row++) {
        if (gains[row].max < 1e12) { /* that is the range of the setting */
            TEST_ASSERT_EQUAL_STRING_LEN(gains[row].name, refusal_of(row, 2.0 * gains[row].max),
                                         strlen(gains[row].name));
            TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, "must be at most "), error);
            TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, ", the range of this gain"), error);
        }
        TEST_ASSERT_EQUAL_STRING_LEN(gains[row].name, refusal_of(row, gains[row].min - 0.01),
                                     strlen(gains[row].name));
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, "must be at least "), error);
    }
    TEST_ASSERT_EQUAL_STRING("damping 0.09: must be at least 0.1, the range of this gain",
                             refusal_of(0, 0.09));
}

/* What stands at a bound may still be too much for motor and period, but not for the range. */
static void test_the_bounds_belong_to_the_range(void)
{
    for (size_t row = 0; row < GAINS; row++) {
        TEST_ASSERT_NULL_MESSAGE(strstr(refusal_of(row, gains[row].min), "the range"), error);
        TEST_ASSERT_NULL_MESSAGE(strstr(refusal_of(row, gains[row].max), "the range"), error);
    }
}

static void test_more_gains_than_a_law_takes_are_refused(void)
{
    for (size_t i = 0; i < DRIVE_LAW_GAINS; i++) {
        setUp();
        drive_settings_select_law(&settings, POSITION_LAW_STATE_FEEDBACK);
        settings.law_gains[i] = 0.5;
        TEST_ASSERT_FALSE(drive_init(&drive, &board, &settings, error));
        TEST_ASSERT_EQUAL_STRING("law_gains: more are given than the law takes", error);
    }
    drive_settings_select_law(&settings, POSITION_LAW_FEEDBACK_LINEARISATION);
    settings.law_gains[3] = 0.5;
    TEST_ASSERT_TRUE_MESSAGE(drive_init(&drive, &board, &settings, error), error);
    settings.law_gains[4] = 0.5;
    TEST_ASSERT_FALSE(drive_init(&drive, &board, &settings, error));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_names_and_ranges_are_those_of_the_contract);
    RUN_TEST(test_a_gain_beyond_its_range_is_refused_by_name_and_bound);
    RUN_TEST(test_the_bounds_belong_to_the_range);
    RUN_TEST(test_more_gains_than_a_law_takes_are_refused);
    return UNITY_END();
}
