/*
 * The rows of commands_table.h, signals_table.h and faults_table.h as data: what every reader and
 * writer of them goes by. What no image needs is in dictionary_text.c.
 */
#ifndef STEADYSTEP_DICTIONARY_H
#define STEADYSTEP_DICTIONARY_H

#include "firmware/interface/settings.h"

#ifdef __cplusplus
extern "C" {
#endif

enum signal_type {
    SIGNAL_FLAG,
    SIGNAL_COUNT,
    SIGNAL_REAL,
    SIGNAL_IS_drive_state, /* of an enumeration, from here on */
    SIGNAL_IS_drive_fault,
    SIGNAL_IS_drive_synchronism,
    SIGNAL_IS_drive_position_reference,
    SIGNAL_IS_drive_command_kind
};

struct signal_row {
    const char *name;     /* as the console and a trace spell it */
    const char *brief;    /* as `state` does, "": not at all */
    uint16_t index;       /* of the object dictionary */
    uint16_t offset : 12; /* in struct drive_signals */
    uint16_t type : 4;    /* enum signal_type */
};

/* Places in the order of the table. */
#define SIGNAL_PLACE(index, member, ...) SIGNAL_##member,
enum drive_signal {
    DRIVE_SIGNALS_TABLE(SIGNAL_PLACE, SIGNAL_PLACE, SIGNAL_PLACE, SIGNAL_PLACE, SIGNAL_PLACE)
        SIGNALS
};
#undef SIGNAL_PLACE

enum { SIGNAL_IS_UNTRACED, SIGNAL_IS_TRACED };

const struct signal_row *signal_at(enum drive_signal signal);

/* As a number: a flag is 0 or 1, one of an enumeration its place there. */
double signal_get(const struct drive_signals *signals, const struct signal_row *signal);

/* The word for a value of a flag or an enumeration; NULL: it is a number. */
const char *signal_word(const struct signal_row *signal, double value);

struct signal_text {
    const char *unit;
    const char *sentence;
    bool traced;
};

const struct signal_text *signal_text(enum drive_signal signal);

struct fault_row {
    const char *name;  /* as scenarios and the console spell it */
    const char *cause; /* in words */
    uint16_t code;     /* of an emergency message */
    uint16_t limit;    /* offset in struct drive_settings of what stands behind it */
};

enum { FAULT_WITHOUT_LIMIT = UINT16_MAX };

const struct fault_row *fault_at(enum drive_fault fault);

/* The setting that limits, NULL: none. */
const struct setting *fault_limit(enum drive_fault fault);

const char *fault_remedy(enum drive_fault fault);

struct command_row {
    const char *name; /* as scenarios and the console spell it */
    const char *states;
    const char *planning;
    const char *sentence;
    uint16_t required; /* parameters, bit n is number n */
    uint16_t optional;
    uint8_t number; /* that gives it */
};

const struct command_row *command_at(enum drive_command_kind kind);

struct parameter_row {
    double least, most;
    const char *name;
    const char *unit;
    const char *sentence;
    uint16_t index;
    uint16_t offset; /* in struct drive_command */
};

const struct parameter_row *parameter_at(enum drive_parameter parameter);

/* Parameter number n of a command, NULL: it has less; those required and optional, in the order of
   the table. */
const struct parameter_row *parameter_of(enum drive_command_kind kind, size_t number);

double parameter_get(const struct drive_command *command, const struct parameter_row *parameter);
void parameter_put(struct drive_command *command, const struct parameter_row *parameter,
                   double value);

#ifdef __cplusplus
}
#endif

#endif
