/*
 * The rows of settings_table.h as data: what every reader and writer of settings goes by.
 */
#ifndef STEADYSTEP_SETTINGS_H
#define STEADYSTEP_SETTINGS_H

#include "firmware/interface/drive_interface.h"

#ifdef __cplusplus
extern "C" {
#endif

enum setting_type { SETTING_CHOICE, SETTING_FLAG, SETTING_REAL, SETTING_COUNT };

/* What a bound or a preset is counted in. */
enum setting_base {
    SETTING_FIXED,
    SETTING_RATED,   /* the motor's rated current */
    SETTING_FOLLOWS, /* preset NaN, "not given": decided when the drive starts */
    SETTING_COMPUTED /* preset computed from the motor */
};

struct setting {
    double least, most, preset; /* in their bases */
    const char *name;           /* as scenarios and the console spell it */
    const char *unit;
    const char *const *choices; /* texts, of a CHOICE */
    uint16_t index;             /* of its first element */
    uint16_t offset;            /* in struct drive_settings */
    uint8_t type;               /* enum setting_type */
    uint8_t count;              /* elements */
    uint8_t size;               /* bytes of one */
    uint8_t least_base : 2;     /* enum setting_base */
    uint8_t most_base : 2;
    uint8_t preset_base : 2;
    uint8_t in_motion : 1; /* acts at once in a drive that is ready; else at the next enable */
};

#define SETTING_PLACE(index, member, unit, least, most, sentence) SETTING_##member,
enum { MOTOR_SETTINGS(SETTING_PLACE, SETTING_PLACE) SETTINGS_OF_MOTOR };
#undef SETTING_PLACE

static inline bool setting_is_of_motor(const struct setting *setting)
{
    return setting->offset < sizeof(struct motor_params);
}

/* In the order of settings_table.h, the motor's first; NULL behind the last. */
const struct setting *setting_number(size_t number);

/* The one with an element of this index; NULL: none. */
const struct setting *setting_of_index(uint16_t index);

/* The one that begins at this offset in struct drive_settings; NULL: none. */
const struct setting *setting_at(size_t offset);

/* An element as a number: a flag is 0 or 1, a choice its place in the enumeration. */
double setting_get(const struct drive_settings *settings, const struct setting *setting,
                   size_t element);
void setting_put(struct drive_settings *settings, const struct setting *setting, size_t element,
                 double value);

/* The same as users mean it: feedback and law bring the defaults of others with them. */
void setting_choose(struct drive_settings *settings, const struct setting *setting, size_t element,
                    double value);

/* Of a part that this image does not carry: it stays as it is preset. */
bool setting_is_left_out(const struct setting *setting);

/* For the motor of these settings. */
double setting_least(const struct drive_settings *settings, const struct setting *setting);
double setting_most(const struct drive_settings *settings, const struct setting *setting);

/* Puts the presets of all but the motor's. */
void settings_put_presets(struct drive_settings *settings);

/* Whether every element is in its range, or not given where that may be. False, with the name of
   the setting, value and range in `error`. */
bool setting_check(const struct drive_settings *settings, const struct setting *setting,
                   char error[DRIVE_ERROR_TEXT]);

/* What it is, in a sentence; and a choice of it. */
const char *setting_sentence(const struct setting *setting);
const char *setting_choice_sentence(const struct setting *setting, size_t choice);

#ifdef __cplusplus
}
#endif

#endif
