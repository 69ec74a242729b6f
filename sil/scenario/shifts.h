/* The header of an image for one motor (firmware/numeric/coefficients.h). */
#ifndef STEADYSTEP_SCENARIO_SHIFTS_H
#define STEADYSTEP_SCENARIO_SHIFTS_H

#include <string>

#include "sil/scenario/scenario_file.h"

namespace scenario
{

/*
 * Shifts for the drive of this scenario: each coefficient has room to grow to 4.7 times and more
 * before an image with them refuses it, and 11 bits at least. Throws InputError: the drive is none
 * that an image for one motor makes faster.
 */
std::string coefficient_shifts(const Scenario &scenario);

} // namespace scenario

#endif
