/*
 * Pin map: NUCLEO-G071RB with an integrated double bridge (DRV8412 class), one PWM input per
 * half-bridge. README.md has the schematic-level reasons; board.h says what each name means.
 */
#define BOARD_NAME "NUCLEO-G071RB with integrated double bridge"

/* Inputs of the bridge are pulled down and FAULT is pulled up, so that nothing conducts before the
   timer drives them. */
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
    /* switch of the brake resistor, on while high */                                              \
    PIN(C, 6, OUTPUT, 0, DOWN, GPIOC, BRAKE)                                                       \
    /* light-emitting diode LD4, not driven yet */                                                 \
    PIN(A, 5, OUTPUT, 0, NONE, GPIOA, LED)

#define CHANNEL_A_PLUS  1
#define CHANNEL_A_MINUS 2
#define CHANNEL_B_PLUS  3
#define CHANNEL_B_MINUS 4

#define BRIDGE_RESET_PORT GPIOB
#define BRIDGE_RESET_PIN  13
/* Of the bridge itself. */
#define BRIDGE_DEAD_TIME_s 5e-9
/* Both conducting switches, 2 x 80 mOhm, and the 20 mOhm of a shunt. */
#define BRIDGE_RESISTANCE_OHM 0.18

/*
 * 20 mOhm, amplified 13.75 times about 1.65 V: 1.65 V + 0.275 V/A, 12 A over 4096 codes. A positive
 * current flows through the motor from leg plus to leg minus, and while all low sides conduct, down
 * the shunt of leg minus and up that of leg plus: so the shunts are those of A- and B-.
 */
#define CURRENT_A_CHANNEL  0
#define CURRENT_B_CHANNEL  1
#define CURRENT_A_PER_CODE (12.0 / 4096.0)
#define CURRENT_ZERO_CODE  2048

/* Dividers of the supply and of the legs: 17.8 kOhm over 2.10 kOhm, 31.2 V over 4096 codes. One
   code of the difference of two legs is two of a leg. */
#define LEG_A_PLUS_CHANNEL       4
#define LEG_A_MINUS_CHANNEL      7
#define LEG_B_PLUS_CHANNEL       8
#define LEG_B_MINUS_CHANNEL      9
#define PHASE_VOLTAGE_V_PER_CODE (62.4 / 4096.0)
#define BUS_CHANNEL              10
#define BUS_V_PER_CODE           (31.2 / 4096.0)
#define TEMPERATURE_CHANNEL      11
#define BRIDGE_NTC_BETA_K        3435.0 /* 10 kOhm to ground, 10 kOhm to the supply; 0: none */

#define HAS_BRAKE  1
#define BRAKE_PORT GPIOC
#define BRAKE_PIN  6

/*
 * 115200 and not more: in double precision without FPU the background plans for some 10 ms, in
 * which the receive buffer must hold what comes.
 */
#define BAUD 115200
