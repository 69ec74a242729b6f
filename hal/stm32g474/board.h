/*
 * What the drivers know of the board: time, which the port chooses, and the wiring, which the pin
 * map states. The build names the pin map (-D STEADYSTEP_PIN_MAP): a file of pin_maps/ or one of
 * your own. It defines, and pin_map_check.c checks:
 *
 *   BOARD_NAME
 *   CRYSTAL_Hz            at OSC_IN: 4...48 MHz, whole multiples of 4 MHz; 0: none, HSI16 (+-1 %)
 *   BOARD_PINS(PIN)       PIN(port A...C, number, mode, alternate function, pull, peripheral,
 *                         signal); a test compares them with an independent description of the
 *                         chip. Analog pins are never pulled.
 *   BRIDGE                BRIDGE_OF_GATES: TIM1 gives both gates of a leg and their dead time.
 *                         BRIDGE_INTEGRATED: it gives one signal a leg, whose low level turns the
 *                         low side on; an output BRIDGE_RESET_PORT, BRIDGE_RESET_PIN that is low
 *                         opens the bridge; its fault output, low, comes in at TIM1 BKIN
 *   HIGH_GATES_ACTIVE_LOW, LOW_GATES_ACTIVE_LOW
 *                         1: the drivers' inputs of those gates turn a MOSFET on while they are
 *                         low; their pins are to be pulled up, here and outside. Not given: 0
 *   DEAD_TIME_CYCLES      of TIM1, 1/170 us; 64...127, even 128...254, of 256...504 multiples of
 *                         8; 0 with BRIDGE_INTEGRATED, whose own is BRIDGE_DEAD_TIME_s
 *   BRIDGE_RESISTANCE_OHM of both switches that conduct, and what of the shunts is in series; 0:
 *                         the hold at enabling measures it with the motor's
 *   CHANNEL_A_PLUS...     channel 1...4 of TIM1 of each leg: A_PLUS, A_MINUS, B_PLUS, B_MINUS
 *   AMPLIFIER_A, _B       OPAMP of a phase's shunt, that of the leg minus: 1 for a, which ADC1
 *                         converts, 2 or 3 for b, which ADC2 does; 0: an amplifier outside
 *   AMPLIFIER_A_INPUT...  its input VINP0...2
 *   AMPLIFIER_GAIN        of both: 2, 4, 8, 16, 32 or 64
 *   CURRENT_A_CHANNEL, _B of ADC1 and of ADC2: 13 of OPAMP1, 16 of OPAMP2, 18 of OPAMP3
 *   CURRENT_A_PER_CODE, CURRENT_ZERO_CODE
 *   OVERCURRENT_COMPARATORS(COMPARATOR)
 *                         COMPARATOR(COMP1...7, input INP0 or INP1) of every shunt that trips; may
 *                         be empty with BRIDGE_INTEGRATED
 *   OVERCURRENT_mA, COMPARATOR_uV, COMPARATOR_uV_PER_A
 *                         the trip; voltage at the comparators without current, and per ampere
 *   LEGS_A_CONVERTER, _B  ADC3, ADC4 or ADC5, and there LEG_A_PLUS_CHANNEL... 1...18
 *   PHASE_VOLTAGE_V_PER_CODE  of the difference of two legs: a code is two codes of a leg
 *   BUS_CHANNEL, BUS_V_PER_CODE, TEMPERATURE_CHANNEL   of ADC1, ADC1 and ADC2
 *   BRIDGE_NTC_BETA_K     of the NTC resistor there, firmware/drive/thermal_model.h; 0: none
 *   HAS_BRAKE             1: an output BRAKE_PORT, BRAKE_PIN connects the brake resistor while it
 *                         is high; pulled down, here and outside. 0: none
 *   MACHINE_INPUTS_PORT, MACHINE_INPUTS_PIN
 *                         the first of five pins, one behind the other: limit -, limit +, home,
 *                         enable, quick stop (hal.h, HAL_INPUT_...); pulled up
 *   MACHINE_OUTPUTS_PORT, MACHINE_OUTPUTS_PIN
 *                         of three: alarm, in position, holding brake; pulled down, here and
 *                         outside
 *   ENCODER_TIMER         4, 5 or 8: its channels 1 and 2; 0: none
 *   ENCODER_INDEX_CHANNEL 3 or 4: that channel's pin has the encoder's index; 0 or not given: none
 *   BAUD                  of LPUART1
 *   CAN_BIT_Hz            bit rate of FDCAN3: 125000, 250000, 500000, 1000000; 0 or not given: no
 * bus LED_PORT, LED_PIN
 */
#ifndef STEADYSTEP_STM32G474_BOARD_H
#define STEADYSTEP_STM32G474_BOARD_H

#include <stdint.h>

/* Values of BRIDGE. */
#define BRIDGE_OF_GATES   1
#define BRIDGE_INTEGRATED 2

#include STEADYSTEP_PIN_MAP

#ifndef ENCODER_INDEX_CHANNEL
#define ENCODER_INDEX_CHANNEL 0
#endif
#ifndef CAN_BIT_Hz
#define CAN_BIT_Hz 0
#endif

enum {
    CORE_Hz = 170000000,
    HSI16_Hz = 16000000,

    CONTROL_PERIOD_us = STEADYSTEP_CONTROL_PERIOD_us,   /* by the build: 200, 100 or 50 */
    PWM_PERIOD = CORE_Hz / 1000000 * CONTROL_PERIOD_us, /* core cycles, valley to valley */
    PWM_HALF_PERIOD = PWM_PERIOD / 2,
    DEADLINE_CYCLES = PWM_PERIOD / 10 * 9, /* after S(k), for the end of the control interrupt */

    CONVERTER_CODES = 4096, /* 12 bits */

    /* Counts from the trigger to the peak, at which the currents are held: 24.5 ADC clocks of
       sampling and 2 of latency, 106, less 2 so that it is not before. */
    CURRENT_SAMPLING_LEAD = 104,

    /* Leg voltages: groups of conversions in a period, and their results added up in each. */
    LEG_OVERSAMPLING = CONTROL_PERIOD_us >= 100 ? 8 : 4,
    LEG_GROUP_CYCLES = 125 * LEG_OVERSAMPLING,
    LEG_GROUPS = PWM_PERIOD / LEG_GROUP_CYCLES, /* 17; 34 at 5 kHz */

    /* A bit of the CAN bus is so many quanta of 1/34 us, an eighth of them, rounded up, behind the
       sample point: 85.3 % at 1 Mbit/s, 86.8 % at 500 kbit/s, 87.5 % below. */
    CAN_PRESCALER = 5,
    CAN_QUANTUM_Hz = CORE_Hz / CAN_PRESCALER, /* PCLK1 is the core's clock */
    CAN_QUANTA = CAN_BIT_Hz > 0 ? CAN_QUANTUM_Hz / (CAN_BIT_Hz + (CAN_BIT_Hz == 0)) : 0,
    CAN_SEGMENT_2 = (CAN_QUANTA + 7) / 8,

    WATCHDOG_ms = 50,
};

/* Largest difference of delay between the two legs of a phase, assumed: drivers of one type and
   lot, and their MOSFETs. */
#define LEG_DELAY_s 20e-9

/* Around a peak: 1 us of dead time, as much for the amplifiers to settle, and as much behind it. */
#define LOW_STATE_s 4e-6

/* What calibration leaves of a current's offset, assumed: four codes, 3.2 mV, are the amplifier's
   drift of 10 uV/K over 40 K at a gain of 8. */
#define CURRENT_OFFSET_CODES 4.0

#ifndef HIGH_GATES_ACTIVE_LOW
#define HIGH_GATES_ACTIVE_LOW 0
#endif
#ifndef LOW_GATES_ACTIVE_LOW
#define LOW_GATES_ACTIVE_LOW 0
#endif

#ifndef BRIDGE_DEAD_TIME_s
#define BRIDGE_DEAD_TIME_s (DEAD_TIME_CYCLES / (double)CORE_Hz)
#endif

/* Of 4096 codes of the reference, 3.3 V; rounded. */
#define OVERCURRENT_uV   (COMPARATOR_uV + (int64_t)(COMPARATOR_uV_PER_A) * (OVERCURRENT_mA) / 1000)
#define OVERCURRENT_CODE ((4096 * OVERCURRENT_uV + 1650000) / 3300000)

/* How many comparators trip. */
#define ONE_MORE(number, input) +1
#define OVERCURRENT_INPUTS      (0 OVERCURRENT_COMPARATORS(ONE_MORE))

/* PERIPHERAL(ADC, LEGS_A_CONVERTER): ADC3. */
#define JOIN(name, number)       name##number
#define PERIPHERAL(name, number) JOIN(name, number)

#endif
