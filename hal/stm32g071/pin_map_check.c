/* What the compiler checks of a pin map of this chip. */
#include "hal/cortex_m/pin_map_check.h"

#define IS_CHANNEL(channel) ((channel) >= 0 && (channel) <= 14)
REQUIRE(IS_CHANNEL(CURRENT_A_CHANNEL) && IS_CHANNEL(CURRENT_B_CHANNEL) &&
            IS_CHANNEL(LEG_A_PLUS_CHANNEL) && IS_CHANNEL(LEG_A_MINUS_CHANNEL) &&
            IS_CHANNEL(LEG_B_PLUS_CHANNEL) && IS_CHANNEL(LEG_B_MINUS_CHANNEL) &&
            IS_CHANNEL(BUS_CHANNEL) && IS_CHANNEL(TEMPERATURE_CHANNEL),
        "the converter's sequencer knows the channels 0...14 only");
REQUIRE(CURRENT_ZERO_CODE > 0 && CURRENT_ZERO_CODE < 4096, "CURRENT_ZERO_CODE must be 1...4095");
REQUIRE(BRIDGE_RESET_PIN >= 0 && BRIDGE_RESET_PIN <= 15, "BRIDGE_RESET_PIN must be 0...15");
REQUIRE(BAUD >= 9600 && BAUD <= 921600, "BAUD must be 9600...921600");
