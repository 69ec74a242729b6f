/*
 * A sweep: one scenario after another with one plant parameter off by a scale each, and a table of
 * what that does beside what a paper says.
 */
#ifndef STEADYSTEP_SCENARIO_SWEEP_H
#define STEADYSTEP_SCENARIO_SWEEP_H

#include <filesystem>
#include <string>
#include <vector>

#include "sil/scenario/result.h"

namespace scenario
{

/* One line of the table. */
struct SweepCase {
    std::string figure, parameter, paper;
    double scale = 1;
    /* Bounds on the error in the window and the position error at rest; NaN: only reported. */
    double max_rad = Metrics::none, rms_rad = Metrics::none, rest_rad = Metrics::none;
    Scenario scenario;
};

struct Sweep {
    std::string name, description;
    std::string error = "estimate"; /* the error in the window is of the estimate or the position */
    Window window;                  /* move, unless the file gives times */
    std::vector<SweepCase> cases;
};

/* Throws InputError. */
Sweep read_sweep(const Catalogue &catalogue, const std::filesystem::path &file);

/* 95th percentiles over the seeds of one case. */
struct SweepFigures {
    double max_rad, rms_rad, rest_rad, slip_full_steps;
    std::string unexpected; /* the first run's that faulted or was not as described; "": none */
    bool bounded, held;     /* nothing is held if there is such a run */
};

SweepFigures figures_of(const SweepCase &one, const std::vector<Result> &results);

std::string sweep_heading(const Sweep &sweep);
std::string sweep_line(const SweepCase &one, const SweepFigures &figures);
std::string sweep_json(const Sweep &sweep, const std::vector<SweepFigures> &figures,
                       const std::string &numeric, std::size_t seeds);

} // namespace scenario

#endif
