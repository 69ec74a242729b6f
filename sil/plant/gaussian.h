/*
 * Gaussian noise as a function of (seed, channel, period): no state, so a run can be repeated from
 * anywhere, and channels do not depend on who else is asked.
 */
#ifndef STEADYSTEP_PLANT_GAUSSIAN_H
#define STEADYSTEP_PLANT_GAUSSIAN_H

#include <cstdint>

#include "sil/plant/phases.h"

namespace plant
{

/* What seed and channel come to: constant for a run. */
std::uint64_t gaussian_key(std::uint64_t seed, std::uint64_t channel);

/* Uniform in (0, 1); of another key than the deviates. */
double uniform_number(std::uint64_t key, std::uint64_t period);

/* Two independent standard normal deviates (Box and Muller 1958). */
Phases gaussian_pair(std::uint64_t key, std::uint64_t period);

} // namespace plant

#endif
