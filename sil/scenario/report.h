/* What the console shows of a scenario: its expectations with value, bound and verdict. */
#ifndef STEADYSTEP_SCENARIO_REPORT_H
#define STEADYSTEP_SCENARIO_REPORT_H

#include <string>
#include <vector>

#include "sil/scenario/result.h"

namespace scenario
{

struct Report {
    std::string text;
    bool passed = false;
};

/* `results`: one scenario, one numeric format, one or several seeds. */
Report report(const std::vector<Result> &results);

} // namespace scenario

#endif
