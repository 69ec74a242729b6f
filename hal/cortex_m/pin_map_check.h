/* What the compiler checks of the pin maps of all ports; for the one file of a port that checks its
   own. Pins' functions are a test's (tests/board). */
#ifndef STEADYSTEP_CORTEX_M_PIN_MAP_CHECK_H
#define STEADYSTEP_CORTEX_M_PIN_MAP_CHECK_H

#include <stdint.h>

#include STEADYSTEP_PIN_MAP

#define REQUIRE(condition, text) _Static_assert(condition, "pin map: " text)

/* Words of a PIN entry. */
enum { PORT_A, PORT_B, PORT_C };
enum { IS_ANALOG_INPUT = 0, IS_ANALOG_OUTPUT = 0, IS_ANALOG_ALTERNATE = 0, IS_ANALOG_ANALOG = 1 };
enum { IS_PULLED_NONE = 0, IS_PULLED_UP = 1, IS_PULLED_DOWN = 1 };

#define BIT_OF(port, number) (UINT64_C(1) << (16 * PORT_##port + (number)))

#define OR_PIN(port, number, mode, alternate, pull, peripheral, signal)  | BIT_OF(port, number)
#define ADD_PIN(port, number, mode, alternate, pull, peripheral, signal) +BIT_OF(port, number)
REQUIRE((UINT64_C(0) BOARD_PINS(OR_PIN)) == (UINT64_C(0) BOARD_PINS(ADD_PIN)),
        "BOARD_PINS names a pin twice");

#define PULLED_ANALOG(port, number, mode, alternate, pull, peripheral, signal)                     \
    +(IS_ANALOG_##mode && IS_PULLED_##pull)
REQUIRE((0 BOARD_PINS(PULLED_ANALOG)) == 0, "an analog pin must not be pulled");

#define UNKNOWN_NUMBER(port, number, mode, alternate, pull, peripheral, signal)                    \
    +((number) < 0 || (number) > 15 || (alternate) < 0 || (alternate) > 15)
REQUIRE((0 BOARD_PINS(UNKNOWN_NUMBER)) == 0, "pins and alternate functions are numbered 0...15");

REQUIRE((1 << CHANNEL_A_PLUS | 1 << CHANNEL_A_MINUS | 1 << CHANNEL_B_PLUS | 1 << CHANNEL_B_MINUS) ==
            0x1e,
        "CHANNEL_A_PLUS...B_MINUS must be the channels 1, 2, 3 and 4 of TIM1, each once");

#if !defined HAS_BRAKE
#error pin map: HAS_BRAKE must be 1, or 0: none
#elif HAS_BRAKE && (!defined BRAKE_PORT || !defined BRAKE_PIN)
#error pin map: a brake needs BRAKE_PORT and BRAKE_PIN; HAS_BRAKE 0: none
#elif HAS_BRAKE
REQUIRE(BRAKE_PIN >= 0 && BRAKE_PIN <= 15, "BRAKE_PIN must be 0...15");
#endif

#endif
