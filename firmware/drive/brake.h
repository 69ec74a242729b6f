/*
 * The brake resistor's switch: what a motor returns when it is slowed down lifts the bus, as no
 * supply takes it back.
 *
 *   on from brake_on_ratio x supply_V, off below brake_hysteresis x supply_V less
 *
 * and the resistor is kept from burning. Heat is counted in periods on, less brake_duty of all
 * periods. Where that reaches what brake_pulse_s on without a pause are, the resistor rests until
 * half of it is gone; the bus then rises until the protection opens the bridge.
 *
 * A board with such a switch asks in every control interrupt, whatever the state of the drive, and
 * behind the duties: a bridge that is off has diodes, too, and the motor may still turn.
 */
#ifndef STEADYSTEP_BRAKE_H
#define STEADYSTEP_BRAKE_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/interface/drive_interface.h"
#include "firmware/rare.h"
#include "hal/hal.h"

struct brake {
    uint16_t idles_below; /* this bus code; 0: not at all, as it is on or hot */
    uint16_t on_code, off_code;
    uint16_t heating, cooling; /* of a period on and off */
    bool on;
    bool rests; /* the resistor has reached its limit */
    uint32_t heat, heat_limit;
};

/* Background: by settings and board, of a drive whose bridge is off; what is hot stays so. */
void brake_design(struct brake *brake, const struct drive_settings *settings,
                  const struct hal_facts *facts);

/* The control interrupt of a board that has a brake asks these two, in this order, once a period.
 */

/* Off, as it is: nothing is to be done. */
static inline bool brake_idles(const struct brake *brake, uint16_t bus_code)
{
    return !RARE(bus_code >= brake->idles_below);
}

/* If it does not idle: whether it is to be on. */
bool brake_switch(struct brake *brake, uint16_t bus_code);

#endif
