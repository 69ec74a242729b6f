/*
 * Constants of the reference board and the state that its parts share. What wiring and amplifiers
 * make of volts and amperes: another board changes this file and pins.h. The schematic-level
 * reasons are in README.md.
 */
#ifndef STEADYSTEP_STM32G071_BOARD_H
#define STEADYSTEP_STM32G071_BOARD_H

#include <stdint.h>

#include "hal/hal.h"

#define BOARD_NAME "NUCLEO-G071RB with integrated double bridge"

/*
 * 20 mOhm, amplified 13.75 times about 1.65 V: 1.65 V + 0.275 V/A, 12 A over 4096 codes. A positive
 * current flows through the motor from leg plus to leg minus, and while all low sides conduct, down
 * the shunt of leg minus and up that of leg plus: so the shunts are those of A- and B-.
 */
#define CURRENT_A_PER_CODE (12.0 / 4096.0)
/* Dividers of the supply and of the legs: 17.8 kOhm over 2.10 kOhm, 31.2 V over 4096 codes. */
#define BUS_V_PER_CODE (31.2 / 4096.0)
/* Of the difference of two legs: one code is two of a leg. */
#define PHASE_VOLTAGE_V_PER_CODE (62.4 / 4096.0)
/* Both conducting switches, 2 x 80 mOhm, and the 20 mOhm of a shunt. */
#define BRIDGE_RESISTANCE_OHM 0.18
/* Of the bridge itself. */
#define BRIDGE_DEAD_TIME_s 5e-9

enum {
    CURRENT_ZERO_CODE = 2048,
    CONTROL_PERIOD_us = 100,
    /* Background work in double precision takes longer here than on a faster core. */
    WATCHDOG_ms = 200
};

extern const struct hal board;

/* Index of the last control interrupt that has begun; UINT32_MAX before the first. */
uint32_t board_period(void);

#endif
