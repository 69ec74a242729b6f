/* What enabling begins with. Apart from the states, as it can be compiled for size. */
#ifndef STEADYSTEP_BLOCK_RESET_H
#define STEADYSTEP_BLOCK_RESET_H

#include "firmware/drive/drive.h"

/* In the interrupt, when enabling begins: what controls is at rest. */
__attribute__((noinline)) void drive_reset_control(struct drive *drive);

/* Bumpless: the current control begins with the voltage that the present current takes. */
__attribute__((noinline)) void drive_preset_current_control(struct drive *drive);

/* When the bridge is switched on, so that no interrupt pays for both: estimate and reference are at
   rest at the initial position; a calibrated resistance is kept. */
__attribute__((noinline)) void drive_reset_motion(struct drive *drive);

#endif
