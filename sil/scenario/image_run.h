/* A scenario on the virtual board: the image of the real board, its peripherals modelled. */
#ifndef STEADYSTEP_SCENARIO_IMAGE_RUN_H
#define STEADYSTEP_SCENARIO_IMAGE_RUN_H

#include <cstdint>
#include <string>

#include "sil/scenario/runner.h"
#include "sil/virtual_board/virtual_board.h"

namespace scenario
{

/* Throws InputError if the image cannot be what the scenario asks for. */
void check_image(const Scenario &scenario, const std::string &numeric);

struct ImageRun {
    Run run;
    virtual_board::BoardReport board;
};

/* As run_typed. What the virtual board refuses of the firmware, and a control interrupt beyond its
   budget, is the run's failure. */
ImageRun run_image(const Scenario &scenario, const std::string &numeric, std::uint64_t seed,
                   Record &record);

/* What the console shows of it. */
std::string interrupt_table(const virtual_board::BoardReport &board, double cpu_s);

} // namespace scenario

#endif
