/*
 * A campaign: many runs whose scenarios are drawn at random, each from its seed alone. A kind of
 * campaign draws the text of a scenario file, so what runs here runs by hand as well, with the same
 * hashes: `campaign KIND --seed N --write-scenario FILE`, then `run FILE`.
 */
#ifndef STEADYSTEP_SCENARIO_CAMPAIGN_H
#define STEADYSTEP_SCENARIO_CAMPAIGN_H

#include <cstdint>
#include <string>
#include <vector>

#include "sil/scenario/result.h"

namespace scenario
{

/* A figure of each run; the report shows its median, its 95th percentile and its worst. */
struct CampaignFigure {
    const char *name; /* with the unit, as metrics have it */
    bool counted;     /* the report adds it up over all runs instead: lost steps */
};

/* What came of one run. */
struct CampaignOutcome {
    std::string verdict; /* "held", or what went wrong in a few words; the report counts each */
    std::vector<double> figures; /* as the kind lists them; NaN: none in this run */

    bool held() const
    {
        return verdict == "held";
    }
};

struct CampaignKind {
    const char *name, *description;
    double duration_s; /* of one run, unless told */
    std::vector<CampaignFigure> figures;
    /* Text of the seed's scenario file; the same on every machine (random_scenario.h). */
    std::string (*draw)(std::uint64_t seed, double duration_s);
    CampaignOutcome (*judge)(const Result &result, const Record &record);
};

/* All kinds. A new one is a source of its own and a line in campaign.cpp. */
const std::vector<const CampaignKind *> &campaign_kinds();

extern const CampaignKind long_run_campaign; /* campaign_long_run.cpp */
extern const CampaignKind slip_campaign;     /* campaign_slip.cpp */

struct CampaignOrder {
    const CampaignKind *kind = nullptr;
    double duration_s = 0;
    std::uint64_t first_seed = 1, seeds = 1;
    std::string numeric = "float";
    CommandLine given; /* laid over every drawn scenario */
    std::string out;   /* folder that keeps a line per finished run; "": none */
    unsigned jobs = 1;
    bool json = false;
};

/* The scenario that a seed draws; throws InputError. */
Scenario drawn_scenario(const Catalogue &catalogue, const CampaignOrder &order, std::uint64_t seed);

/*
 * Runs the order and prints its report, or JSON. Runs that `out` holds already, of the same
 * program, scenario and settings, are taken from there. Returns whether all runs held; throws
 * InputError.
 */
bool run_campaign(const Catalogue &catalogue, const CampaignOrder &order);

} // namespace scenario

#endif
