/* What the image of the reference board is built for, and whether a scenario asks for anything
   else. */
#ifndef STEADYSTEP_VIRTUAL_BOARD_BOARD_FACTS_H
#define STEADYSTEP_VIRTUAL_BOARD_BOARD_FACTS_H

#include <string>

#include "firmware/interface/drive_interface.h"
#include "hal/hal.h"
#include "sil/plant/plant.h"

namespace virtual_board
{

hal_facts facts_of(const plant::Config &config);

/* Throws std::invalid_argument: "<key>: <what the scenario has>; the image has <...>". */
void require_image_facts(const plant::Config &config, const std::string &image_numeric,
                         const std::string &numeric);

/* Throws std::invalid_argument for a setting that only a simulation asks for. */
void require_image_settings(const drive_settings &settings);

} // namespace virtual_board

#endif
