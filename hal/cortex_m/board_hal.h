/* The board as the firmware sees it: struct hal, made of a port's drivers (port.h). */
#ifndef STEADYSTEP_CORTEX_M_BOARD_HAL_H
#define STEADYSTEP_CORTEX_M_BOARD_HAL_H

#include "hal/hal.h"

extern const struct hal board_hal;

#endif
