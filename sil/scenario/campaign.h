/*
 * A campaign: many runs whose scenarios are drawn at random, each from its seed alone. A kind of
 * campaign draws the text of a scenario file, so what runs here runs by hand as well, with the same
 * hashes: `campaign KIND --seed N --write-scenario FILE`, then `run FILE`. Numbers of a kind are
 * those of the reference motor bendjedia-2012; for another they go with its ratings (ratings.h).
 */
#ifndef STEADYSTEP_SCENARIO_CAMPAIGN_H
#define STEADYSTEP_SCENARIO_CAMPAIGN_H

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sil/scenario/ratings.h"
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
    bool refused() const
    {
        return verdict.rfind("refused", 0) == 0;
    }
    bool within_limit() const /* not held, but no worse than what is computed of the motor */
    {
        return verdict == "within its computed limit";
    }
    bool accounted_for() const
    {
        return held() || refused() || within_limit();
    }
};

/* The motor that scenarios are drawn for. */
struct CampaignMotor {
    std::string name = "bendjedia-2012"; /* or a path, as a scenario gives it */
    RatingScales scales;                 /* of its ratings to that motor's */
    double spread = 1;                   /* of tolerances, relative to what a kind draws */
};

/* What a seed draws: texts of files. */
struct Drawn {
    std::string scenario;
    std::string motor_id, motor; /* of its own motor, if it draws one: text of <motor_id>.toml,
                                    which the scenario expects beside itself; else "" */
};

/* When something happens for the first time in a run. */
struct First {
    static constexpr std::size_t none = static_cast<std::size_t>(-1);

    std::size_t row = none;
    double time_s = 0;

    bool came() const
    {
        return row != none;
    }
    void note(const Record &record, bool happens)
    {
        if (!came() && happens) {
            row = record.rows();
            time_s = record.time_s(row);
        }
    }
};

/* Sees a run of a campaign as it goes, and judges it when it has ended. */
class CampaignWatch : public RowReader
{
  public:
    void read(const Record &, const Row &) override
    {
    }
    virtual CampaignOutcome judge(const Result &result) const = 0;
};

struct CampaignKind {
    const char *name, *description;
    static constexpr double own_duration = 0;
    double duration_s; /* of one run, unless given; own_duration: each run has its own */
    std::vector<CampaignFigure> figures;
    /* The same on every machine (random_scenario.h). */
    Drawn (*draw)(std::uint64_t seed, double duration_s, const CampaignMotor &motor);
    std::unique_ptr<CampaignWatch> (*watch)(const Scenario &scenario);
    bool draws_motor = false; /* then a refusal by the drive is a verdict, not bad input */
    bool has_bounds = false;  /* of tolerances, which --stretch doubles */
    std::uint64_t seeds = 1;  /* from 1 on, unless given */
};

/* All kinds. A new one is a source of its own and a line in campaign.cpp. */
const std::vector<const CampaignKind *> &campaign_kinds();

extern const CampaignKind long_run_campaign;                            /* campaign_long_run.cpp */
extern const CampaignKind slip_campaign;                                /* campaign_slip.cpp */
extern const CampaignKind load_campaign;                                /* campaign_load.cpp */
extern const CampaignKind as_built_campaign, as_built_corners_campaign, /* campaign_as_built.cpp */
    as_built_loads_campaign;
extern const CampaignKind motors_campaign, any_motors_campaign; /* campaign_motors.cpp */

struct CampaignOrder {
    const CampaignKind *kind = nullptr;
    double duration_s = 0;
    std::uint64_t first_seed = 1, seeds = 1;
    std::string numeric = "float";
    CommandLine given; /* laid over every drawn scenario */
    CampaignMotor motor;
    std::string out; /* folder that keeps a line per finished run; "": none */
    unsigned jobs = 1;
    bool json = false;
};

/* The motor that --set motor= names, or the reference motor; throws InputError, also where a kind
   that draws its motors is given one. */
CampaignMotor campaign_motor(const Catalogue &catalogue, const CampaignKind &kind,
                             const CommandLine &given);

/* Writes the order's first seed as a scenario, and its motor beside it; throws InputError. */
void write_drawn(const CampaignOrder &order, const std::string &file);

/* The scenario that a seed draws; throws InputError. */
Scenario drawn_scenario(const Catalogue &catalogue, const CampaignOrder &order, std::uint64_t seed);

/*
 * Runs the order and prints its report, or JSON. Runs that `out` holds already, of the same
 * program, scenario and settings, are taken from there. Returns whether all runs held; throws
 * InputError. Where motors are drawn, a run that is refused or keeps to its computed limit does not
 * count against it.
 */
bool run_campaign(const Catalogue &catalogue, const CampaignOrder &order);

} // namespace scenario

#endif
