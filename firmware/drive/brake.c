#include "firmware/drive/brake.h"

#include "firmware/linkage.h"

enum { HEAT_OF_PERIOD = 4096 }; /* the limit, of 30 s at 50 us, fits 32 bits */

static uint16_t bus_code(double ratio, const struct drive_settings *settings,
                         const struct hal_facts *facts)
{
    return (uint16_t)(ratio * settings->motor.supply_V / facts->bus_V_per_code + 1.0);
}

void brake_design(struct brake *brake, const struct drive_settings *settings,
                  const struct hal_facts *facts)
{
    brake->on_code = bus_code(settings->brake_on_ratio, settings, facts);
    brake->off_code =
        bus_code(settings->brake_on_ratio - settings->brake_hysteresis, settings, facts);
    brake->cooling = (uint16_t)(HEAT_OF_PERIOD * settings->brake_duty + 0.5);
    brake->heating = (uint16_t)(HEAT_OF_PERIOD - brake->cooling);
    brake->heat_limit =
        (uint32_t)(brake->heating * settings->brake_pulse_s / facts->control_period_s);
    brake->idles_below = 0; /* last: the interrupt goes on meanwhile, and then finds all of it */
}

static void heat(struct brake *brake)
{
    if (brake->on) {
        brake->heat += brake->heating;
        brake->rests = brake->heat > brake->heat_limit;
    } else {
        brake->heat -= brake->heat < brake->cooling ? brake->heat : brake->cooling;
        brake->rests = brake->rests && brake->heat > brake->heat_limit / 2u;
    }
}

CALLED_FROM_OUTSIDE bool brake_switch(struct brake *brake, uint16_t bus_code)
{
    brake->on = !brake->rests && bus_code >= (brake->on ? brake->off_code : brake->on_code);
    heat(brake);
    brake->idles_below = brake->on || brake->heat > 0u ? 0u : brake->on_code;
    return brake->on;
}
