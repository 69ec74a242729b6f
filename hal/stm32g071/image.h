/* What the build writes into the image (tools/board_image.py). */
#ifndef STEADYSTEP_STM32G071_IMAGE_H
#define STEADYSTEP_STM32G071_IMAGE_H

#include "firmware/motor/motor_params.h"

extern const struct motor_params motor_default;
extern const char image_version[]; /* version, hash of the sources, board, number format, motor */

#endif
