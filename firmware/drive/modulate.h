/* The last blocks before the bridge: modulator and duties, and what is remembered of them. */
#ifndef STEADYSTEP_MODULATE_H
#define STEADYSTEP_MODULATE_H

#include "firmware/drive/drive.h"

/* `command`: mean phase voltages, with what the bridge takes of them if that is compensated. */
__attribute__((always_inline)) static inline struct hal_outputs modulate(struct drive *drive,
                                                                         struct phases command)
{
    const struct modulation out =
        modulator_step(&drive->modulator, &drive->params.modulator, command);
    const struct hal_outputs duties = {
        .high_counts = {out.a.plus, out.a.minus, out.b.plus, out.b.minus},
        .bridge_on = true,
    };

    actuation_commit(&drive->actuation, out.voltage);
    return duties;
}

#endif
