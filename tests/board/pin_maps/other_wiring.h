/*
 * A pin map of no board, for tests: whatever the reference map has on one of several places that
 * the chip offers is on another here.
 */
#define BOARD_NAME "STM32G474 with another wiring"

#define CRYSTAL_Hz 0

#define BOARD_PINS(PIN)                                                                            \
    PIN(C, 0, ALTERNATE, 2, DOWN, TIM1, CH1)                                                       \
    PIN(C, 1, ALTERNATE, 2, DOWN, TIM1, CH2)                                                       \
    PIN(A, 10, ALTERNATE, 6, DOWN, TIM1, CH3)                                                      \
    PIN(C, 3, ALTERNATE, 2, DOWN, TIM1, CH4)                                                       \
    PIN(C, 13, ALTERNATE, 4, UP, TIM1, CH1N)                                                       \
    PIN(A, 12, ALTERNATE, 6, UP, TIM1, CH2N)                                                       \
    PIN(B, 9, ALTERNATE, 12, UP, TIM1, CH3N)                                                       \
    PIN(C, 5, ALTERNATE, 6, UP, TIM1, CH4N)                                                        \
    PIN(A, 1, ANALOG, 0, NONE, OPAMP1, VINP0)                                                      \
    PIN(B, 13, ANALOG, 0, NONE, OPAMP3, VINP1)                                                     \
    PIN(B, 1, ANALOG, 0, NONE, COMP1, INP1)                                                        \
    PIN(B, 11, ANALOG, 0, NONE, COMP6, INP0)                                                       \
    PIN(B, 14, ANALOG, 0, NONE, COMP7, INP0)                                                       \
    PIN(A, 8, ANALOG, 0, NONE, ADC5, IN1)                                                          \
    PIN(A, 9, ANALOG, 0, NONE, ADC5, IN2)                                                          \
    PIN(B, 12, ANALOG, 0, NONE, ADC4, IN3)                                                         \
    PIN(B, 15, ANALOG, 0, NONE, ADC4, IN5)                                                         \
    PIN(C, 2, ANALOG, 0, NONE, ADC1, IN8)                                                          \
    PIN(C, 4, ANALOG, 0, NONE, ADC2, IN5)                                                          \
    PIN(C, 6, ALTERNATE, 4, UP, TIM8, CH1)                                                         \
    PIN(C, 7, ALTERNATE, 4, UP, TIM8, CH2)                                                         \
    PIN(C, 8, ALTERNATE, 4, UP, TIM8, CH3)                                                         \
    PIN(A, 2, ALTERNATE, 12, NONE, LPUART1, TX)                                                    \
    PIN(A, 3, ALTERNATE, 12, UP, LPUART1, RX)                                                      \
    PIN(B, 2, INPUT, 0, UP, GPIOB, LIMIT_MINUS)                                                    \
    PIN(B, 3, INPUT, 0, UP, GPIOB, LIMIT_PLUS)                                                     \
    PIN(B, 4, INPUT, 0, UP, GPIOB, HOME)                                                           \
    PIN(B, 5, INPUT, 0, UP, GPIOB, ENABLE)                                                         \
    PIN(B, 6, INPUT, 0, UP, GPIOB, QUICK_STOP)                                                     \
    PIN(A, 4, OUTPUT, 0, DOWN, GPIOA, ALARM)                                                       \
    PIN(A, 5, OUTPUT, 0, DOWN, GPIOA, IN_POSITION)                                                 \
    PIN(A, 6, OUTPUT, 0, DOWN, GPIOA, HOLDING_BRAKE)                                               \
    PIN(C, 10, OUTPUT, 0, NONE, GPIOC, LED)

#define BRIDGE                BRIDGE_OF_GATES
#define LOW_GATES_ACTIVE_LOW  1
#define DEAD_TIME_CYCLES      400
#define BRIDGE_RESISTANCE_OHM 0.1

#define CHANNEL_A_PLUS  3
#define CHANNEL_A_MINUS 1
#define CHANNEL_B_PLUS  4
#define CHANNEL_B_MINUS 2

#define AMPLIFIER_A        1
#define AMPLIFIER_A_INPUT  0
#define AMPLIFIER_B        3
#define AMPLIFIER_B_INPUT  1
#define AMPLIFIER_GAIN     32
#define CURRENT_A_CHANNEL  13
#define CURRENT_B_CHANNEL  18
#define CURRENT_A_PER_CODE (30.0 / 4096.0)
#define CURRENT_ZERO_CODE  2000

#define OVERCURRENT_COMPARATORS(COMPARATOR)                                                        \
    COMPARATOR(1, 1) COMPARATOR(5, 0) COMPARATOR(6, 0) COMPARATOR(7, 0)
#define OVERCURRENT_mA      2500
#define COMPARATOR_uV       50000
#define COMPARATOR_uV_PER_A 80000

#define LEGS_A_CONVERTER         5
#define LEG_A_PLUS_CHANNEL       2
#define LEG_A_MINUS_CHANNEL      1
#define LEGS_B_CONVERTER         4
#define LEG_B_PLUS_CHANNEL       5
#define LEG_B_MINUS_CHANNEL      3
#define PHASE_VOLTAGE_V_PER_CODE (120.0 / 4096.0)
#define BUS_CHANNEL              8
#define BUS_V_PER_CODE           (60.0 / 4096.0)
#define TEMPERATURE_CHANNEL      5
#define BRIDGE_NTC_BETA_K        3950.0 /* 10 kOhm to ground, 10 kOhm to the supply; 0: none */

#define HAS_BRAKE 0

#define MACHINE_INPUTS_PORT  GPIOB
#define MACHINE_INPUTS_PIN   2
#define MACHINE_OUTPUTS_PORT GPIOA
#define MACHINE_OUTPUTS_PIN  4

#define ENCODER_TIMER         8
#define ENCODER_INDEX_CHANNEL 3

#define BAUD 115200

#define LED_PORT GPIOC
#define LED_PIN  10
