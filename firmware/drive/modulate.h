/* The last blocks before the bridge: modulator and duties, and what is remembered of them. */
#ifndef STEADYSTEP_MODULATE_H
#define STEADYSTEP_MODULATE_H

#include "firmware/drive/drive.h"

/* `command`: mean phase voltages, with what the bridge takes of them if that is compensated. */
__attribute__((always_inline)) static inline void
modulate(struct drive *drive, struct phases command, struct hal_outputs *outputs)
{
    const struct modulation out =
        modulator_step(&drive->modulator, &drive->params.modulator, command);

    outputs->high_counts[HAL_LEG_A_PLUS] = (uint16_t)out.a.plus;
    outputs->high_counts[HAL_LEG_A_MINUS] = (uint16_t)out.a.minus;
    outputs->high_counts[HAL_LEG_B_PLUS] = (uint16_t)out.b.plus;
    outputs->high_counts[HAL_LEG_B_MINUS] = (uint16_t)out.b.minus;
    outputs->bridge_on = true;
    actuation_commit(&drive->actuation, out.voltage);
}

#endif
