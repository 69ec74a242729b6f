/* What the compiler checks of a pin map of this chip. */
#include "hal/cortex_m/pin_map_check.h"
#include "hal/stm32g474/board.h"

/* ---- Clock ---- */
REQUIRE(CRYSTAL_Hz == 0 ||
            (CRYSTAL_Hz >= 4000000 && CRYSTAL_Hz <= 48000000 && CRYSTAL_Hz % 4000000 == 0),
        "CRYSTAL_Hz must be 0 (none) or a whole multiple of 4 MHz up to 48 MHz");

/* ---- Bridge ---- */
REQUIRE(BRIDGE == BRIDGE_OF_GATES || BRIDGE == BRIDGE_INTEGRATED,
        "BRIDGE must be BRIDGE_OF_GATES or BRIDGE_INTEGRATED");
REQUIRE((HIGH_GATES_ACTIVE_LOW == 0 || HIGH_GATES_ACTIVE_LOW == 1) &&
            (LOW_GATES_ACTIVE_LOW == 0 || LOW_GATES_ACTIVE_LOW == 1),
        "HIGH_GATES_ACTIVE_LOW and LOW_GATES_ACTIVE_LOW must be 0 or 1");
REQUIRE(BRIDGE == BRIDGE_OF_GATES || (HIGH_GATES_ACTIVE_LOW == 0 && LOW_GATES_ACTIVE_LOW == 0),
        "an integrated bridge has no gates: HIGH_GATES_ACTIVE_LOW is for a bridge of gates");
#if BRIDGE == BRIDGE_OF_GATES
REQUIRE(DEAD_TIME_CYCLES >= 64,
        "a bridge of gates needs a dead time: DEAD_TIME_CYCLES of 64 (0.38 us) at least");
REQUIRE(DEAD_TIME_CYCLES <= 127 || (DEAD_TIME_CYCLES <= 254 && DEAD_TIME_CYCLES % 2 == 0) ||
            (DEAD_TIME_CYCLES >= 256 && DEAD_TIME_CYCLES <= 504 && DEAD_TIME_CYCLES % 8 == 0),
        "TIM1 cannot count DEAD_TIME_CYCLES: up to 127; even up to 254; multiples of 8 up to 504");
REQUIRE(OVERCURRENT_INPUTS >= 4,
        "a bridge of gates needs a comparator on the shunt of every leg (OVERCURRENT_COMPARATORS)");
#elif !defined BRIDGE_RESET_PORT || !defined BRIDGE_RESET_PIN || !defined BRIDGE_DEAD_TIME_s
#error pin map: an integrated bridge needs BRIDGE_RESET_PORT, BRIDGE_RESET_PIN, BRIDGE_DEAD_TIME_s
#else
REQUIRE(DEAD_TIME_CYCLES == 0,
        "an integrated bridge has its own dead time: DEAD_TIME_CYCLES must be 0");
REQUIRE(BRIDGE_RESET_PIN >= 0 && BRIDGE_RESET_PIN <= 15, "BRIDGE_RESET_PIN must be 0...15");
#endif

/* ---- Currents ---- */
REQUIRE(AMPLIFIER_A == 0 || (AMPLIFIER_A == 1 && CURRENT_A_CHANNEL == 13),
        "ADC1, which converts phase a, sees OPAMP1 alone, on CURRENT_A_CHANNEL 13");
REQUIRE(AMPLIFIER_B == 0 || (AMPLIFIER_B == 2 && CURRENT_B_CHANNEL == 16) ||
            (AMPLIFIER_B == 3 && CURRENT_B_CHANNEL == 18),
        "ADC2, which converts phase b, sees OPAMP2 on CURRENT_B_CHANNEL 16, OPAMP3 on 18");
REQUIRE(AMPLIFIER_A_INPUT >= 0 && AMPLIFIER_A_INPUT <= 2 && AMPLIFIER_B_INPUT >= 0 &&
            AMPLIFIER_B_INPUT <= 2,
        "AMPLIFIER_A_INPUT and AMPLIFIER_B_INPUT must be 0, 1 or 2 (VINP0...VINP2)");
REQUIRE(AMPLIFIER_GAIN == 2 || AMPLIFIER_GAIN == 4 || AMPLIFIER_GAIN == 8 || AMPLIFIER_GAIN == 16 ||
            AMPLIFIER_GAIN == 32 || AMPLIFIER_GAIN == 64,
        "AMPLIFIER_GAIN must be 2, 4, 8, 16, 32 or 64");
REQUIRE(CURRENT_ZERO_CODE > 0 && CURRENT_ZERO_CODE < 4096, "CURRENT_ZERO_CODE must be 1...4095");
#define IS_CHANNEL(channel) ((channel) >= 1 && (channel) <= 18)
REQUIRE(IS_CHANNEL(CURRENT_A_CHANNEL) && IS_CHANNEL(CURRENT_B_CHANNEL) && IS_CHANNEL(BUS_CHANNEL) &&
            IS_CHANNEL(TEMPERATURE_CHANNEL),
        "channels of ADC1 and ADC2 are 1...18");
REQUIRE(CURRENT_A_CHANNEL != BUS_CHANNEL, "ADC1 converts current a and bus: two channels");
REQUIRE(CURRENT_B_CHANNEL != TEMPERATURE_CHANNEL,
        "ADC2 converts current b and temperature: two channels");

/* ---- Trip ---- */
#define UNKNOWN_COMPARATOR(number, input)                                                          \
    +((number) < 1 || (number) > 7 || (input) < 0 || (input) > 1)
#define OR_COMPARATOR(number, input)  | 1 << (number)
#define ADD_COMPARATOR(number, input) +(1 << (number))
REQUIRE((0 OVERCURRENT_COMPARATORS(UNKNOWN_COMPARATOR)) == 0,
        "OVERCURRENT_COMPARATORS: COMPARATOR(1...7, input 0 or 1)");
REQUIRE((0 OVERCURRENT_COMPARATORS(OR_COMPARATOR)) == (0 OVERCURRENT_COMPARATORS(ADD_COMPARATOR)),
        "OVERCURRENT_COMPARATORS names a comparator twice");
#if defined OVERCURRENT_mA
REQUIRE(OVERCURRENT_CODE > 0 && OVERCURRENT_CODE < 4096,
        "OVERCURRENT_mA is beyond what the comparators' reference of 3.3 V reaches");
#else
REQUIRE(OVERCURRENT_INPUTS == 0, "comparators need OVERCURRENT_mA and their network");
#endif

/* ---- Voltages ---- */
#define IS_LEG_CONVERTER(number) ((number) >= 3 && (number) <= 5)
REQUIRE(IS_LEG_CONVERTER(LEGS_A_CONVERTER) && IS_LEG_CONVERTER(LEGS_B_CONVERTER) &&
            LEGS_A_CONVERTER != LEGS_B_CONVERTER,
        "LEGS_A_CONVERTER and LEGS_B_CONVERTER must be two of 3, 4 and 5 (ADC3, ADC4, ADC5)");
REQUIRE(IS_CHANNEL(LEG_A_PLUS_CHANNEL) && IS_CHANNEL(LEG_A_MINUS_CHANNEL) &&
            IS_CHANNEL(LEG_B_PLUS_CHANNEL) && IS_CHANNEL(LEG_B_MINUS_CHANNEL) &&
            LEG_A_PLUS_CHANNEL != LEG_A_MINUS_CHANNEL && LEG_B_PLUS_CHANNEL != LEG_B_MINUS_CHANNEL,
        "the legs of a phase need two channels, 1...18, of its converter");

/* ---- Machine ---- */
#if !defined MACHINE_INPUTS_PORT || !defined MACHINE_INPUTS_PIN ||                                 \
    !defined MACHINE_OUTPUTS_PORT || !defined MACHINE_OUTPUTS_PIN
#error pin map: the machine needs MACHINE_INPUTS_PORT, _PIN, MACHINE_OUTPUTS_PORT, _PIN
#else
REQUIRE(MACHINE_INPUTS_PIN >= 0 && MACHINE_INPUTS_PIN <= 11 && MACHINE_OUTPUTS_PIN >= 0 &&
            MACHINE_OUTPUTS_PIN <= 13,
        "MACHINE_INPUTS_PIN is the first of five of its port, MACHINE_OUTPUTS_PIN of three");
#endif

/* ---- Encoder, serial line ---- */
REQUIRE(ENCODER_TIMER == 0 || ENCODER_TIMER == 4 || ENCODER_TIMER == 5 || ENCODER_TIMER == 8,
        "ENCODER_TIMER must be 4, 5 or 8 (TIM4, TIM5, TIM8), or 0: none");
REQUIRE(ENCODER_INDEX_CHANNEL == 0 ||
            (ENCODER_TIMER != 0 && (ENCODER_INDEX_CHANNEL == 3 || ENCODER_INDEX_CHANNEL == 4)),
        "ENCODER_INDEX_CHANNEL must be 3 or 4, of ENCODER_TIMER, or 0: none");
REQUIRE(ENCODER_TIMER != 0 || ENCODER_COUNTS_PER_TURN == 0,
        "the build names an encoder (STEADYSTEP_ENCODER_COUNTS), the map of none");
REQUIRE(BAUD >= 9600 && BAUD <= 3000000, "BAUD must be 9600...3000000");

/* ---- CAN ---- */
REQUIRE(CAN_BIT_Hz == 0 || CAN_BIT_Hz == 125000 || CAN_BIT_Hz == 250000 || CAN_BIT_Hz == 500000 ||
            CAN_BIT_Hz == 1000000,
        "CAN_BIT_Hz must be 125000, 250000, 500000 or 1000000, or 0: no CAN bus");
_Static_assert(CORE_Hz % CAN_PRESCALER == 0 &&
                   CAN_QUANTA * CAN_BIT_Hz == (CAN_BIT_Hz > 0 ? CAN_QUANTUM_Hz : 0),
               "quanta of the CAN bus make whole bits");
_Static_assert(CAN_BIT_Hz == 0 || (8 * (CAN_QUANTA - CAN_SEGMENT_2) <= 7 * CAN_QUANTA &&
                                   4 * (CAN_QUANTA - CAN_SEGMENT_2) >= 3 * CAN_QUANTA),
               "the sample point is at 75...87.5 % of a bit");
