#include "firmware/application/command_line.h"

#include "firmware/application/number_text.h"

#define WITH(member) (1u << DRIVE_PARAMETER_##member)

/* The drive keeps what it has learned, the application the settings. */
#define LINE_OF(constant)                                                                          \
    (DRIVE_COMMAND_##constant == DRIVE_COMMAND_STORE ? LINE_STORE : LINE_COMMAND)

#define COMMAND_FORM(number, constant, name, required, optional, states, planning, sentence)       \
    {name,     LINE_OF(constant), DRIVE_COMMAND_##constant,                                        \
     required, optional,          (DRIVE_##planning) != DRIVE_AT_ONCE,                             \
     sentence},

static const struct line_form forms[] = {
    {"help", LINE_HELP, DRIVE_COMMANDS, 0, 0, false, "lists commands; help <command> explains one"},
    {"state", LINE_STATE, DRIVE_COMMANDS, 0, 0, false, "what it does and measures"},
    {"cycles", LINE_CYCLES, DRIVE_COMMANDS, 0, 0, false,
     "cycles of the control interrupt, mean and most; cycles reset begins anew"},
    {"signals", LINE_SIGNALS, DRIVE_COMMANDS, 0, 0, false, "all signals"},
    {"move", LINE_MOVE, DRIVE_COMMAND_MOVE_SMOOTH, WITH(position_rad),
     WITH(duration_s) | WITH(ramp_s) | WITH(jerk_s), true,
     "jerk-limited move; its times are the motor's if not given"},
    DRIVE_COMMANDS_TABLE(COMMAND_FORM){
        "get", LINE_GET, DRIVE_COMMANDS, 0, 0, false,
        "a setting: value, unit, range, default; get hold* lists those that begin so"},
    {"set", LINE_SET, DRIVE_COMMANDS, 0, 0, false,
     "set hold_current_A 1.2, or default; acts at the next enable, or in motion at once"},
    {"defaults", LINE_DEFAULTS, DRIVE_COMMANDS, 0, 0, false,
     "all settings but the motor's to defaults"},
#ifndef STEADYSTEP_WITHOUT_LINK
    {"capture", LINE_CAPTURE, DRIVE_COMMANDS, 0, 0, false,
     "what was captured; capture 17 shows a sample"},
#endif
};

#define PARAMETER(index, member, unit, least, most, sentence)                                      \
    {#member, offsetof(struct drive_command, member)},

static const struct {
    const char *name;
    size_t offset; /* in struct drive_command */
} parameters[DRIVE_PARAMETERS] = {DRIVE_PARAMETERS_TABLE(PARAMETER)};

const struct line_form *line_form_number(size_t number)
{
    return number < sizeof forms / sizeof forms[0] ? &forms[number] : NULL;
}

static struct line_word next_word(const char **typed)
{
    const char *at = *typed;

    while (*at == ' ' || *at == '\t') {
        at++;
    }
    const char *end = at;

    while (*end != '\0' && *end != ' ' && *end != '\t') {
        end++;
    }
    *typed = end;
    return (struct line_word){at, (size_t)(end - at)};
}

bool line_word_is(struct line_word word, const char *name)
{
    size_t i = 0;

    while (i < word.length && name[i] == word.at[i]) {
        i++;
    }
    return i == word.length && name[i] == '\0';
}

void line_word_quote(struct text *text, struct line_word word)
{
    enum { SHOWN = 40 };

    text_put(text, "\"");
    for (size_t i = 0; i < word.length && i < SHOWN; i++) {
        const char shown[2] = {word.at[i] >= ' ' && word.at[i] <= '~' ? word.at[i] : '?', '\0'};

        text_put(text, shown);
    }
    text_put(text, word.length > SHOWN ? "...\"" : "\"");
}

static const struct line_form *form_of(struct line_word word)
{
    for (size_t i = 0; line_form_number(i) != NULL; i++) {
        if (line_word_is(word, forms[i].name)) {
            return &forms[i];
        }
    }
    return NULL;
}

static void put_names(struct text *text, uint32_t set)
{
    for (int i = 0; i < DRIVE_PARAMETERS; i++) {
        if ((set >> i & 1u) != 0u) {
            text_put(text, " ");
            text_put(text, parameters[i].name);
            text_put(text, "=");
        }
    }
}

void line_put_values(struct text *text, const struct drive_command *command, uint32_t set)
{
    for (int i = 0; i < DRIVE_PARAMETERS; i++) {
        if ((set >> i & 1u) != 0u) {
            put_names(text, 1u << i);
            text_number(
                text, *(const double *)(const void *)((const char *)command + parameters[i].offset),
                TEXT_DIGITS_MAX);
        }
    }
}

void line_form_usage(struct text *text, const struct line_form *form)
{
    text_put(text, form->name);
    put_names(text, form->required);
    if (form->optional != 0u || form->may_wait) {
        text_put(text, " [");
        put_names(text, form->optional);
        text_put(text, form->may_wait ? " at= ]" : " ]");
    }
}

static bool refuse_word(struct text *answer, struct line_word word, const char *expected)
{
    line_word_quote(answer, word);
    text_put(answer, ": expected ");
    text_put(answer, expected);
    return false;
}

static bool refuse_parameter(const struct command_line *line, struct line_word word,
                             struct text *answer)
{
    line_word_quote(answer, word);
    text_put(answer, ": expected ");
    line_form_usage(answer, line->form);
    return false;
}

static bool read_number(struct command_line *line, int parameter, struct line_word value,
                        struct text *answer)
{
    double *target = (double *)(void *)((char *)&line->command + parameters[parameter].offset);

    if ((line->given >> parameter & 1u) != 0u) {
        text_put(answer, parameters[parameter].name);
        text_put(answer, ": given twice");
        return false;
    }
    line->given = (uint16_t)(line->given | 1u << parameter);
    switch (number_from_text(value.at, value.length, target)) {
    case NUMBER_TEXT_READ:
        return true;
    case NUMBER_TEXT_TOO_LONG:
        return refuse_word(answer, value,
                           "a number of at most 15 digits, or hexadecimal with at most 53 bits");
    case NUMBER_TEXT_OUT_OF_RANGE:
        return refuse_word(answer, value, "a number within 1e-22...1e37, or hexadecimal");
    default:
        return refuse_word(answer, value, "a number, as -1.5, 2e-3 or 0x1.8p+0");
    }
}

/* name=value, or a value alone for the first required parameter. */
static bool read_parameter(struct command_line *line, struct line_word word, struct text *answer)
{
    const uint32_t known = line->form->required | line->form->optional;
    struct line_word name = {word.at, 0};
    struct line_word value = word;

    while (name.length < word.length && word.at[name.length] != '=') {
        name.length++;
    }
    if (name.length == word.length) {
        int first = 0;

        while (first < DRIVE_PARAMETERS && (line->form->required >> first & 1u) == 0u) {
            first++;
        }
        return first < DRIVE_PARAMETERS && line->given == 0u
                   ? read_number(line, first, word, answer)
                   : refuse_parameter(line, word, answer);
    }
    value.at += name.length + 1u;
    value.length -= name.length + 1u;
    if (line->form->may_wait && line_word_is(name, "at")) {
        line->at_given = true;
        return unsigned_from_text(value.at, value.length, &line->at_period) ||
               refuse_word(answer, value, "a control period, 0...4294967295");
    }
    for (int i = 0; i < DRIVE_PARAMETERS; i++) {
        if ((known >> i & 1u) != 0u && line_word_is(name, parameters[i].name)) {
            return read_number(line, i, value, answer);
        }
    }
    return refuse_parameter(line, name, answer);
}

/* false: there is one already. */
static bool take_word(struct line_word *place, struct line_word word)
{
    if (place->length > 0u) {
        return false;
    }
    *place = word;
    return true;
}

static bool read_word(struct command_line *line, struct line_word word, struct text *answer)
{
    switch (line->form->action) {
    case LINE_HELP:
        line->topic = form_of(word);
        return line->topic != NULL || refuse_word(answer, word, "a command; help lists them");
    case LINE_GET:
        return take_word(&line->name, word) || refuse_word(answer, word, "one name");
    case LINE_SET:
        return take_word(&line->name, word) || take_word(&line->value, word) ||
               refuse_word(answer, word, "a name and a value");
    case LINE_CYCLES:
        line->resets = line_word_is(word, "reset");
        return line->resets || refuse_word(answer, word, "cycles or cycles reset");
    case LINE_CAPTURE:
        line->at_given = unsigned_from_text(word.at, word.length, &line->at_period);
        return line->at_given || refuse_word(answer, word, "a sample");
    default:
        return read_parameter(line, word, answer);
    }
}

bool command_line_read(struct command_line *line, const char *typed, struct text *answer)
{
    struct line_word word = next_word(&typed);

    *line = (struct command_line){.form = form_of(word)};
    if (word.length == 0u) {
        return true;
    }
    if (line->form == NULL) {
        return refuse_word(answer, word, "a command; help lists them");
    }
    line->command.kind = line->form->kind;
    for (word = next_word(&typed); word.length > 0u; word = next_word(&typed)) {
        if (!read_word(line, word, answer)) {
            return false;
        }
    }
    const struct line_word *last = line->form->action == LINE_GET   ? &line->name
                                   : line->form->action == LINE_SET ? &line->value
                                                                    : NULL;

    if (last != NULL && last->length == 0u) {
        text_put(answer, line->form->name);
        text_put(answer, last == &line->name ? ": expected a name, or the begin of one and *"
                                             : ": expected a name and a value");
        return false;
    }
    const uint32_t missing = line->form->required & ~(uint32_t)line->given;

    if (missing != 0u) {
        text_put(answer, line->form->name);
        text_put(answer, ": missing");
        put_names(answer, missing);
        return false;
    }
    return true;
}
