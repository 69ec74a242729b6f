/* What settings and their choices are, in sentences. */
#include "firmware/interface/settings.h"

#ifndef STEADYSTEP_WITHOUT_SENTENCES

struct sentence {
    uint16_t index;
    const char *text;
};

#define MOTOR_SENTENCE(index, member, unit, least, most, sentence)               {index, sentence},
#define CHOICE_SENTENCE(index, member, type, constants, preset, when, sentence)  {index, sentence},
#define FLAG_SENTENCE(index, member, preset, when, sentence)                     {index, sentence},
#define REAL_SENTENCE(index, member, unit, least, most, preset, when, sentence)  {index, sentence},
#define COUNT_SENTENCE(index, member, unit, least, most, preset, when, sentence) {index, sentence},
#define REALS_SENTENCE(index, member, count, unit, least, most, preset, when, sentence)            \
    {index, sentence},

static const struct sentence sentences[] = {
    MOTOR_SETTINGS(MOTOR_SENTENCE, MOTOR_SENTENCE) DRIVE_SETTINGS(
        CHOICE_SENTENCE, FLAG_SENTENCE, REAL_SENTENCE, REALS_SENTENCE, COUNT_SENTENCE)};

#define OF_CHOICE(constant, text, sentence) sentence,

static const char *const feedbacks[] = {DRIVE_FEEDBACK_CHOICES(OF_CHOICE)};
static const char *const estimators[] = {DRIVE_ESTIMATOR_CHOICES(OF_CHOICE)};
static const char *const observers[] = {DRIVE_OBSERVER_CHOICES(OF_CHOICE)};
static const char *const voltage_sources[] = {DRIVE_VOLTAGE_SOURCE_CHOICES(OF_CHOICE)};
static const char *const initial_positions[] = {DRIVE_INITIAL_POSITION_CHOICES(OF_CHOICE)};
static const char *const synchronism_policies[] = {DRIVE_SYNCHRONISM_POLICY_CHOICES(OF_CHOICE)};

/* Laws explain themselves where they are (firmware/README.md). */
static const struct {
    size_t offset;
    const char *const *sentences;
} choices[] = {
    {offsetof(struct drive_settings, feedback), feedbacks},
    {offsetof(struct drive_settings, estimator), estimators},
    {offsetof(struct drive_settings, observer), observers},
    {offsetof(struct drive_settings, voltage_source), voltage_sources},
    {offsetof(struct drive_settings, initial_position), initial_positions},
    {offsetof(struct drive_settings, synchronism_policy), synchronism_policies},
};

const char *setting_sentence(const struct setting *setting)
{
    size_t i = 0;

    while (sentences[i].index != setting->index) {
        i++;
    }
    return sentences[i].text;
}

const char *setting_choice_sentence(const struct setting *setting, size_t choice)
{
    for (size_t i = 0; i < sizeof choices / sizeof choices[0]; i++) {
        if (choices[i].offset == setting->offset) {
            return choices[i].sentences[choice];
        }
    }
    return "";
}

#endif
