/* Which settings only a simulation asks for (firmware/simulation.h). */
#ifndef STEADYSTEP_SIMULATION_ONLY_H
#define STEADYSTEP_SIMULATION_ONLY_H

#include "firmware/interface/drive_interface.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The first of them that is set, as "name = value"; NULL: none is. */
const char *simulation_only_setting(const struct drive_settings *settings);

#ifdef __cplusplus
}
#endif

#endif
