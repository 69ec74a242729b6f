/*
 * The console: typed lines in, one line of answer for each, and announcements of what happens
 * without being asked for. What can be typed: firmware/README.md; `help` lists it.
 *
 * A line is a command and its parameters, `name=value` with the unit in the name, in any order,
 * ended by '\n' ('\r' before it counts for nothing). It answers "ok ..." or "error: ..."; an empty
 * line has no answer. '\r' alone ends a line, too, 5 ms later, and then in the period in which it
 * is read. Backspace and delete take the last character back. Nothing is echoed.
 *
 * A command acts DRIVE_TYPED_DELAY_PERIODS after the period in which its line's last byte arrived,
 * and one that the background plans DRIVE_LEAD_s after that: so what a tape of lines does, depends
 * on when they arrive and not on how fast they are read. `at=<period>` addresses a later period.
 */
#ifndef STEADYSTEP_CONSOLE_H
#define STEADYSTEP_CONSOLE_H

#include "firmware/drive/drive_interface.h"
#include "hal/hal.h"

enum {
    CONSOLE_LINE_BYTES = 200,   /* longest line, its end not counted */
    CONSOLE_ANSWER_BYTES = 640, /* longest line that the console writes, its end counted */
    CONSOLE_RETURN_PERIODS = 50 /* until '\r' alone ends a line */
};

/* What of a drive was announced last. */
struct console_announced {
    bool start;
    bool refused_settings;
    enum drive_state state;
    uint32_t state_since;
    uint32_t underruns;
};

struct console {
    char line[CONSOLE_LINE_BYTES + 1];
    size_t line_length; /* beyond CONSOLE_LINE_BYTES: what came behind was not kept */
    bool bytes_lost;    /* of the line, by the board */
    bool returned;      /* the line's last character so far is '\r' */
    uint32_t returned_in;
    char answer[CONSOLE_ANSWER_BYTES];
    size_t answer_length;
    size_t answer_sent;
    struct console_announced announced;
};

struct application;

/* At start-up: announces the firmware as soon as the line takes it. */
void console_init(struct console *console);

/* Background: sends, announces, or reads and obeys one line; as much as fits. */
void console_background(struct application *application);

#endif
