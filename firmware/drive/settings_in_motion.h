/*
 * Settings that change in a drive that is ready: rows of interface/settings_table.h that say
 * IN_MOTION. Each is a constant of the interrupt that is written as a whole, and none makes a kink:
 *
 *   current_limit_A      of the q current in law and hold, less what thermal_watch.h takes, and
 *                        what the synchronism monitor takes for all of it: a demand beyond it is
 *                        cut, any other goes on as it is
 *   motion_current_A     to which i_d* ramps, with the ramp of the hold current
 *   overcurrent_trip_A   the range of codes; for a period it may be the wider of both
 *   synchronism_policy   between fault and warn
 */
#ifndef STEADYSTEP_SETTINGS_IN_MOTION_H
#define STEADYSTEP_SETTINGS_IN_MOTION_H

#include "firmware/drive/drive.h"

/*
 * Background, of a drive in operation: puts these of `wanted` in force. false: refused, reason in
 * error, and nothing has changed. What the steps of enabling make of them, a design follows.
 */
bool settings_in_motion_change(struct drive *drive, const struct drive_settings *wanted,
                               char error[DRIVE_ERROR_TEXT]);

/* Background: what thermal_watch.h leaves of current_limit_A, in force within microseconds, so that
   it acts in the same period on every board. */
void settings_in_motion_derate(struct drive *drive);

#endif
