/*
 * The runs of the campaigns "as-built" and "as-built-corners": nine courses of motion, rest and
 * load, on the plant `as-built` with tolerances drawn uniformly, or all at their bounds. Numbers
 * are those of bendjedia-2012; those of another motor go with its ratings, and where it accelerates
 * more slowly the whole course does. And that of "as-built-loads": a held rotor, whose load grows.
 */
#ifndef STEADYSTEP_SCENARIO_AS_BUILT_SCENARIO_H
#define STEADYSTEP_SCENARIO_AS_BUILT_SCENARIO_H

#include <cstdint>

#include "sil/scenario/campaign.h"

namespace scenario
{

constexpr std::size_t as_built_courses = 9;
constexpr std::uint64_t as_built_cells = 36; /* of four corners */

/* Names of the courses, those of the scenarios that they are taken from. */
extern const char *const as_built_course_names[as_built_courses];

std::size_t as_built_course(std::uint64_t seed); /* seeds 1, 2, 3... take them in turns */

/* Tolerances within their bounds, by the seed. */
Drawn draw_as_built(std::uint64_t seed, double duration_s, const CampaignMotor &motor);

/* All at their bounds: seeds 1...9 are the courses of the first of four mixes of signs, and so on;
   37 is 1 with other noise. */
Drawn draw_as_built_corner(std::uint64_t seed, double duration_s, const CampaignMotor &motor);

/* At rest on such parts: a load that grows by 0.05...5 N m/s to what even seeds bear, or to an
   overload. */
Drawn draw_as_built_load(std::uint64_t seed, double duration_s, const CampaignMotor &motor);

bool as_built_load_is_borne(std::uint64_t seed);

} // namespace scenario

#endif
