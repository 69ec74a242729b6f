#include "firmware/application/settings_record.h"

enum {
    AT_MOTOR = 0,
    AT_TEETH = 56,
    AT_ENCODER = 60,
    AT_CHOICES = 64,
    AT_FLAGS = 72,
    AT_NUMBERS = 80,
    AT_GAINS = 216,
    AT_DETENT = 312,
    MOTOR_NUMBERS = 7,
    NUMBERS = 17,
    FLAGS = 9
};

static const struct record_log log_of_settings = {.first_page = SETTINGS_RECORD_FIRST_PAGE,
                                                  .format = SETTINGS_RECORD_FORMAT,
                                                  .payload_bytes = SETTINGS_RECORD_PAYLOAD};

/* The bits of a double. */
union double_bits {
    double value;
    uint64_t bits;
};

static void put_double(uint8_t *at, double value)
{
    record_put(at, (union double_bits){.value = value}.bits, 8);
}

static double get_double(const uint8_t *at)
{
    return (union double_bits){.bits = record_get(at, 8)}.value;
}

/* Addresses of the fields in the order of the record, of settings that may be read or written. */
struct fields {
    double *motor[MOTOR_NUMBERS];
    double *number[NUMBERS];
    bool *flag[FLAGS];
};

static struct fields fields_of(struct drive_settings *s)
{
    struct motor_params *m = &s->motor;

    return (struct fields){
        .motor = {&m->resistance_ohm, &m->inductance_H, &m->torque_constant_Nm_A,
                  &m->viscous_friction_Nms_rad, &m->inertia_kgm2, &m->rated_current_A,
                  &m->supply_V},
        .number = {&s->law_bandwidth_rad_s, &s->current_bandwidth_rad_s, &s->current_limit_A,
                   &s->overcurrent_trip_A, &s->speed_limit_rad_s, &s->observer_bandwidth_rad_s,
                   &s->high_gain_epsilon_s, &s->encoder_zero_rad, &s->initial_load_torque_Nm,
                   &s->hold_on_enable_s, &s->hold_current_A, &s->hold_ramp_s, &s->hold_delay_s,
                   &s->hold_bandwidth_rad_s, &s->initial_angle_rad, &s->initial_angle_error_rad,
                   &s->motion_current_A},
        .flag = {&s->feed_forward, &s->detent_learning, &s->bridge_loss_compensation,
                 &s->resistance_adaptation, &s->encoder_zero_known, &s->calibrate_offsets,
                 &s->hold_on_enable, &s->hold_at_rest, &s->standstill_pulses},
    };
}

static void encode(const struct stored_settings *settings, uint8_t *payload)
{
    struct drive_settings drive = settings->drive;
    const struct fields fields = fields_of(&drive);
    uint32_t flags = 0;

    for (int i = 0; i < MOTOR_NUMBERS; i++) {
        put_double(&payload[AT_MOTOR + 8 * i], *fields.motor[i]);
    }
    record_put(&payload[AT_TEETH], (uint32_t)drive.motor.rotor_teeth, 4);
    record_put(&payload[AT_ENCODER], settings->encoder_counts_per_turn, 4);
    payload[AT_CHOICES + 0] = (uint8_t)drive.law;
    payload[AT_CHOICES + 1] = (uint8_t)drive.feedback;
    payload[AT_CHOICES + 2] = (uint8_t)drive.estimator;
    payload[AT_CHOICES + 3] = (uint8_t)drive.observer;
    payload[AT_CHOICES + 4] = (uint8_t)drive.voltage_source;
    payload[AT_CHOICES + 5] = (uint8_t)drive.initial_position;
    payload[AT_CHOICES + 6] = (uint8_t)drive.synchronism_policy;
    payload[AT_CHOICES + 7] = 0;
    for (int i = 0; i < FLAGS; i++) {
        flags |= *fields.flag[i] ? 1u << i : 0u;
    }
    record_put(&payload[AT_FLAGS], flags, 8);
    for (int i = 0; i < NUMBERS; i++) {
        put_double(&payload[AT_NUMBERS + 8 * i], *fields.number[i]);
    }
    for (int i = 0; i < DRIVE_LAW_GAINS; i++) {
        put_double(&payload[AT_GAINS + 8 * i], drive.law_gains[i]);
    }
    for (int i = 0; i < DRIVE_DETENT_COEFFICIENTS; i++) {
        put_double(&payload[AT_DETENT + 8 * i], drive.detent_torque_Nm[i]);
    }
}

static bool choices_are_known(const uint8_t *payload)
{
    return payload[AT_CHOICES + 0] < POSITION_LAW_COUNT &&
           payload[AT_CHOICES + 1] < DRIVE_FEEDBACKS &&
           payload[AT_CHOICES + 2] < DRIVE_ESTIMATORS &&
           payload[AT_CHOICES + 3] < DRIVE_OBSERVERS &&
           payload[AT_CHOICES + 4] < DRIVE_VOLTAGE_SOURCES &&
           payload[AT_CHOICES + 5] < DRIVE_INITIAL_POSITIONS &&
           payload[AT_CHOICES + 6] < DRIVE_SYNCHRONISM_POLICIES;
}

static bool decode(struct stored_settings *settings, const uint8_t *payload)
{
    struct drive_settings *drive = &settings->drive;

    if (!choices_are_known(payload)) {
        return false;
    }
    const struct fields fields = fields_of(drive);
    const uint32_t flags = (uint32_t)record_get(&payload[AT_FLAGS], 4);

    for (int i = 0; i < MOTOR_NUMBERS; i++) {
        *fields.motor[i] = get_double(&payload[AT_MOTOR + 8 * i]);
    }
    drive->motor.rotor_teeth = (int32_t)(uint32_t)record_get(&payload[AT_TEETH], 4);
    settings->encoder_counts_per_turn = (uint32_t)record_get(&payload[AT_ENCODER], 4);
    drive->law = (enum position_law)payload[AT_CHOICES + 0];
    drive->feedback = (enum drive_feedback)payload[AT_CHOICES + 1];
    drive->estimator = (enum drive_estimator)payload[AT_CHOICES + 2];
    drive->observer = (enum drive_observer)payload[AT_CHOICES + 3];
    drive->voltage_source = (enum drive_voltage_source)payload[AT_CHOICES + 4];
    drive->initial_position = (enum drive_initial_position)payload[AT_CHOICES + 5];
    drive->synchronism_policy = (enum drive_synchronism_policy)payload[AT_CHOICES + 6];
    for (int i = 0; i < FLAGS; i++) {
        *fields.flag[i] = ((flags >> i) & 1u) != 0u;
    }
    for (int i = 0; i < NUMBERS; i++) {
        *fields.number[i] = get_double(&payload[AT_NUMBERS + 8 * i]);
    }
    for (int i = 0; i < DRIVE_LAW_GAINS; i++) {
        drive->law_gains[i] = get_double(&payload[AT_GAINS + 8 * i]);
    }
    for (int i = 0; i < DRIVE_DETENT_COEFFICIENTS; i++) {
        drive->detent_torque_Nm[i] = get_double(&payload[AT_DETENT + 8 * i]);
    }
    return true;
}

void settings_record_encode(const struct stored_settings *settings, uint32_t sequence,
                            uint8_t record[SETTINGS_RECORD_BYTES])
{
    encode(settings, &record[RECORD_HEADER_BYTES]);
    record_seal(&log_of_settings, record, sequence);
}

bool settings_record_decode(struct stored_settings *settings,
                            const uint8_t record[SETTINGS_RECORD_BYTES])
{
    return record_is_valid(&log_of_settings, record) &&
           decode(settings, &record[RECORD_HEADER_BYTES]);
}

bool settings_record_read(const struct hal *board, struct stored_settings *settings)
{
    uint8_t slot[RECORD_SLOT_BYTES(SETTINGS_RECORD_PAYLOAD)];

    return record_log_read(board, &log_of_settings, slot) &&
           decode(settings, &slot[RECORD_HEADER_BYTES]);
}

bool settings_record_write(const struct hal *board, const struct stored_settings *settings)
{
    uint8_t slot[RECORD_SLOT_BYTES(SETTINGS_RECORD_PAYLOAD)];

    encode(settings, &slot[RECORD_HEADER_BYTES]);
    return record_log_write(board, &log_of_settings, slot);
}
