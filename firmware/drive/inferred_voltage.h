/* The phase voltages of a board that does not measure them: motor/bridge_loss.h. */
#ifndef STEADYSTEP_INFERRED_VOLTAGE_H
#define STEADYSTEP_INFERRED_VOLTAGE_H

#include "firmware/drive/drive.h"

/*
 * Once at S(k), with the current sampled there: mean over S(k-1)...S(k) of what was commanded, less
 * what the bridge took of it. Once in the image: the default path does not come here.
 */
__attribute__((noinline)) struct phases inferred_voltage(struct drive *drive,
                                                         struct phases current);

#endif
