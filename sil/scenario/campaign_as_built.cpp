/*
 * Campaigns "as-built" and "as-built-corners": does a drive that believes its motor file and an
 * ideal board live with what is built? The runs are those of as_built_scenario.h. Held: no fault,
 * and the estimate never off by more than 45 degrees electrical from ready on. Of "as-built-loads":
 * a hold bears 0.9 of the plant's Km x rated current without a fault, and of an overload a fault
 * comes soon behind the rotor's passing half an electrical turn.
 */
#include "sil/scenario/campaign.h"

#include <cmath>

#include "sil/scenario/as_built_scenario.h"
#include "sil/scenario/displaced_rotor.h"

namespace scenario
{

namespace
{

constexpr double pi = 3.14159265358979323846;
constexpr double most_deg = 45;

/* Goes by the metrics alone. */
class AsBuilt : public CampaignWatch
{
  public:
    CampaignOutcome judge(const Result &result) const override
    {
        const Metrics &all = result.all.metrics;
        const double degrees = result.scenario->motor.params.rotor_teeth * 180 / pi;
        const double off_deg = all.estimate_error_max_rad * degrees;
        CampaignOutcome outcome;
        outcome.verdict = all.fault != "none"                  ? "fault " + all.fault
                          : !(off_deg <= most_deg)             ? "beyond 45 degrees"
                          : !result.not_as_described().empty() ? "failed"
                                                               : "held";
        outcome.figures.assign(figures_before + as_built_courses, Metrics::none);
        outcome.figures[0] = off_deg;
        outcome.figures[1] = all.position_error_max_rad;
        outcome.figures[figures_before + as_built_course(result.seed)] = off_deg;
        return outcome;
    }

  private:
    static constexpr std::size_t figures_before = 2; /* those of each course */
};

std::unique_ptr<CampaignWatch> watch_as_built(const Scenario &)
{
    return std::make_unique<AsBuilt>();
}

std::vector<CampaignFigure> figures()
{
    return {{"estimate_error_max_deg_electrical", false},
            {"position_error_max_rad", false},
            {"bendjedia_fig12_deg", false},
            {"hold_transition_deg", false},
            {"hold_transition_loaded_deg", false},
            {"standstill_load_deg", false},
            {"low_speed_deg", false},
            {"slow_crossing_deg", false},
            {"load_step_deg", false},
            {"reversal_deg", false},
            {"start_under_load_deg", false}};
}

class AsBuiltLoad : public CampaignWatch
{
  public:
    explicit AsBuiltLoad(const Scenario &scenario) : rotor_(scenario)
    {
    }

    void read(const Record &record, const Row &row) override
    {
        (void)rotor_.read(record, row);
    }

    CampaignOutcome judge(const Result &result) const override
    {
        const bool borne = as_built_load_is_borne(result.seed);
        CampaignOutcome outcome;
        outcome.figures.assign(3, Metrics::none);
        if (rotor_.shows_nothing(result)) {
            outcome.verdict = "failed";
            return outcome;
        }
        if (borne) {
            outcome.verdict = rotor_.faulted()  ? "fault " + result.all.metrics.fault
                              : rotor_.passed() ? "slipped"
                                                : "held";
            outcome.figures[2] = rotor_.largest_deg();
        } else {
            outcome.verdict = rotor_.delay_s() > most_s ? "late" : "held";
            outcome.figures[0] = rotor_.passed() ? 1 : 0;
            outcome.figures[1] = rotor_.reported_ms();
        }
        return outcome;
    }

  private:
    static constexpr double most_s = 0.1;

    DisplacedRotor rotor_;
};

std::unique_ptr<CampaignWatch> watch_as_built_load(const Scenario &scenario)
{
    return std::make_unique<AsBuiltLoad>(scenario);
}

} // namespace

const CampaignKind as_built_campaign = {
    "as-built",
    "nine courses in turns on motors and boards as built: every tolerance drawn within its bounds",
    CampaignKind::own_duration,
    figures(),
    draw_as_built,
    watch_as_built,
    false,
    true,
};

const CampaignKind as_built_corners_campaign = {
    "as-built-corners",
    "the same with every tolerance at its bound: four mixes of signs x nine courses are 36 seeds",
    CampaignKind::own_duration,
    figures(),
    draw_as_built_corner,
    watch_as_built,
    false,
    true,
    as_built_cells,
};

const CampaignKind as_built_loads_campaign = {
    "as-built-loads",
    "held rotors as built: a load that grows to 0.9 of what is borne, or an overload",
    CampaignKind::own_duration,
    {{"overloads_beyond_half_a_turn", true},
     {"overload_delay_ms", false},
     {"borne_largest_deg", false}},
    draw_as_built_load,
    watch_as_built_load,
    false,
    true,
};

} // namespace scenario
