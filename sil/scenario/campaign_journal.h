/* What a campaign has finished: in memory, and a line of JSON per run in its folder. */
#ifndef STEADYSTEP_SCENARIO_CAMPAIGN_JOURNAL_H
#define STEADYSTEP_SCENARIO_CAMPAIGN_JOURNAL_H

#include <cstdint>
#include <map>
#include <string>

#include "sil/scenario/campaign.h"

namespace scenario
{

struct CampaignRun {
    std::uint64_t seed = 0;
    CampaignOutcome outcome;
    std::string failure; /* why the run ended early; "" if it did not */
    std::uint64_t trace_hash = 0, drive_hash = 0;
    double simulated_s = 0;
};

class CampaignJournal
{
  public:
    /* Reads the runs of the order that its folder holds; a line of another program, duration,
       number format or setting, and a last line that was cut off, count for nothing. Throws
       InputError. */
    CampaignJournal(const Catalogue &catalogue, const CampaignOrder &order);

    const CampaignRun *find(std::uint64_t seed) const; /* nullptr: has not run */
    void add(const CampaignRun &run);                  /* throws InputError if it cannot be kept */

    /* Of its files, without their ends: "long-run-float". */
    std::string name() const;
    std::string file() const;

  private:
    const CampaignOrder &order_;
    std::string condition_;
    std::map<std::uint64_t, CampaignRun> runs_;
    bool cut_off_ = false; /* the file's last line has no end yet */
};

} // namespace scenario

#endif
