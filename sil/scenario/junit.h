/* Verdicts as JUnit XML, which CI servers show: a test case per scenario, seed and number format.
 */
#ifndef STEADYSTEP_SCENARIO_JUNIT_H
#define STEADYSTEP_SCENARIO_JUNIT_H

#include <string>
#include <vector>

#include "sil/scenario/result.h"

namespace scenario
{

/*
 * `results`: all seeds of one scenario after another. A case fails where its run is not the one
 * that was described, and where its figure breaks a bound that the seeds together do not hold.
 */
std::string junit_xml(const std::vector<std::vector<Result>> &scenarios);

} // namespace scenario

#endif
