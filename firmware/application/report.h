/* What the console says of the drive, one line each, written behind what the text holds already. */
#ifndef STEADYSTEP_REPORT_H
#define STEADYSTEP_REPORT_H

#include "firmware/design/text.h"
#include "firmware/interface/drive_interface.h"

struct application;
struct line_form;

/* "<version of the image>, float, on <board>; ...; started by: power-on" */
void report_start(struct text *text, const struct application *application);

/* Why the stored settings are not in force. */
void report_refused_settings(struct text *text, const struct application *application);

/* "fault: overcurrent in period 1234: ...; the bridge is open, disable clears it" */
void report_fault(struct text *text, const struct application *application);

/* "warning: 2 commands dropped: ...", so many more than were announced before. */
void report_dropped(struct text *text, uint32_t more);

/* "warning: synchronism doubtful: ...", "... lost: ...", "warning: stalled: ..." or
   "synchronism: sure again" */
void report_synchronism(struct text *text, enum drive_synchronism synchronism);

/* "warning: thermal: motor hot, derated; bridge ...", or that all is well; `shown` THERMAL_... of
   drive/thermal_watch.h. */
void report_heat(struct text *text, uint8_t shown);

/* "ready: ..." */
void report_ready(struct text *text, const struct application *application);

/* The answers to state, signals, cycles, help and help <topic>. */
void report_state(struct text *text, const struct application *application);
void report_signals(struct text *text, const struct application *application);
void report_cycles(struct text *text, const struct application *application);
void report_help(struct text *text, const struct line_form *topic);

#endif
