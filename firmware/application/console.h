/*
 * The console: typed lines in, one line of answer for each, and announcements of what happens
 * without being asked for. What can be typed: firmware/README.md; `help` lists it.
 *
 * A line is a command and its parameters, `name=value` with the unit in the name, in any order,
 * ended by '\n', '\r' or both. It answers "ok ..." or "error: ..."; an empty line has no answer,
 * and so the '\n' of "\r\n" counts for nothing. Backspace and delete take the last character back.
 * A line with a NUL byte is refused. Nothing is echoed.
 *
 * A command acts DRIVE_TYPED_DELAY_s after the period in which its line's last byte arrived,
 * and one that the background plans DRIVE_LEAD_s after that: so what a tape of lines does, depends
 * on when they arrive and not on how fast they are read. `at=<period>` addresses a later period.
 * The board stamps '\n' alone: a line that ends with '\r', be it followed by '\n', counts from the
 * period in which it is read. A tape that is to do the same every time ends its lines with '\n'
 * alone.
 *
 * What is legal when, is the drive's to say (drive/command_rules.h), of a command as it was when
 * its line arrived: one that came before the drive was ready is refused even if it is read
 * afterwards.
 */
#ifndef STEADYSTEP_CONSOLE_H
#define STEADYSTEP_CONSOLE_H

#include "firmware/interface/drive_interface.h"
#include "hal/hal.h"

enum {
    CONSOLE_LINE_BYTES = 200,   /* longest line, its end not counted */
    CONSOLE_ANSWER_BYTES = 688, /* longest line that the console writes, its end counted */
    CONSOLE_PIECE_BYTES = 64    /* read from the board at once */
};

/* What of a drive was announced last. */
struct console_announced {
    bool start;
    bool unheard;
    uint8_t stop; /* enum machine_stop */
    uint8_t heat; /* THERMAL_... of drive/thermal_watch.h */
    bool brake_rests;
    enum drive_state state;
    uint32_t state_since;
    uint32_t underruns;
    uint32_t dropped; /* commands */
    enum drive_synchronism synchronism;
};

struct console {
    char line[CONSOLE_LINE_BYTES + 1];
    size_t line_length; /* beyond CONSOLE_LINE_BYTES: what came behind was not kept */
    bool bytes_lost;    /* of the line, by the board */
    bool nul;           /* a byte of the line */
    uint8_t received[CONSOLE_PIECE_BYTES];
    size_t received_count;
    size_t taken;         /* of them */
    uint32_t received_in; /* period of the '\n' that they end with, if they do */
    char answer[CONSOLE_ANSWER_BYTES];
    size_t answer_length;
    size_t answer_sent;
    struct console_announced announced;
};

struct application;

/* At start-up: announces the firmware as soon as the line takes it. */
void console_init(struct console *console);

/* What has happened so far is announced no more. */
void console_skip_announcements(struct application *application);

/* Background: sends, announces, or reads and obeys one line; as much as fits. */
void console_background(struct application *application);

#endif
