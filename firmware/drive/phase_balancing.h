/*
 * While the drive is being enabled, behind the first hold: the currents are scaled so that both
 * phases show one resistance (phase_balance.h). Nothing of it is part of operation.
 */
#ifndef STEADYSTEP_PHASE_BALANCING_H
#define STEADYSTEP_PHASE_BALANCING_H

#include "firmware/drive/drive.h"

enum phase_balancing {
    PHASES_ARE_BEING_BALANCED,
    PHASES_ARE_BALANCED,
    PHASES_DO_NOT_MATCH,
    INDUCTANCE_DOES_NOT_MATCH
};

/* At start-up, when the path is designed: periods that it takes at most, 0 if it is left out. */
uint32_t phase_balancing_design(struct drive *drive, const struct drive_settings *settings,
                                double period_s);

/* The bridge is about to be switched on: the phases have not been compared since. */
static inline void phase_balancing_forget(struct drive *drive)
{
    if (drive->params.enabling.balance_periods > 0u) {
        drive->enabling.balance.stage = PHASES_LED;
    }
}

/* Whether they have; of a drive that compares them. */
static inline bool phase_balancing_is_done(const struct drive *drive)
{
    return drive->enabling.balance.stage == PHASES_BALANCED;
}

/* The hold has found the resistance. */
__attribute__((noinline)) void phase_balancing_start(struct drive *drive);

/* One period: the hold's angle and speed, and what is made of the samples of S(k). */
__attribute__((noinline)) enum phase_balancing
phase_balancing_step(struct drive *drive, const struct hal_samples *samples);

#endif
