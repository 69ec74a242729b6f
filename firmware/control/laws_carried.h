/*
 * Which position laws an image carries. A build may name them, STEADYSTEP_LAWS: a sum of LAW_BIT;
 * without it all are there, but for what only a simulation asks for. A law that is left out keeps
 * its number in the stored record and is refused by name.
 */
#ifndef STEADYSTEP_LAWS_CARRIED_H
#define STEADYSTEP_LAWS_CARRIED_H

#include <stdbool.h>

#include "firmware/control/position_laws.h"
#include "firmware/simulation.h"

#define LAW_BIT(constant) (1u << POSITION_LAW_##constant)

#ifndef STEADYSTEP_LAWS
#define STEADYSTEP_LAWS ((1u << POSITION_LAW_COUNT) - 1u)
#endif

static inline bool position_law_is_carried(enum position_law law)
{
    return ((STEADYSTEP_LAWS) >> law & 1u) != 0u && (SERVES_SIMULATION || law != POSITION_LAW_SMC);
}

#endif
