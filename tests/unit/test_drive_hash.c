/* Equal hashes prove that two drives did the same: so each gain and each signal must change it. */
#include "firmware/drive/drive_hash.h"
#include "tests/unit/drive_bench.h"

static const uint64_t basis = UINT64_C(0xcbf29ce484222325);

static struct drive_params params;

void setUp(void)
{
    drive_bench_reset();
    power_up();
    params = drive.params;
}

void tearDown(void)
{
}

/* A coef_t at `gain` of `params`, changed by little, changes the hash. */
static void counts(void *gain)
{
    uint8_t *byte = gain;
    const uint64_t before = drive_hash_gains(&params);

    *byte ^= 0x40u;
    TEST_ASSERT_TRUE(before != drive_hash_gains(&params));
    *byte ^= 0x40u;
    TEST_ASSERT_EQUAL_HEX64(before, drive_hash_gains(&params));
}

static void count_all(coef_t *first, const coef_t *last)
{
    for (coef_t *gain = first; gain <= last; gain++) {
        counts(gain);
    }
}

/* FNV-1a over words of 32 bits; by another program. */
static void test_a_word_is_added_as_fnv_does(void)
{
    const struct drive_hash_row row = {{1, 2, 3, 4, 5, 6, 7, 8, 9}};

    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0xa3b5f56b08296d07), drive_hash_word(basis, 0x12345678u));
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0xd824008dad4b6b6c), drive_hash_add(basis, row));
}

static void test_every_gain_of_the_default_drive_counts(void)
{
    struct invariant_ekf_params *ekf = &params.estimator.invariant_ekf;

    count_all(&params.measurement.current, &params.measurement.bus_voltage);
    count_all(&params.model.rate, &params.model.admittance_per_resistance);
    count_all(&ekf->moving.current, &ekf->moving.load_settle);
    count_all(&ekf->holding.current, &ekf->holding.load_settle);
    count_all(&ekf->unloaded.current, &ekf->unloaded.load_settle);
    count_all(&ekf->following.current, &ekf->following.load_settle);
    count_all(&params.reference.speed, &params.reference.jerk);
    count_all(&params.current_control.proportional, &params.current_control.reactance);
    counts(&params.hold.damping);
    counts(&params.modulator.counts);
}

static void test_every_gain_of_the_other_estimators_counts(void)
{
    struct steady_state_ekf_params *ekf = &params.estimator.steady_state_ekf;
    struct encoder_observer_params *encoder = &params.estimator.encoder_observer;
    struct high_gain_observer_params *high_gain = &params.estimator.high_gain_observer;

    memset(&params.estimator, 0, sizeof params.estimator);
    params.estimator.kind = ESTIMATOR_STEADY_STATE_EKF;
    count_all(&ekf->rotation, &ekf->gain_load);
    params.estimator.kind = ESTIMATOR_ENCODER_OBSERVER;
    count_all(&encoder->gain_angle, &encoder->gain_resistance);
    params.estimator.kind = ESTIMATOR_HIGH_GAIN_OBSERVER;
    count_all(&encoder->gain_angle, &encoder->gain_resistance);
    count_all(&high_gain->transition[0][0], &high_gain->acceleration_per_turn);
}

static void test_every_byte_of_the_law_counts_and_no_other(void)
{
    memset(&params.law, 0, sizeof params.law);
#define LAW_COUNTS(constant, function, text)                                                       \
    params.position_law = POSITION_LAW_##constant;                                                 \
    for (size_t i = 0; i < sizeof params.law.function; i++) {                                      \
        counts((uint8_t *)&params.law + i);                                                        \
    }
    POSITION_LAWS(LAW_COUNTS)
#undef LAW_COUNTS
    params.position_law = POSITION_LAW_STATE_FEEDBACK;
    const uint64_t before = drive_hash_gains(&params);

    ((uint8_t *)&params.law)[sizeof params.law.state_feedback] ^= 0x40u;
    TEST_ASSERT_EQUAL_HEX64(before, drive_hash_gains(&params));
}

static void test_the_hash_of_no_gain_is_that_of_its_words_alone(void)
{
    struct drive_params none;
    uint64_t expected = basis;
    const size_t gains = 3 + 7 + 4 * 12 + 4 + sizeof none.law.state_feedback + 4 + 2;

    memset(&none, 0, sizeof none);
    for (size_t i = 0; i < gains; i++) {
        expected = drive_hash_word(expected, 0);
    }
    TEST_ASSERT_EQUAL_HEX64(expected, drive_hash_gains(&none));
}

static void test_a_row_has_each_signal_in_its_word(void)
{
    const struct hal_outputs outputs = {.bridge_on = true, .high_counts = {1, 2, 3, 4}};
    struct drive_hash_row row;

    drive.supervision.state = DRIVE_OPERATION_ENABLED;
    drive.estimator.estimate.rotor.position = (struct position){-5, 6};
    drive.estimator.estimate.rotor.speed = NUM(0.25);
    drive.estimator.estimate.rotor.load_torque = NUM(-0.5);
    drive.current = (struct dq){NUM(0.125), NUM(-1.0)};
    row = drive_hash_row(&drive, &outputs);
    TEST_ASSERT_EQUAL_HEX32(0x00010002, row.word[0]);
    TEST_ASSERT_EQUAL_HEX32(0x00030004, row.word[1]);
    TEST_ASSERT_EQUAL_HEX32(((uint32_t)DRIVE_OPERATION_ENABLED << 1) | 1u, row.word[2]);
    TEST_ASSERT_EQUAL_HEX32(0xfffffffb, row.word[3]);
    TEST_ASSERT_EQUAL_HEX32(6, row.word[4]);
    TEST_ASSERT_EQUAL_HEX32(num_bits(NUM(0.25)), row.word[5]);
    TEST_ASSERT_EQUAL_HEX32(num_bits(NUM(-0.5)), row.word[6]);
    TEST_ASSERT_EQUAL_HEX32(num_bits(NUM(0.125)), row.word[7]);
    TEST_ASSERT_EQUAL_HEX32(num_bits(NUM(-1.0)), row.word[8]);
    row = drive_hash_row(&drive, &(struct hal_outputs){.bridge_on = false});
    TEST_ASSERT_EQUAL_HEX32((uint32_t)DRIVE_OPERATION_ENABLED << 1, row.word[2]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_word_is_added_as_fnv_does);
    RUN_TEST(test_every_gain_of_the_default_drive_counts);
    RUN_TEST(test_every_gain_of_the_other_estimators_counts);
    RUN_TEST(test_every_byte_of_the_law_counts_and_no_other);
    RUN_TEST(test_the_hash_of_no_gain_is_that_of_its_words_alone);
    RUN_TEST(test_a_row_has_each_signal_in_its_word);
    return UNITY_END();
}
