#include "firmware/application/setting_lines.h"

#include <stddef.h>

#include "firmware/application/application.h"
#include "firmware/application/number_text.h"
#include "firmware/application/setting_change.h"
#include "firmware/design/hold_check.h"
#include "firmware/interface/settings.h"

/* One number, or one of several. */
struct element {
    const struct setting *setting; /* NULL: there is none of this name */
    size_t number;
};

static size_t same_letters(struct line_word word, const char *name)
{
    size_t i = 0;

    while (i < word.length && name[i] != '\0' && name[i] == word.at[i]) {
        i++;
    }
    return i;
}

/* name, or name.N of an array; N from 1 on. */
static struct element element_of(struct line_word word)
{
    for (size_t i = 0; setting_number(i) != NULL; i++) {
        const struct setting *setting = setting_number(i);
        const size_t same = same_letters(word, setting->name);
        uint32_t number = 1;

        if (setting->name[same] != '\0') {
            continue;
        }
        if (same == word.length
                ? setting->count == 1u
                : word.at[same] == '.' &&
                      unsigned_from_text(&word.at[same + 1u], word.length - same - 1u, &number) &&
                      number >= 1u && number <= setting->count) {
            return (struct element){setting, number - 1u};
        }
    }
    return (struct element){NULL, 0};
}

static bool refuse_name(struct line_word word, struct text *answer)
{
    line_word_quote(answer, word);
    text_put(answer, ": expected a setting; get * lists them, an array's with .1, .2, ...");
    return false;
}

static void put_value(struct text *text, const struct setting *setting, double value)
{
    if (setting->type == SETTING_FLAG) {
        text_put(text, value != 0.0 ? "true" : "false");
    } else if (setting->type == SETTING_CHOICE) {
        text_put(text, setting->choices[(size_t)value]);
    } else {
        text_number(text, value, TEXT_DIGITS_MAX);
    }
}

static void put_name(struct text *text, struct element element)
{
    text_put(text, element.setting->name);
    if (element.setting->count > 1u) {
        text_put(text, ".");
        text_unsigned(text, (uint32_t)element.number + 1u);
    }
}

static bool is_given(double value)
{
    return value == value;
}

/* " 1.5 A", or what follows instead. */
static void put_setting(const struct application *application, struct element element,
                        struct text *text)
{
    const struct setting *setting = element.setting;
    const double chosen = setting_get(&application->chosen, setting, element.number);
    const double in_force = setting_get(&application->drive.settings, setting, element.number);

    put_name(text, element);
    text_put(text, "=");
    if (is_given(chosen)) {
        put_value(text, setting, chosen);
    } else if (is_given(in_force)) {
        put_value(text, setting, in_force);
        text_put(text, "(follows)");
    } else {
        text_put(text, "(not given)");
    }
}

/* A law that the image does not carry is no choice. */
static bool is_there(const struct setting *setting, size_t choice)
{
    return setting->offset != offsetof(struct drive_settings, law) ||
           drive_carries_law((enum position_law)choice);
}

static void put_range(const struct application *application, const struct setting *setting,
                      struct text *text)
{
    if (setting->type == SETTING_FLAG) {
        text_put(text, "; true or false");
    } else if (setting->type == SETTING_CHOICE) {
        const char *before = "; ";

        for (size_t i = 0; i <= (size_t)setting->most; i++) {
            if (is_there(setting, i)) {
                text_put(text, before);
                text_put(text, setting->choices[i]);
                before = ", ";
            }
        }
    } else {
        text_put(text, "; ");
        text_number(text, setting_least(&application->chosen, setting), TEXT_DIGITS_MAX);
        text_put(text, "...");
        text_number(text, setting_most(&application->chosen, setting), TEXT_DIGITS_MAX);
    }
}

static void put_default(const struct application *application, struct element element,
                        struct text *text)
{
    struct drive_settings defaults;

    if (setting_is_of_motor(element.setting)) {
        return;
    }
    drive_settings_default(&defaults, &application->chosen.motor);

    const double preset = setting_get(&defaults, element.setting, element.number);

    text_put(text, "; default ");
    if (is_given(preset)) {
        put_value(text, element.setting, preset);
    } else {
        text_put(text, "follows");
    }
}

static void put_sentence(const struct setting *setting, struct text *text)
{
#ifndef STEADYSTEP_WITHOUT_SENTENCES
    text_put(text, "; ");
    text_put(text, setting_sentence(setting));
#else
    (void)setting;
    (void)text;
#endif
}

/* Of a current that holds the rotor: the lasting load that it bears, and its heat. */
static void put_bearing(const struct application *application, const struct setting *setting,
                        struct text *text)
{
#ifndef STEADYSTEP_WITHOUT_BEARING
    enum { DIGITS = 3 };
    const struct motor_params *motor = &application->chosen.motor;
    double current_A = setting_get(&application->chosen, setting, 0);

    if (setting->offset != offsetof(struct drive_settings, hold_current_A) &&
        setting->offset != offsetof(struct drive_settings, idle_current_A)) {
        return;
    }
    if (!is_given(current_A)) {
        current_A = setting_get(&application->drive.settings, setting, 0);
    }
    text_put(text, "; bears ");
    text_number(text, hold_torque_Nm(motor, current_A), DIGITS);
    text_put(text, " N m, heats the winding by ");
    text_number(text, hold_heat_W(motor, current_A), DIGITS);
    text_put(text, " W");
#else
    (void)application;
    (void)setting;
    (void)text;
#endif
}

/* Those that begin so, as many as there is room for. */
static bool list(const struct application *application, struct line_word begin, struct text *answer)
{
    enum { ROOM_OF_ONE = 60 };
    size_t found = 0;
    size_t left_out = 0;

    for (size_t i = 0; setting_number(i) != NULL; i++) {
        const struct setting *setting = setting_number(i);

        for (size_t n = 0; same_letters(begin, setting->name) == begin.length && n < setting->count;
             n++) {
            found++;
            if (answer->length + ROOM_OF_ONE > answer->room) {
                left_out++;
                continue;
            }
            text_put(answer, " ");
            put_setting(application, (struct element){setting, n}, answer);
        }
    }
    if (left_out > 0u) {
        text_put(answer, " and ");
        text_unsigned(answer, (uint32_t)left_out);
        text_put(answer, " more: give a longer begin");
    }
    return found > 0u;
}

static bool get(const struct application *application, struct line_word name, struct text *answer)
{
    const struct text empty = *answer;

    if (name.at[name.length - 1u] == '*') {
        const struct line_word begin = {name.at, name.length - 1u};

        text_put(answer, "ok get");
        if (list(application, begin, answer)) {
            return true;
        }
        *answer = empty;
        text_put(answer, "error: ");
        return refuse_name(name, answer);
    }
    const struct element element = element_of(name);

    if (element.setting == NULL) {
        text_put(answer, "error: ");
        return refuse_name(name, answer);
    }
    text_put(answer, "ok get ");
    put_setting(application, element, answer);
    if (element.setting->unit[0] != '\0') {
        text_put(answer, " ");
        text_put(answer, element.setting->unit);
    }
    put_range(application, element.setting, answer);
    put_default(application, element, answer);
    put_bearing(application, element.setting, answer);
    text_put(answer, element.setting->in_motion ? "; in motion" : "; at enable");
    put_sentence(element.setting, answer);
    return true;
}

/* false: not a value of this type. */
static bool value_of(const struct setting *setting, struct line_word word, double *value)
{
    if (setting->type == SETTING_FLAG) {
        *value = line_word_is(word, "true") ? 1.0 : 0.0;
        return line_word_is(word, "true") || line_word_is(word, "false");
    }
    if (setting->type == SETTING_CHOICE) {
        for (size_t i = 0; i <= (size_t)setting->most; i++) {
            if (line_word_is(word, setting->choices[i])) {
                *value = (double)i;
                return true;
            }
        }
        return false;
    }
    return number_from_text(word.at, word.length, value) == NUMBER_TEXT_READ &&
           (setting->type == SETTING_REAL || (*value >= setting->least && *value <= setting->most &&
                                              *value == (double)(int32_t)*value));
}

/* `value` as typed, or the default; of a motor there is none. */
static bool read_value(const struct application *application, struct element element,
                       struct line_word typed, double *value, struct text *answer)
{
    if (line_word_is(typed, "default") && !setting_is_of_motor(element.setting)) {
        struct drive_settings defaults;

        drive_settings_default(&defaults, &application->chosen.motor);
        *value = setting_get(&defaults, element.setting, element.number);
        return true;
    }
    if (!value_of(element.setting, typed, value)) {
        line_word_quote(answer, typed);
        text_put(answer, ": expected a value of ");
        text_put(answer, element.setting->name);
        put_range(application, element.setting, answer);
        return false;
    }
    return true;
}

static bool set(struct application *application, struct element element, struct line_word typed,
                struct text *answer)
{
    char refusal[DRIVE_ERROR_TEXT];
    double value;

    if (!read_value(application, element, typed, &value, answer)) {
        return false;
    }
    if (setting_change(application, element.setting, element.number, value, refusal) !=
        SETTING_CHANGED) {
        text_put(answer, refusal);
        return false;
    }
    return true;
}

static void put_set(const struct application *application, struct element element,
                    struct text *answer)
{
    text_put(answer, "ok set ");
    put_setting(application, element, answer);
    put_bearing(application, element.setting, answer);
    text_put(answer,
             setting_change_waits(application) ? "; acts at the next enable" : "; acts at once");
}

static bool obey_set(struct application *application, const struct command_line *line,
                     struct text *answer)
{
    const struct text empty = *answer;
    const struct element element = element_of(line->name);

    text_put(answer, "error: ");
    if (element.setting == NULL) {
        return refuse_name(line->name, answer);
    }
    if (!set(application, element, line->value, answer)) {
        return false;
    }
    *answer = empty;
    put_set(application, element, answer);
    return true;
}

static bool store(struct application *application, struct text *answer)
{
    char refusal[DRIVE_ERROR_TEXT];

    switch (settings_store(application, refusal)) {
    case RECORD_WRITTEN:
        text_put(answer, "ok store");
        return true;
    case RECORD_WRITTEN_ELSEWHERE:
        text_put(answer, "ok store; where it was to go the store is worn out");
        return true;
    default:
        text_put(answer, "error: ");
        text_put(answer, refusal);
        return false;
    }
}

bool setting_line_obey(struct application *application, const struct command_line *line,
                       struct text *answer)
{
    char refusal[DRIVE_ERROR_TEXT];

    if (line->form->action == LINE_GET) {
        return get(application, line->name, answer);
    }
    if (line->form->action == LINE_SET) {
        return obey_set(application, line, answer);
    }
    if (line->form->action == LINE_STORE) {
        return store(application, answer);
    }
    if (!settings_restore(application, refusal)) {
        text_put(answer, "error: ");
        text_put(answer, refusal);
        return false;
    }
    text_put(answer, "ok ");
    text_put(answer, line->form->name);
    return true;
}
