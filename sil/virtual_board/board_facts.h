/* What the image of the reference board is built for, and whether a scenario asks for anything
   else. */
#ifndef STEADYSTEP_VIRTUAL_BOARD_BOARD_FACTS_H
#define STEADYSTEP_VIRTUAL_BOARD_BOARD_FACTS_H

#include <string>

#include "firmware/interface/drive_interface.h"
#include "hal/hal.h"
#include "sil/plant/plant.h"
#include "sil/virtual_board/image_map.h"

namespace virtual_board
{

/* Of the image whose PWM timer counts so far in half a period. */
hal_facts facts_of(const plant::Config &config, int half_period_counts);

/* Throws std::invalid_argument: "<key>: <what the scenario has>; the image has <...>". */
void require_image_facts(const plant::Config &config, const ImageMap &image,
                         const std::string &numeric);

/* Throws std::invalid_argument for a setting that only a simulation asks for. */
void require_image_settings(const drive_settings &settings);

} // namespace virtual_board

#endif
