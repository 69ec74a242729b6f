/*
 * One typed line, taken apart: a command of the list below, its parameters as numbers. Knows no
 * drive; what may be done now is the console's to say.
 */
#ifndef STEADYSTEP_COMMAND_LINE_H
#define STEADYSTEP_COMMAND_LINE_H

#include "firmware/design/text.h"
#include "firmware/interface/drive_interface.h"

/* What a line asks for. */
enum line_action {
    LINE_COMMAND, /* what drive_command takes */
    LINE_MOVE,    /* the same, of kind DRIVE_COMMAND_MOVE_SMOOTH; times not given are chosen */
    LINE_HELP,
    LINE_STATE,
    LINE_SIGNALS,
    LINE_CYCLES,
    LINE_CAPTURE, /* what was captured, or one sample of it */
    LINE_GET,     /* a setting, or those that begin alike */
    LINE_SET,     /* a setting, to a value */
    LINE_STORE,   /* the settings, and what was learned */
    LINE_DEFAULTS
};

struct line_form {
    const char *name;
    enum line_action action;
    enum drive_command_kind kind;
    uint16_t required; /* parameters: bit n is number n of enum drive_parameter */
    uint16_t optional;
    bool may_wait;     /* takes at=<period> */
    const char *about; /* what it does, in a few words */
};

/* NULL behind the last. */
const struct line_form *line_form_number(size_t number);

/* "move position_rad= [duration_s= ramp_s= jerk_s= at=]" */
void line_form_usage(struct text *text, const struct line_form *form);

/* Parameters of a command: " duration_s=0.1 ramp_s=..." */
void line_put_values(struct text *text, const struct drive_command *command, uint32_t set);

/* A part of the typed line. */
struct line_word {
    const char *at;
    size_t length;
};

bool line_word_is(struct line_word word, const char *name);

/* As typed, in quotes; what a terminal would not show as itself, as '?'. */
void line_word_quote(struct text *text, struct line_word word);

struct command_line {
    const struct line_form *form;
    struct line_word name, value;  /* of get and set */
    const struct line_form *topic; /* of help; NULL: all */
    struct drive_command command;  /* at_period is the console's */
    uint16_t given;                /* parameters */
    bool at_given;
    uint32_t at_period; /* of capture the sample */
    bool resets;        /* of cycles */
};

/* false: not understood; `answer` says what was expected. An empty line has no form. */
bool command_line_read(struct command_line *line, const char *typed, struct text *answer);

#endif
