/*
 * What the drivers know of the board: time, which the port chooses, and the wiring, which the pin
 * map states. The build names the pin map (-D STEADYSTEP_PIN_MAP): a file of pin_maps/ or one of
 * your own. It defines, and pin_map_check.c checks:
 *
 *   BOARD_NAME
 *   BOARD_PINS(PIN)       PIN(port A...C, number, mode, alternate function, pull, peripheral,
 *                         signal); a test compares them with an independent description of the
 *                         chip. Analog pins are never pulled.
 *   CHANNEL_A_PLUS...     channel 1...4 of TIM1 of each leg: A_PLUS, A_MINUS, B_PLUS, B_MINUS
 *   BRIDGE_RESET_PORT, BRIDGE_RESET_PIN   an output that opens the bridge while it is low; the
 *                         bridge's fault output, low, comes in at TIM1 BK
 *   BRIDGE_DEAD_TIME_s, BRIDGE_RESISTANCE_OHM   of both switches that conduct, and what of the
 *                         shunts is in series
 *   CURRENT_A_CHANNEL...  of the converter, 0...14, which is all that its sequencer knows: currents
 *                         A and B, LEG_A_PLUS_CHANNEL..., BUS_CHANNEL, TEMPERATURE_CHANNEL
 *   BRIDGE_NTC_BETA_K     of the NTC resistor there, firmware/drive/thermal_model.h; 0: none
 *   CURRENT_A_PER_CODE, CURRENT_ZERO_CODE, BUS_V_PER_CODE
 *   PHASE_VOLTAGE_V_PER_CODE   of the difference of two legs: a code is two codes of a leg
 *   HAS_BRAKE             1: an output BRAKE_PORT, BRAKE_PIN connects the brake resistor while it
 *                         is high; pulled down, here and outside. 0: none
 *   BAUD                  of LPUART1
 */
#ifndef STEADYSTEP_STM32G071_BOARD_H
#define STEADYSTEP_STM32G071_BOARD_H

#include STEADYSTEP_PIN_MAP

enum {
    CONTROL_PERIOD_us = 100,
    /* Background work in double precision takes longer here than on a faster core. */
    WATCHDOG_ms = 200,
    CONVERTER_CODES = 4096 /* 12 bits */
};

/* Largest difference of delay between the two legs of a phase, assumed. */
#define LEG_DELAY_s 20e-9

/* Around a peak: 1 us of dead time, as much for the amplifiers to settle, and as much behind it. */
#define LOW_STATE_s 4e-6

/* What calibration leaves of a current's offset, assumed: four codes, 3.3 mV, are 6 uV/K at the
   shunt over 40 K behind a gain of 13.75. */
#define CURRENT_OFFSET_CODES 4.0

#endif
