/*
 * Campaign "slip": is every loss of synchronism told, and none that is not one? The runs are those
 * of slip_scenario.h.
 *
 * A slip begins where the estimate is 90 degrees electrical off. Missed: no fault has come 20 ms
 * later. False alarm: the fault lost-synchronism with less than 45 degrees throughout the 100 ms
 * before it. Any fault reports a slip; only lost-synchronism claims one.
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

/* What a record shows of slip and report; rows, `none` if there was none. */
struct Course {
    static constexpr std::size_t none = static_cast<std::size_t>(-1);
    std::size_t slip = none, fault = none, doubt = none;
    double largest_before_fault_deg = 0; /* in the 100 ms that end with the fault */
};

Course course_of(const Record &record, double teeth)
{
    const double degrees = teeth * 180 / pi;
    const auto off = [&](std::size_t row) {
        return std::fabs(record.at(row, THETA) - record.at(row, THETA_EST)) * degrees;
    };
    Course course;
    for (std::size_t row = record.time_zero_row(); row < record.rows(); ++row) {
        const auto state = static_cast<drive_state>(record.at(row, DRIVE_STATE));
        if (state == DRIVE_FAULT) {
            course.fault = row;
            break;
        }
        if (course.slip == Course::none && off(row) > 90) {
            course.slip = row;
        }
        if (course.doubt == Course::none &&
            record.at(row, SYNCHRONISM) > double(DRIVE_SYNCHRONISM_SURE)) {
            course.doubt = row;
        }
    }
    if (course.fault != Course::none) {
        const auto before = static_cast<std::size_t>(std::floor(0.1 / record.period_s() + 0.5));
        for (std::size_t row = course.fault > before ? course.fault - before : 0;
             row <= course.fault; ++row) {
            course.largest_before_fault_deg = std::max(course.largest_before_fault_deg, off(row));
        }
    }
    return course;
}

CampaignOutcome judge_slip(const Result &result, const Record &record)
{
    constexpr double latest_s = 0.02;
    CampaignOutcome outcome;
    outcome.figures.assign(7, Metrics::none);
    const Course course = course_of(record, result.scenario->motor.params.rotor_teeth);
    const bool slipped = course.slip != Course::none, reported = course.fault != Course::none;
    if (!result.failure.empty() && !reported) { /* a drive in fault may refuse the moves to come */
        outcome.verdict = "failed";
        return outcome;
    }
    const double end_s = record.time_s(record.rows() - 1);
    const double slip_s = slipped ? record.time_s(course.slip) : end_s;
    const double delay_s = reported ? record.time_s(course.fault) - slip_s : end_s - slip_s;
    const auto fault = reported
                           ? static_cast<drive_fault>(record.at(course.fault, DRIVE_FAULT_CODE))
                           : DRIVE_FAULT_NONE;
    const bool lost = fault == DRIVE_FAULT_LOST_SYNCHRONISM, stalled = fault == DRIVE_FAULT_STALLED;
    outcome.verdict = slipped && delay_s > latest_s + record.period_s() / 2 ? "missed"
                      : lost && course.largest_before_fault_deg < 45        ? "false alarm"
                                                                            : "held";
    const auto counted = [](bool what) { return what ? 1.0 : 0.0; };
    outcome.figures = {
        counted(slipped),
        counted(lost),
        counted(stalled),
        counted(reported && !lost && !stalled),
        counted(reported && !slip_is_provoked(result.seed)),
        counted(slipped && course.doubt < course.slip),
        slipped && reported ? delay_s * 1e3 : Metrics::none,
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
