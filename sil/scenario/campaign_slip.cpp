/*
 * Campaign "slip": is every loss of synchronism told, and none that is not one? The runs are those
 * of slip_scenario.h.
 *
 * A slip begins where the estimate is 90 degrees electrical off. It is told by any fault or, with
 * the policy `warn`, by a warning of a loss, or of a stall that stands 20 ms later; missed: none
 * has come by then. False alarm: a loss of synchronism, fault or warning, with less than 45 degrees
 * throughout the 100 ms before it. Only these claim a slip.
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
constexpr std::size_t none = static_cast<std::size_t>(-1);
constexpr double latest_s = 0.02; /* behind a slip, for it to be told */

/* What a record shows; the first rows of each, `none` if there is none. */
struct Course {
    std::size_t slip = none, fault = none, doubt = none;
    std::size_t stalled = none, lost = none; /* warnings or faults */
    std::size_t told = none;                 /* of the slip, by what tells it */
    double largest_before_loss_deg = 0;      /* in the 100 ms that end with it */
};

void note(std::size_t &first, std::size_t row, bool happens)
{
    if (first == none && happens) {
        first = row;
    }
}

Course course_of(const Record &record, double teeth)
{
    const double degrees = teeth * 180 / pi, half_period_s = record.period_s() / 2;
    const auto off = [&](std::size_t row) {
        return std::fabs(record.at(row, THETA) - record.at(row, THETA_EST)) * degrees;
    };
    Course course;
    for (std::size_t row = record.time_zero_row(); row < record.rows() && course.fault == none;
         ++row) {
        const auto synchronism = static_cast<drive_synchronism>(record.at(row, SYNCHRONISM));
        const bool fault = record.at(row, DRIVE_STATE) == double(DRIVE_FAULT);
        note(course.fault, row, fault);
        note(course.slip, row, !fault && off(row) > 90);
        note(course.doubt, row, synchronism > DRIVE_SYNCHRONISM_SURE);
        note(course.stalled, row, synchronism == DRIVE_SYNCHRONISM_STALLED);
        note(course.lost, row, synchronism == DRIVE_SYNCHRONISM_LOST);
        if (course.slip != none) {
            const double behind_s = record.time_s(row) - record.time_s(course.slip);
            const bool late = behind_s > latest_s - half_period_s;
            note(course.told, row,
                 fault || synchronism == DRIVE_SYNCHRONISM_LOST ||
                     (late && synchronism == DRIVE_SYNCHRONISM_STALLED));
        }
    }
    if (course.lost != none) {
        const auto before = static_cast<std::size_t>(std::floor(0.1 / record.period_s() + 0.5));
        for (std::size_t row = course.lost > before ? course.lost - before : 0; row <= course.lost;
             ++row) {
            course.largest_before_loss_deg = std::max(course.largest_before_loss_deg, off(row));
        }
    }
    return course;
}

CampaignOutcome judge_slip(const Result &result, const Record &record)
{
    CampaignOutcome outcome;
    outcome.figures.assign(7, Metrics::none);
    const Course course = course_of(record, result.scenario->motor.params.rotor_teeth);
    if (!result.not_as_described().empty() && course.fault == none) { /* or it may refuse moves */
        outcome.verdict = "failed";
        return outcome;
    }
    const bool slipped = course.slip != none, told = course.told != none;
    const std::size_t last = told ? course.told : record.rows() - 1;
    const double delay_s = slipped ? record.time_s(last) - record.time_s(course.slip) : 0;
    const bool lost = course.lost != none, stalled = course.stalled != none;
    const bool reported = course.fault != none || lost || stalled;
    outcome.verdict = delay_s > latest_s + record.period_s() / 2    ? "missed"
                      : lost && course.largest_before_loss_deg < 45 ? "false alarm"
                                                                    : "held";
    const auto counted = [](bool what) { return what ? 1.0 : 0.0; };
    outcome.figures = {
        counted(slipped),
        counted(lost),
        counted(stalled && !lost),
        counted(reported && !lost && !stalled),
        counted(reported && !slip_is_provoked(result.seed)),
        counted(slipped && course.doubt < course.slip),
        slipped && told ? delay_s * 1e3 : Metrics::none,
    };
    return outcome;
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
    judge_slip,
};

} // namespace scenario
