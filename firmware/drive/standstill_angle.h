/* Pulses on the hold, and what they show of the rotor: estimator/standstill_pulses.h. */
#ifndef STEADYSTEP_STANDSTILL_ANGLE_H
#define STEADYSTEP_STANDSTILL_ANGLE_H

#include "firmware/drive/drive.h"

/*
 * In a period that the pulses blank to the estimator: `winding` becomes what its model expects.
 * The current that the iron adds to a pulse is not of the model; the voltage that it takes at the
 * resistance is left out of the driving one. Else each pulse, of either sign, would leave a current
 * along the flux that the estimator takes for a resistance.
 */
void standstill_angle_blank_sample(struct drive *drive, struct channels *winding);

/* Before the voltage in force is known: what the bridge was found to take of the voltage before a
 * pulse holds. */
void standstill_angle_begin(struct drive *drive);

/*
 * One period of the hold: its voltage with the pulses laid over it; presets in the estimator what
 * they have shown. `integral`: of the current control before this period. Not inlined, so that the
 * voltage of drives without pulses stays in registers.
 */
__attribute__((noinline, cold)) struct phases standstill_angle_step(struct drive *drive,
                                                                    const struct estimate *estimate,
                                                                    struct dq integral,
                                                                    struct phases voltage);

/* One period in which the rotor is not held: a pulse that ran is given up. */
__attribute__((noinline, cold)) void standstill_angle_rest(struct drive *drive);

#endif
