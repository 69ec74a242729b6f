/* The state finding-position: the bridge belongs to estimator/initial_position.h. */
#ifndef STEADYSTEP_FINDING_POSITION_H
#define STEADYSTEP_FINDING_POSITION_H

#include "firmware/drive/drive.h"

/*
 * One period of it, up to the one in which the state is left: for aligning or operation with the
 * rotor's angle known, or for the fault position-not-found.
 */
__attribute__((noinline)) struct hal_outputs
finding_position_cycle(struct drive *drive, const struct hal_samples *samples);

#endif
