#include "firmware/application/console.h"

#include "firmware/application/application.h"
#include "firmware/application/command_line.h"
#include "firmware/application/default_move.h"
#include "firmware/application/report.h"
#include "firmware/application/setting_lines.h"
#include "firmware/drive/interrupt_view.h"

static uint32_t period_now(const struct application *application)
{
    return interrupt_view_period(&application->drive);
}

/* ---- answers ---- */

static struct text begin_answer(struct console *console)
{
    return text_in(console->answer, sizeof console->answer - 1u); /* and the end of the line */
}

static void end_answer(struct console *console, const struct text *answer)
{
    console->answer[answer->length] = '\n';
    console->answer_length = answer->length + 1u;
    console->answer_sent = 0;
}

/* false: some of the last line still waits for room. */
static bool send(struct application *application)
{
    struct console *console = &application->console;
    const struct hal *board = &application->board;
    const size_t left = console->answer_length - console->answer_sent;

    if (left > 0u) {
        const uint8_t *bytes = (const uint8_t *)&console->answer[console->answer_sent];

        console->answer_sent += board->stream_write(board->context, bytes, left);
    }
    return console->answer_sent == console->answer_length;
}

/* ---- announcements ---- */

/* A new state that somebody should hear of. */
static bool announce_state(const struct application *application,
                           struct console_announced *announced, struct text *text)
{
    const struct drive *drive = &application->drive;
    const enum drive_state state = interrupt_view_state(drive);
    const uint32_t since = interrupt_view_state_since(drive);

    if (state == announced->state && since == announced->state_since) {
        return false;
    }
    announced->state = state;
    announced->state_since = since;
    if (state == DRIVE_FAULT) {
        report_fault(text, application);
    } else if (state == DRIVE_OPERATION_ENABLED) {
        report_ready(text, application);
    }
    return text->length > 0u;
}

/* While the drive is in operation; a fault has its own announcement. */
static bool announce_synchronism(const struct application *application,
                                 struct console_announced *announced, struct text *text)
{
    const struct drive *drive = &application->drive;
    const enum drive_synchronism now = interrupt_view_synchronism(drive);

    if (announced->state != DRIVE_OPERATION_ENABLED) {
        announced->synchronism = DRIVE_SYNCHRONISM_SURE;
        return false;
    }
    if (now == announced->synchronism) {
        return false;
    }
    announced->synchronism = now;
    report_synchronism(text, now);
    return true;
}

/* Commands that had been accepted. */
static bool announce_dropped(const struct application *application,
                             struct console_announced *announced, struct text *text)
{
    const uint32_t dropped = interrupt_view_commands_dropped(&application->drive);

    if (dropped == announced->dropped) {
        return false;
    }
    report_dropped(text, dropped - announced->dropped);
    announced->dropped = dropped;
    return true;
}

/* That a motion was stopped since no line came. */
static bool announce_unheard(const struct application *application,
                             struct console_announced *announced, struct text *text)
{
    if (announced->unheard == application->unheard) {
        return false;
    }
    announced->unheard = application->unheard;
    if (announced->unheard) {
        text_put(text, "warning: stop: no line for command_timeout_s");
    }
    return announced->unheard;
}

/* That heat takes from the current, or does not any more. */
static bool announce_heat(const struct application *application,
                          struct console_announced *announced, struct text *text)
{
    const uint8_t now = application->drive.thermal.shown;

    if (now == announced->heat) {
        return false;
    }
    announced->heat = now;
    report_heat(text, now);
    return true;
}

/* That the bus is no longer held by its brake resistor. */
static bool announce_brake(const struct application *application,
                           struct console_announced *announced, struct text *text)
{
    const bool rests = interrupt_view_brake_rests(&application->drive);

    if (rests && !announced->brake_rests) {
        text_put(text, "warning: brake off: at its limit");
    }
    announced->brake_rests = rests;
    return text->length > 0u;
}

/* That an input has stopped the motion. */
static bool announce_stop(const struct application *application,
                          struct console_announced *announced, struct text *text)
{
    const uint8_t stop = MACHINE_IO_CARRIED ? application->io.stop : (uint8_t)MACHINE_STOP_NONE;

    if (stop != announced->stop && stop != MACHINE_STOP_NONE) {
        text_put(text, "warning: stop: ");
        text_put(text, machine_stop_text((enum machine_stop)stop));
    }
    announced->stop = stop;
    return text->length > 0u;
}

static bool announce(struct application *application)
{
    struct console *console = &application->console;
    struct console_announced *announced = &console->announced;
    struct text text = begin_answer(console);

    if (!announced->start) {
        announced->start = true;
        report_start(&text, application);
    } else if (application->stored_refusal[0] != '\0') {
        report_refused_settings(&text, application);
        application->stored_refusal[0] = '\0';
    } else if (application->drive.planner.underruns != announced->underruns) {
        announced->underruns = application->drive.planner.underruns;
        text_put(&text, "warning: the reference rests: what continues it came too late");
    } else if (!announce_unheard(application, announced, &text) &&
               !announce_brake(application, announced, &text) &&
               !announce_stop(application, announced, &text) &&
               !announce_state(application, announced, &text) &&
               !announce_dropped(application, announced, &text) &&
               !announce_heat(application, announced, &text) &&
               !announce_synchronism(application, announced, &text)) {
        return false;
    }
    end_answer(console, &text);
    return true;
}

void console_skip_announcements(struct application *application)
{
    const struct drive *drive = &application->drive;
    struct console_announced *announced = &application->console.announced;

    announced->state = interrupt_view_state(drive);
    announced->state_since = interrupt_view_state_since(drive);
    announced->underruns = drive->planner.underruns;
    announced->dropped = interrupt_view_commands_dropped(drive);
    announced->synchronism = interrupt_view_synchronism(drive);
    announced->unheard = application->unheard;
    announced->stop = application->io.stop;
}

/* ---- commands ---- */

/* The period a line that came in `line_period` acts in. */
static bool address(const struct application *application, struct command_line *line,
                    uint32_t line_period, struct text *answer)
{
    const uint32_t lead = drive_command_is(line->command.kind, DRIVE_AHEAD)
                              ? planner_lead_periods(&application->drive)
                              : 0u;
    const uint32_t first = line_period + application_typed_delay(application) + lead;
    const uint32_t range = (uint32_t)(DRIVE_AHEAD_MAX_s / application->facts.control_period_s);
    const uint32_t earliest = drive_command_is(line->command.kind, DRIVE_URGENT)
                                  ? first
                                  : command_queue_earliest(&application->drive.commands, first);

    line->command.at_period = line->at_given ? line->at_period : earliest;
    if (line->command.at_period - earliest <= range) {
        return true;
    }
    text_put(answer, "at=");
    text_unsigned(answer, line->at_period);
    text_put(answer, ": must be at least ");
    text_unsigned(answer, earliest);
    text_put(answer, ", the first period in which this line can act, and at most ");
    text_unsigned(answer, earliest + range);
    return false;
}

static void choose_times(struct application *application, struct command_line *line)
{
    struct drive *drive = &application->drive;
    const double here = drive_planned_end_rad(drive);
    const struct default_move_task task = {
        .settings = &drive->settings,
        .period_s = application->facts.control_period_s,
        .distance_rad = line->command.position_rad - here,
        .duration_given = (line->given >> DRIVE_PARAMETER_duration_s & 1u) != 0u,
        .ramp_given = (line->given >> DRIVE_PARAMETER_ramp_s & 1u) != 0u,
        .jerk_given = (line->given >> DRIVE_PARAMETER_jerk_s & 1u) != 0u,
    };

    default_move_times(&line->command, &task);
}

static void confirm(const struct application *application, const struct command_line *line,
                    struct text *answer)
{
    const struct drive_command *command = &line->command;

    text_put(answer, line->form->name);
    if (drive_command_is(command->kind, DRIVE_AT_ONCE)) {
        return;
    }
    text_put(answer, " at=");
    text_unsigned(answer, command->at_period);
    if (line->form->action == LINE_MOVE) {
        line_put_values(answer, command, line->form->optional);
    }
    if ((int32_t)(period_now(application) - command->at_period) >= 0) {
        text_put(answer, " late: that period had passed");
    }
}

static bool obey_command(struct application *application, struct command_line *line,
                         uint32_t line_period, struct text *answer)
{
    char refusal[DRIVE_ERROR_TEXT];

    if (!address(application, line, line_period, answer)) {
        return false;
    }
    if (line->form->action == LINE_MOVE) {
        choose_times(application, line);
    }
    if (!application_command(application, &line->command, line_period, refusal)) {
        text_put(answer, refusal);
        if (line->command.kind == DRIVE_COMMAND_ENABLE && application->awaits_enable) {
            text_put(answer, "; what was set is not in force");
        }
        return false;
    }
    /* one that waits already may come earlier */
    if (line->command.kind == DRIVE_COMMAND_DISABLE) {
        line->command.at_period = application->drive.commands.disable.at_period;
    } else if (line->command.kind == DRIVE_COMMAND_STOP) {
        line->command.at_period = application->drive.commands.stop.at_period;
    }
    return true;
}

/* ---- lines ---- */

static void report(struct application *application, const struct command_line *line,
                   struct text *answer)
{
    switch (line->form->action) {
    case LINE_HELP:
        report_help(answer, line->topic);
        break;
    case LINE_STATE:
        report_state(answer, application);
        break;
    case LINE_SIGNALS:
        text_put(answer, "signals");
        report_signals(answer, application);
        break;
    case LINE_CAPTURE:
        if (LINK_CARRIED && application->link != NULL) {
            text_put(answer, "capture ");
            capture_put(answer, application, line->at_given ? line->at_period : UINT32_MAX);
        }
        break;
    case LINE_CYCLES:
        text_put(answer, "cycles");
        control_cycles_gather(&application->cycle_statistics, &application->cycles);
        report_cycles(answer, application);
        if (line->resets) {
            control_cycles_restart(&application->cycle_statistics, &application->cycles);
        }
        break;
    default:
        confirm(application, line, answer);
        break;
    }
}

static bool is_command(const struct command_line *line)
{
    return line->form->action == LINE_COMMAND || line->form->action == LINE_MOVE;
}

static bool is_of_settings(const struct command_line *line)
{
    return line->form->action >= LINE_GET && line->form->action <= LINE_DEFAULTS;
}

/* A line of slcan, which a fieldbus's client types. */
static bool obey_link(struct application *application)
{
    struct console *console = &application->console;

    console->answer_length = 0;
    console->answer_sent = 0;
    return LINK_CARRIED && link_obey_line(application, console->line, console->line_length);
}

/* false: an empty line, which has no answer. */
static bool obey_line(struct application *application, uint32_t line_period)
{
    struct console *console = &application->console;
    const bool too_long = console->line_length > CONSOLE_LINE_BYTES;
    struct text answer = begin_answer(console);
    struct command_line line;

    console->line[too_long ? CONSOLE_LINE_BYTES : console->line_length] = '\0';
    if (!console->bytes_lost && !console->nul && obey_link(application)) {
        console->line_length = 0;
        return true;
    }
    console->line_length = 0;
    application_hear(application, line_period);
    text_put(&answer, "error: ");
    if (console->bytes_lost) {
        text_put(&answer, "bytes of the line were lost: it came too fast");
    } else if (console->nul) {
        text_put(&answer, "the line contains a NUL byte");
    } else if (too_long) {
        text_put(&answer, "the line is longer than 200 characters");
    } else if (command_line_read(&line, console->line, &answer)) {
        if (line.form == NULL) {
            return false;
        }
        if (is_of_settings(&line)) {
            answer = begin_answer(console);
            (void)setting_line_obey(application, &line, &answer);
        } else if (!is_command(&line) || obey_command(application, &line, line_period, &answer)) {
            answer = begin_answer(console);
            text_put(&answer, "ok ");
            report(application, &line, &answer);
        }
    }
    console->bytes_lost = false;
    console->nul = false;
    end_answer(console, &answer);
    return true;
}

static void take_character(struct console *console, char character)
{
    if (character == (char)HAL_STREAM_LOST) {
        console->bytes_lost = true;
    } else if (character == '\0') {
        console->nul = true;
    } else if (character == '\b' || character == '\x7f') {
        console->line_length -= console->line_length > 0u ? 1u : 0u;
    } else {
        if (console->line_length < CONSOLE_LINE_BYTES) {
            console->line[console->line_length] = character;
        }
        console->line_length += console->line_length <= CONSOLE_LINE_BYTES ? 1u : 0u;
    }
}

/* More from the board, when what it has handed out is used up. */
static void refill(struct application *application)
{
    struct console *console = &application->console;
    const struct hal *board = &application->board;

    if (console->taken == console->received_count) {
        console->taken = 0;
        console->received_count = board->stream_read(
            board->context, console->received, sizeof console->received, &console->received_in);
    }
}

/* true: an answer is to be sent. */
static bool read_line(struct application *application)
{
    struct console *console = &application->console;
    bool answered = false;

    refill(application);
    while (!answered && console->taken < console->received_count) {
        const char character = (char)console->received[console->taken++];

        if (character == '\n') {
            answered = obey_line(application, console->received_in);
        } else if (character == '\r') { /* a '\n' behind it ends an empty line: no answer */
            answered = obey_line(application, period_now(application));
        } else {
            take_character(console, character);
        }
    }
    return answered;
}

void console_init(struct console *console)
{
    *console = (struct console){.announced = {.state = DRIVE_SWITCH_ON_DISABLED}};
}

/* The line carries frames; at most one of them is taken in a pass. */
static void carry_frames(struct application *application)
{
    struct console *console = &application->console;
    bool ended = false;

    if (send(application)) {
        console->answer_length = 0;
        console->answer_sent = 0;
    }
    refill(application);
    while (!ended && link_has_room(application, 2) && console->taken < console->received_count) {
        ended = link_take(application, (char)console->received[console->taken++]);
    }
    link_background(application);
    (void)send(application);
}

void console_background(struct application *application)
{
    if (LINK_CARRIED && application->link != NULL && link_has_line(application->link)) {
        carry_frames(application);
        return;
    }
    if (LINK_CARRIED && application->link != NULL) {
        link_beside_console(application);
    }
    if (send(application) && (announce(application) || read_line(application))) {
        (void)send(application);
    }
}
