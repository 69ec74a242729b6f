/* The board as the firmware sees it: struct hal, made of this port's drivers. */
#ifndef STEADYSTEP_STM32G474_BOARD_HAL_H
#define STEADYSTEP_STM32G474_BOARD_HAL_H

#include "hal/hal.h"

extern const struct hal board_hal;

#endif
