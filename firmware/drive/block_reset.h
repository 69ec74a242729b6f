/* What enabling begins with. Apart from the states, as it can be compiled for size. */
#ifndef STEADYSTEP_BLOCK_RESET_H
#define STEADYSTEP_BLOCK_RESET_H

#include "firmware/drive/drive.h"

/* In the interrupt: all blocks at rest at the initial position; a calibrated resistance is kept. */
__attribute__((noinline)) void drive_reset_blocks(struct drive *drive);

#endif
