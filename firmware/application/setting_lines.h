/*
 * Settings on the console: get, set, store and defaults. What is set waits in
 * `application->chosen`; once it is stored it is in force when the board starts again.
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
