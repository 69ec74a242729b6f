#include "firmware/drive/prepared_input.h"

#include "firmware/drive/standstill_angle.h"

struct phases prepared_input_voltage(struct drive *drive, struct phases current)
{
    const struct phases before = drive->input.past_current;

    drive->input.past_current = current;
    return bridge_loss_voltage(&drive->params.bridge_loss, actuation_commanded(&drive->actuation),
                               before, current, drive->modulator.bus,
                               drive->modulator.bus_reciprocal);
}

void prepared_input_make(struct drive *drive, struct channels *winding)
{
    if (drive->params.path.infers_voltage) {
        winding->voltage = prepared_input_voltage(drive, winding->current);
    }
    if (standstill_pulses_blanks_sample(&drive->standstill.pulses, &drive->standstill.params)) {
        standstill_angle_blank_sample(drive, winding);
    }
}
