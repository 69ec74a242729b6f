#include "firmware/interface/settings.h"

#include <string.h>

#include "firmware/design/refusal.h"
#include "firmware/interface/parts_carried.h"

#define VALUE_FIXED(value) (value)
#define VALUE_RATED(share) (share)
#define VALUE_FOLLOWS      __builtin_nan("")
#define VALUE_COMPUTED     0.0
#define BASE_FIXED(value)  SETTING_FIXED
#define BASE_RATED(share)  SETTING_RATED
#define BASE_FOLLOWS       SETTING_FOLLOWS
#define BASE_COMPUTED      SETTING_COMPUTED
#define WHEN_AT_ENABLE     false
#define WHEN_IN_MOTION     true

#define CHOICE_TEXT(constant, text, sentence) text,
#define LAW_TEXT(constant, function, text)    text,

static const char *const feedback_texts[] = {DRIVE_FEEDBACK_CHOICES(CHOICE_TEXT)};
static const char *const law_texts[] = {POSITION_LAWS(LAW_TEXT)};
static const char *const estimator_texts[] = {DRIVE_ESTIMATOR_CHOICES(CHOICE_TEXT)};
static const char *const observer_texts[] = {DRIVE_OBSERVER_CHOICES(CHOICE_TEXT)};
static const char *const voltage_source_texts[] = {DRIVE_VOLTAGE_SOURCE_CHOICES(CHOICE_TEXT)};
static const char *const initial_position_texts[] = {DRIVE_INITIAL_POSITION_CHOICES(CHOICE_TEXT)};
static const char *const synchronism_policy_texts[] = {
    DRIVE_SYNCHRONISM_POLICY_CHOICES(CHOICE_TEXT)};

#define SIZE_OF(member) sizeof(((struct drive_settings *)0)->member)

#define MOTOR_ROW(kind, at, member, in_unit, lowest, highest)                                      \
    {.name = #member,                                                                              \
     .index = (at),                                                                                \
     .type = (kind),                                                                               \
     .count = 1,                                                                                   \
     .unit = (in_unit),                                                                            \
     .least = VALUE_##lowest,                                                                      \
     .most = VALUE_##highest,                                                                      \
     .least_base = BASE_##lowest,                                                                  \
     .most_base = BASE_##highest,                                                                  \
     .size = SIZE_OF(motor.member),                                                                \
     .offset = offsetof(struct drive_settings, motor.member)},
#define MOTOR_REAL(at, member, unit, least, most, sentence)                                        \
    MOTOR_ROW(SETTING_REAL, at, member, unit, least, most)
#define MOTOR_COUNT(at, member, unit, least, most, sentence)                                       \
    MOTOR_ROW(SETTING_COUNT, at, member, unit, least, most)

#define REALS_ROW(at, member, elements, in_unit, lowest, highest, initial, when, sentence)         \
    {.name = #member,                                                                              \
     .index = (at),                                                                                \
     .type = SETTING_REAL,                                                                         \
     .count = (elements),                                                                          \
     .unit = (in_unit),                                                                            \
     .least = VALUE_##lowest,                                                                      \
     .most = VALUE_##highest,                                                                      \
     .preset = VALUE_##initial,                                                                    \
     .least_base = BASE_##lowest,                                                                  \
     .most_base = BASE_##highest,                                                                  \
     .preset_base = BASE_##initial,                                                                \
     .in_motion = WHEN_##when,                                                                     \
     .size = sizeof(double),                                                                       \
     .offset = offsetof(struct drive_settings, member)},
#define REAL_ROW(at, member, unit, least, most, preset, when, sentence)                            \
    REALS_ROW(at, member, 1, unit, least, most, preset, when, sentence)
#define COUNT_ROW(at, member, in_unit, lowest, highest, initial, when, sentence)                   \
    {.name = #member,                                                                              \
     .index = (at),                                                                                \
     .type = SETTING_COUNT,                                                                        \
     .count = 1,                                                                                   \
     .unit = (in_unit),                                                                            \
     .least = VALUE_##lowest,                                                                      \
     .most = VALUE_##highest,                                                                      \
     .preset = VALUE_##initial,                                                                    \
     .least_base = BASE_##lowest,                                                                  \
     .most_base = BASE_##highest,                                                                  \
     .in_motion = WHEN_##when,                                                                     \
     .size = SIZE_OF(member),                                                                      \
     .offset = offsetof(struct drive_settings, member)},
#define FLAG_ROW(at, member, initial, when, sentence)                                              \
    {.name = #member,                                                                              \
     .index = (at),                                                                                \
     .type = SETTING_FLAG,                                                                         \
     .count = 1,                                                                                   \
     .unit = "",                                                                                   \
     .most = 1.0,                                                                                  \
     .preset = (initial),                                                                          \
     .in_motion = WHEN_##when,                                                                     \
     .size = SIZE_OF(member),                                                                      \
     .offset = offsetof(struct drive_settings, member)},
#define CHOICE_ROW(at, member, enumeration, constants, initial, when, sentence)                    \
    {.name = #member,                                                                              \
     .index = (at),                                                                                \
     .type = SETTING_CHOICE,                                                                       \
     .count = 1,                                                                                   \
     .unit = "",                                                                                   \
     .choices = member##_texts,                                                                    \
     .most = (constants)-1,                                                                        \
     .preset = (initial),                                                                          \
     .in_motion = WHEN_##when,                                                                     \
     .size = SIZE_OF(member),                                                                      \
     .offset = offsetof(struct drive_settings, member)},

static const struct setting rows[] = {MOTOR_SETTINGS(MOTOR_REAL, MOTOR_COUNT) DRIVE_SETTINGS(
    CHOICE_ROW, FLAG_ROW, REAL_ROW, REALS_ROW, COUNT_ROW)};

enum { ROWS = sizeof rows / sizeof rows[0] };

const struct setting *setting_number(size_t number)
{
    return number < ROWS ? &rows[number] : NULL;
}

const struct setting *setting_of_index(uint16_t index)
{
    for (size_t i = 0; i < ROWS; i++) {
        if (index >= rows[i].index && index < rows[i].index + rows[i].count) {
            return &rows[i];
        }
    }
    return NULL;
}

const struct setting *setting_at(size_t offset)
{
    for (size_t i = 0; i < ROWS; i++) {
        if (rows[i].offset == offset) {
            return &rows[i];
        }
    }
    return NULL;
}

/* A whole number of one to four bytes is as wide as the compiler has made its member. */
static int32_t get_whole(const uint8_t *at, size_t size)
{
    int32_t value;

    if (size == sizeof value) {
        memcpy(&value, at, sizeof value);
        return value;
    }
    return *at;
}

static void put_whole(uint8_t *at, size_t size, int32_t value)
{
    if (size == sizeof value) {
        memcpy(at, &value, sizeof value);
    } else {
        *at = (uint8_t)value;
    }
}

double setting_get(const struct drive_settings *settings, const struct setting *setting,
                   size_t element)
{
    const uint8_t *at = (const uint8_t *)settings + setting->offset + element * setting->size;
    double value;

    if (setting->type != SETTING_REAL) {
        return get_whole(at, setting->size);
    }
    memcpy(&value, at, sizeof value);
    return value;
}

void setting_put(struct drive_settings *settings, const struct setting *setting, size_t element,
                 double value)
{
    uint8_t *at = (uint8_t *)settings + setting->offset + element * setting->size;

    if (setting->type != SETTING_REAL) {
        put_whole(at, setting->size, (int32_t)value);
    } else {
        memcpy(at, &value, sizeof value);
    }
}

void setting_choose(struct drive_settings *settings, const struct setting *setting, size_t element,
                    double value)
{
    if (setting->offset == offsetof(struct drive_settings, feedback)) {
        drive_settings_select_feedback(settings, (enum drive_feedback)(int)value);
    } else if (setting->offset == offsetof(struct drive_settings, law)) {
        drive_settings_select_law(settings, (enum position_law)(int)value);
    } else {
        setting_put(settings, setting, element, value);
    }
}

static double in_base(const struct drive_settings *settings, double value, unsigned base)
{
    return base == SETTING_RATED ? value * settings->motor.rated_current_A : value;
}

bool setting_is_left_out(const struct setting *setting)
{
#define IS(member) (setting->offset == offsetof(struct drive_settings, member))
    return (!FINDS_INDUCTANCE && IS(identify_inductance)) ||
           (!ENCODER_CARRIED && IS(encoder_counts_per_turn)) ||
           (!LINK_CARRIED && (IS(node_id) || IS(modbus_rtu))) ||
           (!MACHINE_IO_CARRIED &&
            (IS(inputs_used) || IS(inputs_low) || IS(outputs_low) || IS(holding_brake_s)));
#undef IS
}

double setting_least(const struct drive_settings *settings, const struct setting *setting)
{
    return in_base(settings, setting_is_left_out(setting) ? setting->preset : setting->least,
                   setting->least_base);
}

double setting_most(const struct drive_settings *settings, const struct setting *setting)
{
    return in_base(settings, setting_is_left_out(setting) ? setting->preset : setting->most,
                   setting->most_base);
}

void settings_put_presets(struct drive_settings *settings)
{
    for (const struct setting *row = rows; row != rows + ROWS; row++) {
        for (size_t i = 0; !setting_is_of_motor(row) && i < row->count; i++) {
            setting_put(settings, row, i, in_base(settings, row->preset, row->preset_base));
        }
    }
}

static bool refuse(const struct setting *setting, double value, const char *relation, double limit,
                   char error[DRIVE_ERROR_TEXT])
{
    return design_refuse_limit(error, (struct refusal){.quantity = setting->name,
                                                       .value = value,
                                                       .relation = relation,
                                                       .limit = limit,
                                                       .unit = setting->unit,
                                                       .reason = "the range of this setting"});
}

bool setting_check(const struct drive_settings *settings, const struct setting *setting,
                   char error[DRIVE_ERROR_TEXT])
{
    const double least = setting_least(settings, setting);
    const double most = setting_most(settings, setting);

    for (size_t i = 0; i < setting->count; i++) {
        const double value = setting_get(settings, setting, i);

        if (value != value && setting->preset_base == SETTING_FOLLOWS) {
            continue;
        }
        if (!(value >= least)) {
            return refuse(setting, value, "at least", least, error);
        }
        if (!(value <= most)) {
            return refuse(setting, value, "at most", most, error);
        }
    }
    return true;
}
