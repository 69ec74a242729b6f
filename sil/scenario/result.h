/* What came of a run, and whether that is what the scenario expects. */
#ifndef STEADYSTEP_SCENARIO_RESULT_H
#define STEADYSTEP_SCENARIO_RESULT_H

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sil/scenario/metrics.h"
#include "sil/scenario/runner.h"
#include "sil/scenario/scenario_file.h"
#include "sil/virtual_board/virtual_board.h"

namespace scenario
{

/* An expectation's metric in one run. */
struct Observation {
    double value = Metrics::none;
    std::string text; /* of `fault` */
    bool held = false;
};

struct WindowResult {
    double begin_s = Metrics::none, end_s = Metrics::none; /* of its first and last row */
    Metrics metrics;
};

struct Result {
    const Scenario *scenario = nullptr;
    std::string numeric;
    std::uint64_t seed = 1;
    std::string failure; /* why the run ended early; "" if it did not */
    WindowResult move, rest, all;
    std::vector<Observation> observations; /* one per expectation */
    std::vector<Observation> reported;     /* one per report */
    std::uint64_t trace_hash = 0, drive_hash = 0;
    double simulated_s = 0, cpu_s = 0;
    std::vector<Incident> incidents; /* by time, each judged */
    /* Of a run whose reference creeps where the drive is blind: the speed below which it is. */
    std::optional<double> blind_below_rad_s;
    std::optional<double> hold_yield_rad;            /* by how much its hold yields at most */
    std::optional<double> hold_torque_Nm;            /* lasting load that its hold bears */
    std::optional<double> hold_heat_W;               /* of the winding in it */
    std::string serial;                              /* transcript of the serial line */
    std::optional<virtual_board::BoardReport> board; /* of an image on the virtual board */

    /* It ran to its end, all bounds are held, and nothing happened that is not expected. */
    bool passed() const;
    /* Why it is not the run that the scenario describes: it ended early, or the drive refused or
       dropped a command without being expected to; "" if it is, be it in fault. */
    std::string not_as_described() const;
    /* The first fault that was not expected; nullptr: none. */
    const Incident *unexpected_fault() const;
};

/* Runs and evaluates; the readers read the record, too. */
Result execute(const Scenario &scenario, const firmware_image &image, std::uint64_t seed,
               const std::vector<RowReader *> &readers = {});

/* Which of a result's observations. */
using Observations = std::vector<Observation> Result::*;

/*
 * An expectation over several seeds: the bound must hold for the 95th percentile, which is the
 * worst run up to 19 seeds. A run without a value is the worst of all.
 */
struct Judgement {
    Observation typical; /* the 95th percentile */
    Observation worst;
    std::uint64_t worst_seed = 0;
    bool held = false;
};

Judgement judge(const Expectation &expectation, std::size_t index,
                const std::vector<Result> &results, Observations where = &Result::observations);

/* Values, ascending, NaN last: the one that 95 % do not exceed. */
double percentile_95(std::vector<double> values);

} // namespace scenario

#endif
