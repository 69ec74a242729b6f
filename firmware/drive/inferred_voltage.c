#include "firmware/drive/inferred_voltage.h"

struct phases inferred_voltage(struct drive *drive, struct phases current)
{
    const struct phases before = drive->past_current;

    drive->past_current = current;
    return bridge_loss_voltage(&drive->params.bridge_loss, drive->actuation.past, before, current,
                               drive->modulator.bus, drive->modulator.bus_reciprocal);
}
