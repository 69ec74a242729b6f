/* The constants of the position law, from the settings of a drive. */
#ifndef STEADYSTEP_LAW_DESIGN_H
#define STEADYSTEP_LAW_DESIGN_H

#include "firmware/drive/drive.h"

/* Those of settings->law, whose base and board are the drive's. false: refused, reason in error. */
bool law_design(const struct drive *drive, const struct drive_settings *settings,
                union position_law_params *law, char error[DRIVE_ERROR_TEXT]);

#endif
