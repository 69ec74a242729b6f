/*
 * Constants of the reference board: what the wiring, the amplifiers and the timer make of volts,
 * amperes and seconds. Another board changes this file and pins.h. The schematic-level reasons are
 * in README.md.
 */
#ifndef STEADYSTEP_STM32G474_BOARD_H
#define STEADYSTEP_STM32G474_BOARD_H

#include <stdint.h>

#define BOARD_NAME "NUCLEO-G474RE with discrete double H-bridge"

enum {
    CORE_Hz = 170000000,
    HSE_Hz = 24000000, /* crystal X3 of the NUCLEO-G474RE */
    HSI16_Hz = 16000000,
    BAUD = 921600,

    PWM_HALF_PERIOD = 8500,                   /* counts; 100 us, valley to valley, at 170 MHz */
    PWM_PERIOD = 2 * PWM_HALF_PERIOD,         /* core cycles */
    DEAD_TIME_CYCLES = 170,                   /* 1 us */
    DEADLINE_CYCLES = CORE_Hz / 1000000 * 90, /* after S(k), for the end of the control interrupt */
    CONTROL_PERIOD_us = 100,

    /* Leg voltages: groups of conversions in a period, and their results added up in each. */
    LEG_GROUPS = 17,
    LEG_GROUP_CYCLES = PWM_PERIOD / LEG_GROUPS,
    LEG_OVERSAMPLING = 8,

    CURRENT_ZERO_CODE = 2048,
    WATCHDOG_ms = 50,
};

/*
 * Currents: 40 mOhm; the divider in front of the amplifier passes 0.859 of it and adds 206 mV, the
 * amplifier's gain is 8: 1.65 V + 0.275 V/A, 12 A over 4096 codes.
 */
#define CURRENT_A_PER_CODE (12.0 / 4096.0)
/* Dividers of the bus and, beside a bias of 256 codes that cancels, of the legs. */
#define BUS_V_PER_CODE (31.2 / 4096.0)
/* Of the difference of two legs: one code is two of a leg. */
#define PHASE_VOLTAGE_V_PER_CODE (62.4 / 4096.0)
/* The resistance of the bridge is left to the hold at enabling, which measures it with the motor's:
   facts.bridge_resistance_ohm is 0. */

/*
 * Hardware trip at 7.0 A through a low side: 206.3 mV + 7.0 A x 34.4 mV/A at the comparator, of a
 * reference of 3.3 V and 4096 codes.
 */
enum { OVERCURRENT_CODE = 555 };

#endif
