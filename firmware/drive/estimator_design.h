/* The chosen estimator, designed from the settings and set to where the rotor is assumed. */
#ifndef STEADYSTEP_ESTIMATOR_DESIGN_H
#define STEADYSTEP_ESTIMATOR_DESIGN_H

#include "firmware/drive/drive.h"

/* Model, base and initial position of the drive are there. false: refused, reason in error. */
bool estimator_design(struct drive *drive, const struct drive_settings *settings,
                      char error[DRIVE_ERROR_TEXT]);

#endif
