/*
 * What comes of the synchronism monitor's verdicts in a drive: estimator/synchronism_monitor.h.
 * With an encoder the following error is watched in its place: following_error.h.
 */
#ifndef STEADYSTEP_SYNCHRONISM_H
#define STEADYSTEP_SYNCHRONISM_H

#include "firmware/drive/state_machine.h"

/* At start-up, behind the estimator's design; only an invariant EKF is monitored. */
__attribute__((cold)) void synchronism_design(struct drive *drive,
                                              const struct drive_settings *settings);

/* The monitor's constants, of a drive whose estimator is designed. */
__attribute__((cold, noinline)) struct synchronism_monitor_params
synchronism_params(const struct drive *drive, const struct drive_settings *settings);

/* When the bridge is switched on: nothing is watched yet. */
void synchronism_reset(struct drive *drive);

/* When operation begins. */
void synchronism_start(struct drive *drive);

/* Whether a loss ends in a fault. Not while the axis looks for a hard stop: that throws the rotor,
   and homing takes it up from where it comes to rest. */
static inline bool synchronism_loss_is_fault(const struct drive *drive)
{
    return drive->synchronism.monitored && drive->synchronism.policy == DRIVE_SYNCHRONISM_FAULT &&
           !(LINK_CARRIED && drive->axis.seeks_stop);
}

/* So many periods at most: a quick sine claims every one or two. */
#define SYNCHRONISM_WAIT_MAX 3

/* The monitor's next step is due. It waits where the period is claimed. */
static inline bool synchronism_is_due(const struct drive *drive)
{
    const int32_t waited = (int32_t)(drive->supervision.period - drive->synchronism.due);

    return RARE(waited >= 0) &&
           (!state_machine_period_is_claimed(drive) || waited >= SYNCHRONISM_WAIT_MAX);
}

/* At the end of a period in which it is due. */
enum synchronism synchronism_step(struct drive *drive);

/* The fault to enter, if any, where the verdict is not that all is sure. Apart: rare. */
__attribute__((noinline)) enum drive_fault synchronism_act(struct drive *drive,
                                                           enum synchronism verdict);

#endif
