#include "firmware/application/settings_record.h"

#include <string.h>
#include <unity.h>

#include "tests/unit/console_bench.h"

static struct hal_facts facts;
static struct hal board;

void setUp(void)
{
    bench_power_up();
    facts = bench_stored_facts();
    board = bench_board(&facts);
}

void tearDown(void)
{
}

/* Every field another value, none of them a default. */
static struct stored_settings peculiar(void)
{
    struct stored_settings s = {.encoder_counts_per_turn = 16384};
    struct drive_settings *d = &s.drive;
    double next = 0.1;

    drive_settings_default(d, &bench_params);
    double *const numbers[] = {&d->motor.resistance_ohm,
                               &d->motor.inductance_H,
                               &d->motor.torque_constant_Nm_A,
                               &d->motor.viscous_friction_Nms_rad,
                               &d->motor.inertia_kgm2,
                               &d->motor.rated_current_A,
                               &d->motor.supply_V,
                               &d->law_bandwidth_rad_s,
                               &d->current_bandwidth_rad_s,
                               &d->current_limit_A,
                               &d->overcurrent_trip_A,
                               &d->speed_limit_rad_s,
                               &d->observer_bandwidth_rad_s,
                               &d->high_gain_epsilon_s,
                               &d->encoder_zero_rad,
                               &d->initial_load_torque_Nm,
                               &d->hold_on_enable_s,
                               &d->hold_current_A,
                               &d->hold_ramp_s,
                               &d->hold_delay_s,
                               &d->hold_bandwidth_rad_s,
                               &d->initial_angle_rad,
                               &d->initial_angle_error_rad,
                               &d->motion_current_A};
    bool *const flags[] = {
        &d->feed_forward,          &d->detent_learning,    &d->bridge_loss_compensation,
        &d->resistance_adaptation, &d->encoder_zero_known, &d->calibrate_offsets,
        &d->hold_on_enable,        &d->hold_at_rest,       &d->standstill_pulses};

    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++, next += 0.7) {
        *numbers[i] = next;
    }
    for (size_t i = 0; i < sizeof flags / sizeof flags[0]; i++) {
        *flags[i] = !*flags[i];
    }
    for (int i = 0; i < DRIVE_LAW_GAINS; i += 2, next -= 40.1) {
        d->law_gains[i] = next; /* between them NaN */
    }
    for (int i = 0; i < DRIVE_DETENT_COEFFICIENTS; i++, next += 1e-7) {
        d->detent_torque_Nm[i] = next;
    }
    d->motor.rotor_teeth = -50;
    d->law = POSITION_LAW_FEEDBACK_LINEARISATION;
    d->feedback = DRIVE_FEEDBACK_ENCODER;
    d->estimator = DRIVE_ESTIMATOR_STEADY_STATE_EKF;
    d->observer = DRIVE_OBSERVER_HIGH_GAIN;
    d->voltage_source = DRIVE_VOLTAGE_COMMANDED;
    d->initial_position = DRIVE_INITIAL_POSITION_IMPULSES;
    d->synchronism_policy = DRIVE_SYNCHRONISM_WARN;
    return s;
}

/* Encoding is one to one: equal settings have equal records. */
static void assert_same(const struct stored_settings *a, const struct stored_settings *b)
{
    uint8_t first[SETTINGS_RECORD_BYTES];
    uint8_t second[SETTINGS_RECORD_BYTES];

    settings_record_encode(a, 1, first);
    settings_record_encode(b, 1, second);
    TEST_ASSERT_EQUAL_UINT8_ARRAY(first, second, sizeof first);
}

static void test_every_field_comes_back(void)
{
    struct stored_settings in = peculiar();
    struct stored_settings out;
    uint8_t record[SETTINGS_RECORD_BYTES];

    memset(&out, 0x55, sizeof out);
    settings_record_encode(&in, 7, record);
    TEST_ASSERT_TRUE(settings_record_decode(&out, record));
    TEST_ASSERT_EQUAL_UINT32(16384, out.encoder_counts_per_turn);
    TEST_ASSERT_EQUAL_INT32(-50, out.drive.motor.rotor_teeth);
    TEST_ASSERT_TRUE(out.drive.motor.resistance_ohm == in.drive.motor.resistance_ohm);
    TEST_ASSERT_TRUE(out.drive.initial_angle_error_rad == in.drive.initial_angle_error_rad);
    TEST_ASSERT_TRUE(out.drive.law_gains[10] == in.drive.law_gains[10]);
    TEST_ASSERT_TRUE(out.drive.law_gains[11] != out.drive.law_gains[11]);
    TEST_ASSERT_TRUE(out.drive.detent_torque_Nm[5] == in.drive.detent_torque_Nm[5]);
    TEST_ASSERT_EQUAL_INT(POSITION_LAW_FEEDBACK_LINEARISATION, out.drive.law);
    TEST_ASSERT_EQUAL_INT(DRIVE_OBSERVER_HIGH_GAIN, out.drive.observer);
    TEST_ASSERT_EQUAL_INT(DRIVE_VOLTAGE_COMMANDED, out.drive.voltage_source);
    TEST_ASSERT_EQUAL_INT(DRIVE_INITIAL_POSITION_IMPULSES, out.drive.initial_position);
    TEST_ASSERT_EQUAL_INT(DRIVE_SYNCHRONISM_WARN, out.drive.synchronism_policy);
    TEST_ASSERT_FALSE(out.drive.hold_on_enable);
    TEST_ASSERT_TRUE(out.drive.encoder_zero_known);
    assert_same(&in, &out);
}

/* Each field has a place of its own: what differs in one, differs in the record. */
static void test_every_field_has_its_own_place(void)
{
    const struct stored_settings in = peculiar();
    uint8_t record[SETTINGS_RECORD_BYTES];
    struct stored_settings out;

    settings_record_encode(&in, 7, record);
    for (size_t i = RECORD_HEADER_BYTES; i < RECORD_HEADER_BYTES + SETTINGS_RECORD_PAYLOAD; i++) {
        if (i >= 72u && i < 80u) {
            continue; /* choices */
        }
        if (i > 81u && i < 88u) {
            continue; /* flags: nine are in use */
        }
        uint8_t harmed[SETTINGS_RECORD_BYTES];

        memcpy(harmed, record, sizeof harmed);
        harmed[i] ^= 1u;
        TEST_ASSERT_FALSE(settings_record_decode(&out, harmed));
        const uint32_t sequence = 7;
        const struct record_log log = {SETTINGS_RECORD_FIRST_PAGE, SETTINGS_RECORD_FORMAT,
                                       SETTINGS_RECORD_PAYLOAD};

        record_seal(&log, harmed, sequence);
        TEST_ASSERT_TRUE(settings_record_decode(&out, harmed));
        uint8_t again[SETTINGS_RECORD_BYTES];

        settings_record_encode(&out, sequence, again);
        TEST_ASSERT_EQUAL_UINT8_ARRAY(harmed, again, sizeof harmed);
    }
}

/* The layout of settings_record.h, in bytes: stores of today are read tomorrow. */
static void test_the_layout_stays(void)
{
    struct stored_settings in = peculiar();
    uint8_t record[SETTINGS_RECORD_BYTES];
    static const uint8_t head[] = {0x03, 0x53, 0x74, 0x01, 0x04, 0x03, 0x02, 0x01};
    static const uint8_t one[] = {0, 0, 0, 0, 0, 0, 0xf0, 0x3f};
    static const uint8_t choices[] = {POSITION_LAW_FEEDBACK_LINEARISATION, 1, 1, 1, 1, 1, 1, 0};
    const uint8_t *payload = &record[RECORD_HEADER_BYTES];

    in.drive.motor.supply_V = 1.0;
    in.drive.hold_delay_s = 1.0;
    settings_record_encode(&in, 0x01020304, record);
    TEST_ASSERT_EQUAL_UINT8_ARRAY(head, record, sizeof head);
    TEST_ASSERT_EQUAL_UINT8_ARRAY(one, &payload[48], sizeof one);
    TEST_ASSERT_EQUAL_UINT8(0x40, payload[61]);
    TEST_ASSERT_EQUAL_UINT8_ARRAY(choices, &payload[64], sizeof choices);
    TEST_ASSERT_EQUAL_UINT8(0x12, payload[72]); /* detent learning, zero known */
    TEST_ASSERT_EQUAL_UINT8(0x01, payload[73]); /* standstill pulses */
    TEST_ASSERT_EQUAL_UINT8_ARRAY(one, &payload[176], sizeof one);
    TEST_ASSERT_EQUAL_INT(360, SETTINGS_RECORD_PAYLOAD);
}

static void test_an_unknown_law_is_no_record(void)
{
    const struct record_log log = {SETTINGS_RECORD_FIRST_PAGE, SETTINGS_RECORD_FORMAT,
                                   SETTINGS_RECORD_PAYLOAD};
    const struct stored_settings in = peculiar();
    struct stored_settings out;
    uint8_t record[SETTINGS_RECORD_BYTES];

    for (int choice = 0; choice < 7; choice++) {
        settings_record_encode(&in, 1, record);
        record[RECORD_HEADER_BYTES + 64 + choice] = 200;
        record_seal(&log, record, 1);
        TEST_ASSERT_FALSE(settings_record_decode(&out, record));
    }
}

static void test_the_newest_of_many_is_read_beside_what_is_learned(void)
{
    struct stored_settings in = peculiar();
    struct stored_settings out;

    TEST_ASSERT_FALSE(settings_record_read(&board, &out));
    for (uint32_t i = 1; i <= 30; i++) { /* one to a page */
        in.encoder_counts_per_turn = i;
        TEST_ASSERT_TRUE(settings_record_write(&board, &in));
        TEST_ASSERT_TRUE(settings_record_read(&board, &out));
        TEST_ASSERT_EQUAL_UINT32(i, out.encoder_counts_per_turn);
    }
    assert_same(&in, &out);
    for (int i = 0; i < 2 * BENCH_PAGE; i++) { /* pages 0 and 1 are the learned parameters' */
        TEST_ASSERT_EQUAL_HEX8(0xff, bench.store[i]);
    }
}

/* As a host prepares a store: the record at the begin of page 2. */
static void test_an_encoded_record_in_page_2_is_read(void)
{
    const struct stored_settings in = peculiar();
    struct stored_settings out;

    settings_record_encode(&in, 1, &bench.store[2 * BENCH_PAGE]);
    TEST_ASSERT_TRUE(settings_record_read(&board, &out));
    assert_same(&in, &out);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_field_comes_back);
    RUN_TEST(test_every_field_has_its_own_place);
    RUN_TEST(test_the_layout_stays);
    RUN_TEST(test_an_unknown_law_is_no_record);
    RUN_TEST(test_the_newest_of_many_is_read_beside_what_is_learned);
    RUN_TEST(test_an_encoded_record_in_page_2_is_read);
    return UNITY_END();
}
