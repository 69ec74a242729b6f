/*
 * What comes of the synchronism monitor's verdicts in a drive: estimator/synchronism_monitor.h.
 * With an encoder the following error is watched in its place: following_error.h.
 */
#ifndef STEADYSTEP_SYNCHRONISM_H
#define STEADYSTEP_SYNCHRONISM_H

#include "firmware/drive/drive.h"

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

/*
 * The monitor's steps follow one another in periods in which the reference just goes on and no
 * command is looked at: elsewhere they wait, so that no interrupt pays for both.
 */
static inline bool synchronism_is_due(const struct drive *drive)
{
    return RARE((int32_t)(drive->supervision.period - drive->synchronism.due) >= 0) &&
           (!drive->hold.active || !drive->hold.leads ||
            !standstill_hold_leads_in(drive->supervision.period));
}

/* How often on end a step waits: a quick sine begins a phase in every period or two. */
#define SYNCHRONISM_WAITS_MAX 3u

/* In a period in which commands are looked at (1), or a phase of the reference begins, which takes
   its time in the next one, too (2). */
static inline void synchronism_wait(struct drive *drive, uint32_t periods)
{
    const uint32_t until = drive->supervision.period + periods;

    if ((int32_t)(until - drive->synchronism.due) > 0 &&
        drive->synchronism.waits < SYNCHRONISM_WAITS_MAX) {
        drive->synchronism.due = until;
        drive->synchronism.waits++;
    }
}

/* At the end of a period in which it is due: the fault to enter, if any. */
enum drive_fault synchronism_watch(struct drive *drive);

#endif
