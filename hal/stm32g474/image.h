/* What the build puts into this image; generated beside it. */
#ifndef STEADYSTEP_STM32G474_IMAGE_H
#define STEADYSTEP_STM32G474_IMAGE_H

#include "firmware/motor/motor_params.h"

/* From sil/motors/; what the drive starts with when nothing is stored. */
extern const struct motor_params motor_default;

/* "steadystep <version> <hash of the sources> <board> <number format> <motor>" */
extern const char image_version[];

#endif
