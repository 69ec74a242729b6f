/* The number formats of the firmware in this program, each with its image. */
#ifndef STEADYSTEP_SCENARIO_NUMBER_FORMATS_H
#define STEADYSTEP_SCENARIO_NUMBER_FORMATS_H

#include <string>
#include <vector>

#include "hal/sil/firmware_image.h"

namespace scenario
{

/* Their names. */
const std::vector<std::string> &number_formats();

/* nullptr: no such format. */
const firmware_image *image_of(const std::string &numeric);

} // namespace scenario

#endif
