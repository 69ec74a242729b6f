/*
 * Settings on the console: get, set, store and defaults. What is set waits in
 * `application->chosen` for the next enable (application_command); in a drive that is ready, what
 * may change in motion acts at once, and all else is refused. `store` keeps what is set and what
 * was learned.
 */
#ifndef STEADYSTEP_SETTING_LINES_H
#define STEADYSTEP_SETTING_LINES_H

#include "firmware/application/command_line.h"

struct application;

/*
 * Obeys a line of one of these; `answer` holds "ok ..." or "error: ..." then. An element of an
 * array is named with its number, from 1 on: detent_torque_Nm.2.
 */
bool setting_line_obey(struct application *application, const struct command_line *line,
                       struct text *answer);

#endif
