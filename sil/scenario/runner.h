/* Runs one scenario: board, timeline, record. */
#ifndef STEADYSTEP_SCENARIO_RUNNER_H
#define STEADYSTEP_SCENARIO_RUNNER_H

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sil/board/board.h"
#include "sil/board/drive_board.h"
#include "sil/scenario/incident.h"
#include "sil/scenario/record.h"
#include "sil/scenario/scenario_file.h"

namespace scenario
{

/* Powers a board up, posts what can be judged before the run, and lets it go again; throws
   InputError if the drive or the plant refuses something. */
void check(const Scenario &scenario, const firmware_image &image);

struct Run {
    double time_zero_s = 0;     /* simulated before the timeline begins */
    double enabling_time_s = 0; /* as metrics.h has it */
    double enabling_motion_max_rad = 0, enabling_displacement_rad = 0; /* magnitudes */
    std::uint64_t drive_hash = 0;
    std::string failure;             /* why the run ended early; "" if it did not */
    std::vector<Incident> incidents; /* by time; none of them judged yet */
    std::string serial;              /* transcript of the drive's serial line */
    /* Of a run whose reference creeps where the drive is blind: drive_blind_speed_rad_s. */
    std::optional<double> blind_below_rad_s;
};

/* The plant of one run. */
plant::Config plant_of(const Scenario &scenario, std::uint64_t seed);

/* The period of the rows that a scenario records. */
double row_period_s(const Scenario &scenario);

/* On the simulated board; with --typed as run_typed does. */
Run run(const Scenario &scenario, const firmware_image &image, std::uint64_t seed, Record &record);

/*
 * On any board, just powered up: every command, the first enable included, goes to the drive as a
 * typed line, early enough that it acts at its own time. Time zero is `typed_shift` periods after
 * the drive is ready, so that commands of time zero can be typed before it. After a power cycle, a
 * command that cannot be typed early enough acts as soon as it can.
 */
Run run_typed(const Scenario &scenario, sil::DriveBoard &board, Record &record);

/* A line for a planned command of time zero arrives in the first period after the ready one. */
std::uint32_t typed_shift(double control_period_s);

} // namespace scenario

#endif
