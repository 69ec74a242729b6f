/*
 * The pin map: with board.h, what to change for another wiring. Reference: NUCLEO-G474RE with a
 * double H-bridge of discrete MOSFETs (README.md has the wiring table). A test compares pins,
 * signals and alternate functions with an independent description of the chip.
 *
 *   PIN(port, number, mode, alternate function, pull, peripheral, signal)
 *
 * Inputs of gate drivers are pulled down, so that nothing conducts before the timer drives them;
 * the driver's own pull-down does the same while the chip is in reset. The encoder's inputs are
 * pulled up for open-collector encoders. Analog pins are never pulled.
 */
#ifndef STEADYSTEP_STM32G474_PINS_H
#define STEADYSTEP_STM32G474_PINS_H

#define BOARD_PINS(PIN)                                                                            \
    /* half-bridges A+, A-, B+, B-: high side, low side */                                         \
    PIN(C, 0, ALTERNATE, 2, DOWN, TIM1, CH1)                                                       \
    PIN(C, 1, ALTERNATE, 2, DOWN, TIM1, CH2)                                                       \
    PIN(C, 2, ALTERNATE, 2, DOWN, TIM1, CH3)                                                       \
    PIN(C, 3, ALTERNATE, 2, DOWN, TIM1, CH4)                                                       \
    PIN(A, 11, ALTERNATE, 6, DOWN, TIM1, CH1N)                                                     \
    PIN(A, 12, ALTERNATE, 6, DOWN, TIM1, CH2N)                                                     \
    PIN(B, 15, ALTERNATE, 4, DOWN, TIM1, CH3N)                                                     \
    PIN(C, 5, ALTERNATE, 6, DOWN, TIM1, CH4N)                                                      \
    /* shunts: A- and B- measured and compared, A+ and B+ compared */                              \
    PIN(A, 1, ANALOG, 0, NONE, OPAMP1, VINP0)                                                      \
    PIN(A, 7, ANALOG, 0, NONE, OPAMP2, VINP0)                                                      \
    PIN(A, 0, ANALOG, 0, NONE, COMP3, INP0)                                                        \
    PIN(B, 0, ANALOG, 0, NONE, COMP4, INP0)                                                        \
    /* leg voltages A+, A-, B+, B- */                                                              \
    PIN(B, 1, ANALOG, 0, NONE, ADC3, IN1)                                                          \
    PIN(B, 13, ANALOG, 0, NONE, ADC3, IN5)                                                         \
    PIN(B, 12, ANALOG, 0, NONE, ADC4, IN3)                                                         \
    PIN(B, 14, ANALOG, 0, NONE, ADC4, IN4)                                                         \
    /* bus voltage, temperature of the bridge */                                                   \
    PIN(B, 11, ANALOG, 0, NONE, ADC1, IN14)                                                        \
    PIN(C, 4, ANALOG, 0, NONE, ADC2, IN5)                                                          \
    /* encoder A, B */                                                                             \
    PIN(B, 6, ALTERNATE, 2, UP, TIM4, CH1)                                                         \
    PIN(B, 7, ALTERNATE, 2, UP, TIM4, CH2)                                                         \
    /* serial line, through the debugger's virtual port */                                         \
    PIN(A, 2, ALTERNATE, 12, NONE, LPUART1, TX)                                                    \
    PIN(A, 3, ALTERNATE, 12, UP, LPUART1, RX)                                                      \
    /* light-emitting diode LD2 */                                                                 \
    PIN(A, 5, OUTPUT, 0, NONE, GPIOA, LED)

/* Channels of the converters that the pins above lead to. */
enum {
    CHANNEL_OPAMP1 = 13,     /* ADC1, internal */
    CHANNEL_OPAMP2 = 16,     /* ADC2, internal */
    CHANNEL_BUS = 14,        /* ADC1 */
    CHANNEL_TEMPERATURE = 5, /* ADC2 */
    CHANNEL_LEG_A_PLUS = 1,  /* ADC3 */
    CHANNEL_LEG_A_MINUS = 5, /* ADC3 */
    CHANNEL_LEG_B_PLUS = 3,  /* ADC4 */
    CHANNEL_LEG_B_MINUS = 4, /* ADC4 */
};

enum { LED_PIN = 5 }; /* of GPIOA */

/* Connects every pin; the gates only after the timer holds them low. */
void pins_connect(void);

/* The diode. */
void pins_led(int on);

#endif
