/* What a drive has by name, as pages of Markdown, from the tables that declare it. */
#ifndef STEADYSTEP_SCENARIO_PAGES_H
#define STEADYSTEP_SCENARIO_PAGES_H

#include <string>
#include <vector>

namespace scenario
{

struct Page {
    const char *name; /* of the subcommand that writes it */
    const char *about;
    std::string (*text)();
};

const std::vector<Page> &pages();

} // namespace scenario

#endif
