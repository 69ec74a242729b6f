/* The control interrupt in double whose operations are rounded as another format's (rounding.h). */
#ifndef STEADYSTEP_ONE_STEP_ROUNDED_DRIVE_H
#define STEADYSTEP_ONE_STEP_ROUNDED_DRIVE_H

#include "hal/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

enum rounding_format { ROUNDING_NONE, ROUNDING_FLOAT, ROUNDING_FIXED, ROUNDING_ONE_MOTOR };

/* Evenly between low and high; the same draws on every machine. */
double rounding_between(double low, double high);

/* Of the drive of an instance of the image in double; `outputs` come from the period before. */
void rounded_control_cycle(void *drive, const struct hal_samples *samples,
                           enum rounding_format format, struct hal_outputs *outputs);

#ifdef __cplusplus
}
#endif

#endif
