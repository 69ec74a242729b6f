/*
 * Pin map: NUCLEO-G474RE with a double H-bridge of discrete MOSFETs, a shunt and a comparator under
 * every leg, a filtered divider on every leg. README.md has the schematic-level reasons; board.h
 * says what each name means and which values the chip permits.
 */
#define BOARD_NAME "NUCLEO-G474RE with discrete double H-bridge"

/* Crystal X3 of the NUCLEO-G474RE. */
#define CRYSTAL_Hz 24000000

/* Inputs of gate drivers are pulled down, so that nothing conducts before the timer drives them;
   the driver's own pull-down does the same while the chip is in reset. The encoder's inputs are
   pulled up for open-collector encoders. */
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
    /* shunts: A- and B- measured and compared (COMP1, COMP2), A+ and B+ compared */               \
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

/* Bridge: two gates a leg, dead time from the timer: 1 us. */
#define BRIDGE           BRIDGE_OF_GATES
#define DEAD_TIME_CYCLES 170
/* The hold at enabling measures the bridge's resistance with the motor's. */
#define BRIDGE_RESISTANCE_OHM 0.0

#define CHANNEL_A_PLUS  1
#define CHANNEL_A_MINUS 2
#define CHANNEL_B_PLUS  3
#define CHANNEL_B_MINUS 4

/*
 * Currents: 40 mOhm; the divider in front of the amplifier passes 0.859 of it and adds 206 mV, the
 * amplifier's gain is 8: 1.65 V + 0.275 V/A, 12 A over 4096 codes.
 */
#define AMPLIFIER_A        1
#define AMPLIFIER_A_INPUT  0
#define AMPLIFIER_B        2
#define AMPLIFIER_B_INPUT  0
#define AMPLIFIER_GAIN     8
#define CURRENT_A_CHANNEL  13
#define CURRENT_B_CHANNEL  16
#define CURRENT_A_PER_CODE (12.0 / 4096.0)
#define CURRENT_ZERO_CODE  2048

/* Trip at 7.0 A through a low side: 206.3 mV + 7.0 A x 34.4 mV/A at the comparators. */
#define OVERCURRENT_COMPARATORS(COMPARATOR)                                                        \
    COMPARATOR(1, 0) COMPARATOR(2, 0) COMPARATOR(3, 0) COMPARATOR(4, 0)
#define OVERCURRENT_mA      7000
#define COMPARATOR_uV       206300
#define COMPARATOR_uV_PER_A 34400

/* Voltages: dividers of the bus and, beside a bias of 256 codes that cancels, of the legs; one code
   of the difference of two legs is two of a leg. */
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
