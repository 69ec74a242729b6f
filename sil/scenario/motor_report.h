/* What a motor file means to the drive, for people and for tools. */
#ifndef STEADYSTEP_SCENARIO_MOTOR_REPORT_H
#define STEADYSTEP_SCENARIO_MOTOR_REPORT_H

#include <string>
#include <vector>

#include "sil/scenario/motor_file.h"

namespace scenario
{

/* The parameters, what follows from them, and what is unusual in them. */
std::string motor_report(const Motor &motor);

/* The same of several motors as a JSON array. */
std::string motors_json(const std::vector<Motor> &motors);

} // namespace scenario

#endif
