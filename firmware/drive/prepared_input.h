/* What the estimator gets instead of what is measured: voltages that the board does not measure,
   and samples that a pulse blanks. */
#ifndef STEADYSTEP_PREPARED_INPUT_H
#define STEADYSTEP_PREPARED_INPUT_H

#include "firmware/drive/drive.h"

/* When enabling begins: the bridge is off. */
static inline void prepared_input_reset(struct drive *drive)
{
    drive->input.past_current = (struct phases){NUM(0.0), NUM(0.0)};
}

/*
 * Once at S(k), with the current sampled there: mean over S(k-1)...S(k) of what was commanded, less
 * what the bridge took of it (motor/bridge_loss.h). Once in the image: the default path does not
 * come here.
 */
__attribute__((noinline)) struct phases prepared_input_voltage(struct drive *drive,
                                                               struct phases current);

/*
 * One period: puts what the estimator is to get in place of what is measured. A current that a
 * pulse has made is not for it: it goes by its model meanwhile.
 */
__attribute__((noinline)) void prepared_input_make(struct drive *drive, struct channels *winding);

#endif
