/*
 * Whether a motor's values go together. Ratios of two of them hardly differ from one hybrid stepper
 * to the next, from NEMA 8 to NEMA 42, so a slip of a unit (mH written as H, N cm as N m) stands
 * out. What no such motor has is refused; what hardly any has is a doubt, which is shown.
 */
#ifndef STEADYSTEP_SCENARIO_MOTOR_PLAUSIBILITY_H
#define STEADYSTEP_SCENARIO_MOTOR_PLAUSIBILITY_H

#include <string>
#include <vector>

#include "sil/scenario/motor_file.h"

namespace scenario
{

/* Throws InputError. */
void require_plausible(const Motor &motor);

/* One line each: file:line: key: what is unusual. */
std::vector<std::string> doubts_about(const Motor &motor);

/* None if the file itself says why (`unusual`). */
std::vector<std::string> unexplained_doubts_about(const Motor &motor);

} // namespace scenario

#endif
