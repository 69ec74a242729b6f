/*
 * The pin map: the one file to change for another wiring. Reference: NUCLEO-G071RB with an
 * integrated double bridge (DRV8412 class), one PWM input per half-bridge. A test compares pins,
 * signals and alternate functions with an independent description of the chip.
 *
 *   PIN(port, number, mode, alternate function, pull, peripheral, signal)
 *
 * Inputs of the bridge are pulled down and FAULT is pulled up, so that nothing conducts before the
 * timer drives them. Analog pins are never pulled. The converter's sequencer knows IN0...IN14 only.
 */
#ifndef STEADYSTEP_STM32G071_PINS_H
#define STEADYSTEP_STM32G071_PINS_H

#define BOARD_PINS(PIN)                                                                            \
    /* PWM_A...PWM_D: half-bridges A+, A-, B+, B- */                                               \
    PIN(C, 8, ALTERNATE, 2, DOWN, TIM1, CH1)                                                       \
    PIN(C, 9, ALTERNATE, 2, DOWN, TIM1, CH2)                                                       \
    PIN(C, 10, ALTERNATE, 2, DOWN, TIM1, CH3)                                                      \
    PIN(C, 11, ALTERNATE, 2, DOWN, TIM1, CH4)                                                      \
    /* FAULT, open drain; RESET_AB and RESET_CD joined, low: all half-bridges open */              \
    PIN(A, 6, ALTERNATE, 2, UP, TIM1, BK)                                                          \
    PIN(B, 13, OUTPUT, 0, DOWN, GPIOB, RESET)                                                      \
    /* amplified shunts of A- and B- */                                                            \
    PIN(A, 0, ANALOG, 0, NONE, ADC1, IN0)                                                          \
    PIN(A, 1, ANALOG, 0, NONE, ADC1, IN1)                                                          \
    /* leg voltages A+, A-, B+, B- */                                                              \
    PIN(A, 4, ANALOG, 0, NONE, ADC1, IN4)                                                          \
    PIN(A, 7, ANALOG, 0, NONE, ADC1, IN7)                                                          \
    PIN(B, 0, ANALOG, 0, NONE, ADC1, IN8)                                                          \
    PIN(B, 1, ANALOG, 0, NONE, ADC1, IN9)                                                          \
    /* supply, temperature of the bridge */                                                        \
    PIN(B, 2, ANALOG, 0, NONE, ADC1, IN10)                                                         \
    PIN(B, 10, ANALOG, 0, NONE, ADC1, IN11)                                                        \
    /* serial line, through the debugger's virtual port */                                         \
    PIN(A, 2, ALTERNATE, 6, NONE, LPUART1, TX)                                                     \
    PIN(A, 3, ALTERNATE, 6, UP, LPUART1, RX)                                                       \
    /* light-emitting diode LD4, not driven yet */                                                 \
    PIN(A, 5, OUTPUT, 0, NONE, GPIOA, LED)

/* Channels of the converter, as wired above. */
enum {
    CHANNEL_CURRENT_A = 0,
    CHANNEL_CURRENT_B = 1,
    CHANNEL_LEG_A_PLUS = 4,
    CHANNEL_LEG_A_MINUS = 7,
    CHANNEL_LEG_B_PLUS = 8,
    CHANNEL_LEG_B_MINUS = 9,
    CHANNEL_BUS = 10,
    CHANNEL_TEMPERATURE = 11
};

#define BRIDGE_RESET_PORT GPIOB
#define LED_PORT          GPIOA
enum { BRIDGE_RESET_PIN = 13, LED_PIN = 5 };

/* Connects every pin; after the timer holds the bridge's inputs low. */
void pins_connect(void);

#endif
