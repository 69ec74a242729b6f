/* What CANopen puts into the frames of a CAN bus (hal.h, struct can_frame). */
#ifndef STEADYSTEP_CAN_FRAME_H
#define STEADYSTEP_CAN_FRAME_H

#include <stdint.h>
#include <string.h>

#include "hal/hal.h"

/* The bytes of a whole number as CANopen has them: the lowest first. Every core that this runs on
   keeps it so, too. */
static inline uint32_t can_get(const uint8_t *at, size_t bytes)
{
    uint32_t value = 0;

    memcpy(&value, at, bytes < sizeof value ? bytes : sizeof value); /* a real number's are eight */
    return value;
}

static inline void can_put(uint8_t *at, uint32_t value, size_t bytes)
{
    memcpy(at, &value, bytes);
}

#endif
