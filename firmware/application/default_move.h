/* Times for a jerk-limited move of which only the target is given. */
#ifndef STEADYSTEP_DEFAULT_MOVE_H
#define STEADYSTEP_DEFAULT_MOVE_H

#include "firmware/interface/drive_interface.h"

struct default_move_task {
    const struct drive_settings *settings;
    double period_s;
    double distance_rad;
    bool duration_given; /* in the command; else it is chosen here */
    bool ramp_given;
    bool jerk_given;
};

/*
 * Fills in what is not given, in whole control periods: at most a quarter of the no-load speed at
 * nominal supply and a quarter of the speed limit, a third of the acceleration that the current
 * limit allows; three quarters stay for the load. Jerk for a quarter of the ramp at each end.
 */
void default_move_times(struct drive_command *command, const struct default_move_task *task);

#endif
