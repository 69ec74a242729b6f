/* What a campaign shows of its runs. */
#ifndef STEADYSTEP_SCENARIO_CAMPAIGN_REPORT_H
#define STEADYSTEP_SCENARIO_CAMPAIGN_REPORT_H

#include <string>
#include <vector>

#include "sil/scenario/campaign_journal.h"

namespace scenario
{

/* How often each verdict was given, distribution and worst seed of each figure, a command that
   repeats each run that did not hold. */
std::string campaign_report(const CampaignOrder &order, const std::vector<CampaignRun> &runs);

/* The same, with every run, on several lines. */
std::string campaign_json(const CampaignOrder &order, const std::vector<CampaignRun> &runs);

/* Shown as soon as a run ends that does not hold. */
std::string not_held_line(const CampaignOrder &order, const CampaignRun &run);

/* One line for a shell that repeats this run. */
std::string reproduce_command(const CampaignOrder &order, std::uint64_t seed);

} // namespace scenario

#endif
