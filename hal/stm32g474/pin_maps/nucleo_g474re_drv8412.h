/*
 * Pin map: NUCLEO-G474RE with an integrated double bridge (DRV8412 class): one PWM input per
 * half-bridge, whose low level turns the low side on, a dead time of its own, RESET and FAULT.
 * Built and checked register by register, not run on the virtual board, which has gates. README.md
 * has the reasons, board.h the meaning of each name.
 */
#define BOARD_NAME "NUCLEO-G474RE with integrated double bridge"

/* Crystal X3 of the NUCLEO-G474RE. */
#define CRYSTAL_Hz 24000000

/* Inputs of the bridge are pulled down and FAULT is pulled up, so that nothing conducts before the
   timer drives them; RESET needs a pull-down of its own for the time of the chip's reset. */
#define BOARD_PINS(PIN)                                                                            \
    /* PWM_A...PWM_D: half-bridges A+, A-, B+, B- */                                               \
    PIN(C, 0, ALTERNATE, 2, DOWN, TIM1, CH1)                                                       \
    PIN(C, 1, ALTERNATE, 2, DOWN, TIM1, CH2)                                                       \
    PIN(C, 2, ALTERNATE, 2, DOWN, TIM1, CH3)                                                       \
    PIN(C, 3, ALTERNATE, 2, DOWN, TIM1, CH4)                                                       \
    /* FAULT, open drain; RESET_AB and RESET_CD joined, low: all half-bridges open */              \
    PIN(A, 6, ALTERNATE, 6, UP, TIM1, BKIN)                                                        \
    PIN(A, 11, OUTPUT, 0, DOWN, GPIOA, RESET)                                                      \
    /* shunts of A- and B- */                                                                      \
    PIN(A, 1, ANALOG, 0, NONE, OPAMP1, VINP0)                                                      \
    PIN(A, 7, ANALOG, 0, NONE, OPAMP2, VINP0)                                                      \
    /* leg voltages A+, A-, B+, B- */                                                              \
    PIN(B, 1, ANALOG, 0, NONE, ADC3, IN1)                                                          \
    PIN(B, 13, ANALOG, 0, NONE, ADC3, IN5)                                                         \
    PIN(B, 12, ANALOG, 0, NONE, ADC4, IN3)                                                         \
    PIN(B, 14, ANALOG, 0, NONE, ADC4, IN4)                                                         \
    /* bus voltage, temperature of the bridge */                                                   \
    PIN(B, 11, ANALOG, 0, NONE, ADC1, IN14)                                                        \
    PIN(C, 4, ANALOG, 0, NONE, ADC2, IN5)                                                          \
    /* encoder A, B, index */                                                                      \
    PIN(B, 6, ALTERNATE, 2, UP, TIM4, CH1)                                                         \
    PIN(B, 7, ALTERNATE, 2, UP, TIM4, CH2)                                                         \
    PIN(B, 9, ALTERNATE, 2, UP, TIM4, CH4)                                                         \
    /* serial line, through the debugger's virtual port */                                         \
    PIN(A, 2, ALTERNATE, 12, NONE, LPUART1, TX)                                                    \
    PIN(A, 3, ALTERNATE, 12, UP, LPUART1, RX)                                                      \
    /* CAN bus; until here the pins are JTDI and JTDO, or SWO: debugging goes by SWDIO and SWCLK   \
     */                                                                                            \
    PIN(A, 15, ALTERNATE, 11, NONE, FDCAN3, TX)                                                    \
    PIN(B, 3, ALTERNATE, 11, UP, FDCAN3, RX)                                                       \
    /* switch of the brake resistor, on while high */                                              \
    PIN(C, 6, OUTPUT, 0, DOWN, GPIOC, BRAKE)                                                       \
    /* machine: limit -, limit +, home, enable, quick stop */                                      \
    PIN(C, 8, INPUT, 0, UP, GPIOC, LIMIT_MINUS)                                                    \
    PIN(C, 9, INPUT, 0, UP, GPIOC, LIMIT_PLUS)                                                     \
    PIN(C, 10, INPUT, 0, UP, GPIOC, HOME)                                                          \
    PIN(C, 11, INPUT, 0, UP, GPIOC, ENABLE)                                                        \
    PIN(C, 12, INPUT, 0, UP, GPIOC, QUICK_STOP)                                                    \
    /* alarm, in position, holding brake */                                                        \
    PIN(A, 8, OUTPUT, 0, DOWN, GPIOA, ALARM)                                                       \
    PIN(A, 9, OUTPUT, 0, DOWN, GPIOA, IN_POSITION)                                                 \
    PIN(A, 10, OUTPUT, 0, DOWN, GPIOA, HOLDING_BRAKE)                                              \
    /* light-emitting diode LD2 */                                                                 \
    PIN(A, 5, OUTPUT, 0, NONE, GPIOA, LED)

#define BRIDGE             BRIDGE_INTEGRATED
#define BRIDGE_RESET_PORT  GPIOA
#define BRIDGE_RESET_PIN   11
#define DEAD_TIME_CYCLES   0
#define BRIDGE_DEAD_TIME_s 5e-9
/* Both conducting switches, 2 x 80 mOhm, and the 40 mOhm of a shunt. */
#define BRIDGE_RESISTANCE_OHM 0.20

#define CHANNEL_A_PLUS  1
#define CHANNEL_A_MINUS 2
#define CHANNEL_B_PLUS  3
#define CHANNEL_B_MINUS 4

/* Currents: as nucleo_g474re.h. */
#define AMPLIFIER_A        1
#define AMPLIFIER_A_INPUT  0
#define AMPLIFIER_B        2
#define AMPLIFIER_B_INPUT  0
#define AMPLIFIER_GAIN     8
#define CURRENT_A_CHANNEL  13
#define CURRENT_B_CHANNEL  16
#define CURRENT_A_PER_CODE (12.0 / 4096.0)
#define CURRENT_ZERO_CODE  2048

/* The bridge limits its current and shuts down by itself, and says so at FAULT. */
#define OVERCURRENT_COMPARATORS(COMPARATOR)

/* Voltages: as nucleo_g474re.h. */
#define LEGS_A_CONVERTER         3
#define LEG_A_PLUS_CHANNEL       1
#define LEG_A_MINUS_CHANNEL      5
#define LEGS_B_CONVERTER         4
#define LEG_B_PLUS_CHANNEL       3
#define LEG_B_MINUS_CHANNEL      4
#define PHASE_VOLTAGE_V_PER_CODE (62.4 / 4096.0)
#define BUS_CHANNEL              14
#define BUS_V_PER_CODE           (31.2 / 4096.0)
#define TEMPERATURE_CHANNEL      5
#define BRIDGE_NTC_BETA_K        3435.0 /* 10 kOhm to ground, 10 kOhm to the supply; 0: none */

#define HAS_BRAKE  1
#define BRAKE_PORT GPIOC
#define BRAKE_PIN  6

#define MACHINE_INPUTS_PORT  GPIOC
#define MACHINE_INPUTS_PIN   8
#define MACHINE_OUTPUTS_PORT GPIOA
#define MACHINE_OUTPUTS_PIN  8

#define ENCODER_TIMER         4
#define ENCODER_INDEX_CHANNEL 4

#define BAUD 921600

#define CAN_BIT_Hz 500000

#define LED_PORT GPIOA
#define LED_PIN  5
