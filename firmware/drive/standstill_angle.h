/* Pulses on the hold, and what they show of the rotor: estimator/standstill_pulses.h. */
#ifndef STEADYSTEP_STANDSTILL_ANGLE_H
#define STEADYSTEP_STANDSTILL_ANGLE_H

#include "firmware/drive/drive.h"

/* Before the control: what the bridge was found to take of the voltage before a pulse holds. */
void standstill_angle_begin(struct drive *drive);

/*
 * One period of operation: lays the pulses over the voltage that the hold wants, and tells the
 * estimator what they have shown. `before`: the current control before this period.
 */
void standstill_angle_step(struct drive *drive, const struct estimate *estimate,
                           const struct current_control *before, struct phases *voltage);

#endif
