/* The header of an image for one motor (firmware/numeric/coefficients.h). */
#ifndef STEADYSTEP_SCENARIO_SHIFTS_H
#define STEADYSTEP_SCENARIO_SHIFTS_H

#include <string>

#include "sil/scenario/scenario_file.h"

namespace scenario
{

/*
 * Shifts for the drive of this scenario: each coefficient has room to grow to 2.3 times and more
 * before an image with them refuses it, a law's to 4 times, and 12 bits at least. Throws
 * InputError: the drive is none that an image for one motor makes faster.
 */
std::string coefficient_shifts(const Scenario &scenario);

} // namespace scenario

#endif
