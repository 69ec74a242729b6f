/* What a drive has by name and number, for programs: the tables of firmware/interface, and the
   motors of the library as their settings. */
#ifndef STEADYSTEP_SCENARIO_DICTIONARY_JSON_H
#define STEADYSTEP_SCENARIO_DICTIONARY_JSON_H

#include <string>
#include <vector>

#include "sil/scenario/motor_file.h"

namespace scenario
{

std::string dictionary_json(const std::vector<Motor> &motors);

} // namespace scenario

#endif
