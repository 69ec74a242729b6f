/* The state detecting-position: the bridge belongs to estimator/initial_position.h. */
#ifndef STEADYSTEP_POSITION_DETECTING_H
#define STEADYSTEP_POSITION_DETECTING_H

#include "firmware/drive/drive.h"

/*
 * One period of it, up to the one in which the state is left: for aligning or operation with the
 * rotor's angle known, or for the fault position-not-found.
 */
__attribute__((noinline)) struct hal_outputs
position_detecting_cycle(struct drive *drive, const struct hal_samples *samples);

#endif
