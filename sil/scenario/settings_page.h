/* The settings of a drive as a page of Markdown, from the table that declares them. */
#ifndef STEADYSTEP_SCENARIO_SETTINGS_PAGE_H
#define STEADYSTEP_SCENARIO_SETTINGS_PAGE_H

#include <string>

namespace scenario
{

std::string settings_page();

} // namespace scenario

#endif
