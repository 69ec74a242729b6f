/*
 * FDCAN3 as the board's CAN bus, CAN 2.0 (RM0440, chapter FDCAN). What comes for the node, the
 * chip's filters drop the rest, an interrupt below the control interrupt moves to memory; all else
 * is the background's.
 */
#ifndef STEADYSTEP_STM32G474_FDCAN_H
#define STEADYSTEP_STM32G474_FDCAN_H

#include "hal/hal.h"
#include "hal/stm32g474/board.h"

#ifdef STEADYSTEP_WITHOUT_LINK
enum { CARRIES_CAN = 0 };
#else
enum { CARRIES_CAN = CAN_BIT_Hz > 0 };
#endif

/* On the bus; its pins are connected. */
void fdcan_configure(void);

extern const struct hal_can fdcan;

#endif
