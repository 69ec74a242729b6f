/*
 * The runs of the campaign "slip", drawn at random. Even seeds try to force the rotor out of step:
 * overload, a pulse of load, a load that grows, an inertia that jumps, a jam for good or for an
 * instant, a motor unlike its file, a wrong angle at the start. Odd seeds ask for all that a drive
 * has to live with: loads of up to 0.3 N m, reversals, steps, parameters off by R and J 30 %, L and
 * Km 10 %, offsets. Torques, speeds and currents are those of the reference motor.
 */
#ifndef STEADYSTEP_SCENARIO_SLIP_SCENARIO_H
#define STEADYSTEP_SCENARIO_SLIP_SCENARIO_H

#include <cstdint>

#include "sil/scenario/campaign.h"

namespace scenario
{

bool slip_is_provoked(std::uint64_t seed);

Drawn draw_slip(std::uint64_t seed, double duration_s, const CampaignMotor &motor);

} // namespace scenario

#endif
