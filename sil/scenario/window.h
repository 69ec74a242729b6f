/* A window of time as an expectation names it. */
#ifndef STEADYSTEP_SCENARIO_WINDOW_H
#define STEADYSTEP_SCENARIO_WINDOW_H

#include <cstddef>
#include <string>

namespace scenario
{

struct Window {
    /*
     * move: time zero to the end of the last profile. A step ends with the first row from which
     *       |omega| < 0.1 rad/s for 10 ms.
     * rest: what follows. all: both. times: begin_s...end_s, rounded to periods, both ends in.
     */
    enum class Kind { move, rest, all, times };

    Kind kind = Kind::all;
    double begin_s = 0, end_s = 0;

    std::string name() const; /* "move", "rest", "all" or "0.5...0.7" */
};

/* Rows first...last - 1. */
struct RowRange {
    std::size_t first = 0, last = 0;

    bool empty() const
    {
        return first >= last;
    }
};

} // namespace scenario

#endif
