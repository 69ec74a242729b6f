#include "firmware/application/settings_record.h"

#include "firmware/interface/settings.h"

static const struct record_log log_of_settings = {.first_page = SETTINGS_RECORD_FIRST_PAGE,
                                                  .format = SETTINGS_RECORD_FORMAT,
                                                  .payload_bytes = SETTINGS_RECORD_PAYLOAD};

/* The bits of a double. */
union double_bits {
    double value;
    uint64_t bits;
};

enum { SIZE_1, SIZE_4, SIZE_8, SIZE_SHIFT = 14 };

/* All settings, each with its key. */
#define REAL_ENTRY(index, member, ...)     uint8_t member[2 + 8];
#define COUNT_ENTRY(index, member, ...)    uint8_t member[2 + 4];
#define BYTE_ENTRY(index, member, ...)     uint8_t member[2 + 1];
#define REALS_ENTRY(index, member, n, ...) uint8_t member[n][2 + 8];
struct all_entries {
    MOTOR_SETTINGS(REAL_ENTRY, COUNT_ENTRY)
    DRIVE_SETTINGS(BYTE_ENTRY, BYTE_ENTRY, REAL_ENTRY, REALS_ENTRY, COUNT_ENTRY)
};
_Static_assert(sizeof(struct all_entries) <= SETTINGS_RECORD_PAYLOAD, "the record has no place");

static const uint8_t bytes_of[] = {[SIZE_1] = 1, [SIZE_4] = 4, [SIZE_8] = 8};

static uint8_t *put_entry(uint8_t *at, uint16_t index, unsigned size, uint64_t value)
{
    record_put(at, index | size << SIZE_SHIFT, 2);
    record_put(at + 2, value, bytes_of[size]);
    return at + 2 + bytes_of[size];
}

static uint8_t *put_setting(uint8_t *at, const struct drive_settings *settings,
                            const struct setting *setting, size_t element)
{
    const uint16_t index = (uint16_t)(setting->index + element);
    const double value = setting_get(settings, setting, element);

    if (setting->type == SETTING_COUNT) {
        return put_entry(at, index, SIZE_4, (uint32_t)(int32_t)value);
    }
    if (setting->type != SETTING_REAL) {
        return put_entry(at, index, SIZE_1, (uint8_t)value);
    }
    return value == value ? put_entry(at, index, SIZE_8, (union double_bits){.value = value}.bits)
                          : at;
}

static void encode(const struct drive_settings *settings, uint8_t *payload)
{
    uint8_t *at = payload;

    for (size_t i = 0; setting_number(i) != NULL; i++) {
        for (size_t element = 0; element < setting_number(i)->count; element++) {
            at = put_setting(at, settings, setting_number(i), element);
        }
    }
    while (at != payload + SETTINGS_RECORD_PAYLOAD) {
        *at++ = 0;
    }
}

/* The next entry; false at the end. */
struct entry {
    uint16_t index;
    unsigned size;
    uint64_t value;
};

static bool next_entry(const uint8_t *payload, size_t *at, struct entry *entry)
{
    if (*at + 2u > SETTINGS_RECORD_PAYLOAD) {
        return false;
    }
    const uint32_t key = (uint32_t)record_get(&payload[*at], 2);

    entry->index = (uint16_t)(key & ((1u << SIZE_SHIFT) - 1u));
    entry->size = key >> SIZE_SHIFT;
    if (key == 0u || entry->size > SIZE_8 ||
        *at + 2u + bytes_of[entry->size] > SETTINGS_RECORD_PAYLOAD) {
        return false;
    }
    entry->value = record_get(&payload[*at + 2u], bytes_of[entry->size]);
    *at += 2u + bytes_of[entry->size];
    return true;
}

/* false: a choice that there is not. */
static bool take(struct drive_settings *settings, const struct setting *setting,
                 const struct entry *entry)
{
    const double value = entry->size == SIZE_8 ? (union double_bits){.bits = entry->value}.value
                                               : (double)(int32_t)(uint32_t)entry->value;

    if (setting->type == SETTING_CHOICE && !(value >= 0.0 && value <= setting->most)) {
        return false;
    }
    setting_put(settings, setting, (size_t)(entry->index - setting->index),
                setting->type == SETTING_FLAG ? value != 0.0 : value);
    return true;
}

/* Entries of the motor, or all others; how many of them, or -1 for one that is unknown. */
static int take_entries(struct drive_settings *settings, const uint8_t *payload, bool of_motor)
{
    struct entry entry;
    int count = 0;

    for (size_t at = 0; next_entry(payload, &at, &entry);) {
        const struct setting *setting = setting_of_index(entry.index);

        if (setting != NULL && setting_is_of_motor(setting) == of_motor) {
            if (!take(settings, setting, &entry)) {
                return -1;
            }
            count++;
        }
    }
    return count;
}

static bool decode(struct drive_settings *settings, const uint8_t *payload)
{
    if (take_entries(settings, payload, true) != SETTINGS_OF_MOTOR) {
        return false;
    }
    const struct motor_params motor = settings->motor;

    drive_settings_default(settings, &motor);
    return take_entries(settings, payload, false) >= 0;
}

void settings_record_encode(const struct drive_settings *settings, uint32_t sequence,
                            uint8_t record[SETTINGS_RECORD_BYTES])
{
    encode(settings, &record[RECORD_HEADER_BYTES]);
    record_seal(&log_of_settings, record, sequence);
}

bool settings_record_decode(struct drive_settings *settings,
                            const uint8_t record[SETTINGS_RECORD_BYTES])
{
    return record_is_valid(&log_of_settings, record) &&
           decode(settings, &record[RECORD_HEADER_BYTES]);
}

bool settings_record_read(const struct hal *board, struct drive_settings *settings)
{
    uint8_t slot[RECORD_SLOT_BYTES(SETTINGS_RECORD_PAYLOAD)];

    return record_log_read(board, &log_of_settings, slot) &&
           decode(settings, &slot[RECORD_HEADER_BYTES]);
}

enum record_writing settings_record_write(const struct hal *board,
                                          const struct drive_settings *settings)
{
    uint8_t slot[RECORD_SLOT_BYTES(SETTINGS_RECORD_PAYLOAD)];

    encode(settings, &slot[RECORD_HEADER_BYTES]);
    return record_log_write(board, &log_of_settings, slot);
}
