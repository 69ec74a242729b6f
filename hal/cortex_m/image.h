/* What the build puts into an image (tools/board_image.py). */
#ifndef STEADYSTEP_CORTEX_M_IMAGE_H
#define STEADYSTEP_CORTEX_M_IMAGE_H

#include "firmware/motor/motor_params.h"

/* From sil/motors/; what the drive starts with when nothing is stored. */
extern const struct motor_params motor_default;

/* "steadystep <version> <hash of the sources> <board> <pin map> <number format> <motor>" */
extern const char image_version[];

#endif
