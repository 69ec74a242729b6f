/*
 * Campaign "slip": is every loss of synchronism reported, and none that is not one? The runs are
 * those of slip_scenario.h.
 *
 * A slip begins where the estimate is 90 degrees electrical off. It is reported by any fault or,
 * with the policy `warn`, by a warning of a loss, or of a stall that stands 20 ms later; missed:
 * none has come by then. False alarm: a loss of synchronism, fault or warning, with less than 45
 * degrees throughout the 100 ms before it. Only these claim a slip.
 */
#include "sil/scenario/campaign.h"

#include <algorithm>
#include <cmath>

#include "sil/scenario/slip_scenario.h"

namespace scenario
{

namespace
{

constexpr double pi = 3.14159265358979323846;
constexpr double latest_s = 0.02; /* behind a slip, for it to be reported */

/* Up to the fault, if one comes. */
class SlipWatch : public CampaignWatch
{
  public:
    explicit SlipWatch(const Scenario &scenario)
        : degrees_(scenario.motor.params.rotor_teeth * 180 / pi),
          off_deg_(1 + static_cast<std::size_t>(
                           std::floor(before_loss_s / row_period_s(scenario) + 0.5)))
    {
    }

    void read(const Record &record, const Row &row) override
    {
        last_s_ = record.time_s(record.rows());
        if (record.rows() < record.time_zero_row() || fault_.came()) {
            return;
        }
        const auto synchronism = static_cast<drive_synchronism>(row[SYNCHRONISM]);
        const bool fault = row[DRIVE_STATE] == double(DRIVE_FAULT);
        const double off_deg = std::fabs(row[THETA] - row[THETA_EST]) * degrees_;
        off_deg_[record.rows() % off_deg_.size()] = off_deg;
        fault_.note(record, fault);
        slip_.note(record, !fault && off_deg > 90);
        doubt_.note(record, synchronism > DRIVE_SYNCHRONISM_SURE);
        stalled_.note(record, synchronism == DRIVE_SYNCHRONISM_STALLED);
        if (!lost_.came() && synchronism == DRIVE_SYNCHRONISM_LOST) {
            lost_.note(record, true);
            for (const double before_deg : off_deg_) {
                largest_before_loss_deg_ = std::max(largest_before_loss_deg_, before_deg);
            }
        }
        if (slip_.came()) {
            const double behind_s = last_s_ - slip_.time_s;
            const bool late = behind_s > latest_s - record.period_s() / 2;
            shown_.note(record, fault || synchronism == DRIVE_SYNCHRONISM_LOST ||
                                    (late && synchronism == DRIVE_SYNCHRONISM_STALLED));
        }
    }

    CampaignOutcome judge(const Result &result) const override
    {
        CampaignOutcome outcome;
        outcome.figures.assign(7, Metrics::none);
        if (!result.not_as_described().empty() && !fault_.came()) { /* or it may refuse moves */
            outcome.verdict = "failed";
            return outcome;
        }
        const bool slipped = slip_.came(), shown = shown_.came();
        const double delay_s = slipped ? (shown ? shown_.time_s : last_s_) - slip_.time_s : 0;
        const bool lost = lost_.came(), stalled = stalled_.came();
        const bool reported = fault_.came() || lost || stalled;
        outcome.verdict = delay_s > latest_s + row_period_s(*result.scenario) / 2 ? "missed"
                          : lost && largest_before_loss_deg_ < 45                 ? "false alarm"
                                                                                  : "held";
        const auto counted = [](bool what) { return what ? 1.0 : 0.0; };
        outcome.figures = {
            counted(slipped),
            counted(lost),
            counted(stalled && !lost),
            counted(reported && !lost && !stalled),
            counted(reported && !slip_is_provoked(result.seed)),
            counted(slipped && doubt_.row < slip_.row),
            slipped && shown ? delay_s * 1e3 : Metrics::none,
        };
        return outcome;
    }

  private:
    static constexpr double before_loss_s = 0.1;

    double degrees_;
    First slip_, fault_, doubt_;
    First stalled_, lost_;        /* warnings or faults */
    First shown_;                 /* the slip, by what reports it */
    std::vector<double> off_deg_; /* of the latest rows */
    double largest_before_loss_deg_ = 0;
    double last_s_ = 0;
};

std::unique_ptr<CampaignWatch> watch_slip(const Scenario &scenario)
{
    return std::make_unique<SlipWatch>(scenario);
}

} // namespace

const CampaignKind slip_campaign = {
    "slip",
    "every other run forces the rotor out of step: missed slips, false alarms, delay of the report",
    0.8,
    {{"slips", true},
     {"reports_lost_synchronism", true},
     {"reports_stalled", true},
     {"other_faults", true},
     {"faults_unprovoked", true},
     {"slips_doubted_before", true},
     {"delay_ms", false}},
    draw_slip,
    watch_slip,
};

} // namespace scenario
