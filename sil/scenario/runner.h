/* Runs one scenario: board, timeline, record. */
#ifndef STEADYSTEP_SCENARIO_RUNNER_H
#define STEADYSTEP_SCENARIO_RUNNER_H

#include <cstdint>
#include <string>

#include "sil/board/board.h"
#include "sil/scenario/record.h"
#include "sil/scenario/scenario_file.h"

namespace scenario
{

/* The image of "float", "fixed" or "double"; nullptr: no such format. */
const firmware_image *image_of(const std::string &numeric);

/* Powers a board up, posts the commands and lets it go again; throws InputError if the drive or the
   plant refuses something. */
void check(const Scenario &scenario, const firmware_image &image);

struct Run {
    Record record;
    double enabling_time_s = 0;
    std::uint64_t drive_hash = 0;
    std::string failure; /* why the run ended early; "" if it did not */
};

Run run(const Scenario &scenario, const firmware_image &image, std::uint64_t seed);

} // namespace scenario

#endif
