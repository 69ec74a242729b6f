/* What a drive has by number, for a fieldbus. */
#ifndef STEADYSTEP_SCENARIO_EDS_H
#define STEADYSTEP_SCENARIO_EDS_H

#include <string>

namespace scenario
{

/* Settings, commands, signals and mandatory objects in the form of CiA 306. */
std::string electronic_data_sheet();

} // namespace scenario

#endif
