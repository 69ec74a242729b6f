/*
 * A rotor that a load displaces from its reference, in a run of a campaign: how far, when by half
 * an electrical turn, and when a fault says so. Up to the fault, if one comes.
 */
#ifndef STEADYSTEP_SCENARIO_DISPLACED_ROTOR_H
#define STEADYSTEP_SCENARIO_DISPLACED_ROTOR_H

#include <algorithm>
#include <cmath>

#include "sil/scenario/campaign.h"

namespace scenario
{

constexpr double reference_torque_Nm = 0.471; /* rated, of bendjedia-2012 */

class DisplacedRotor
{
  public:
    explicit DisplacedRotor(const Scenario &scenario)
        : degrees_(scenario.motor.params.rotor_teeth * 180 / 3.14159265358979323846)
    {
    }

    /* false: time zero is to come, or the fault has come. */
    bool read(const Record &record, const Row &row)
    {
        if (record.rows() < record.time_zero_row() || faulted()) {
            return false;
        }
        const double off_deg = std::fabs(row[THETA] - row[THETA_REF]) * degrees_;
        last_s_ = record.time_s(record.rows());
        largest_deg_ = std::max(largest_deg_, off_deg);
        fault_.note(record, row[DRIVE_STATE] == double(DRIVE_FAULT));
        passed_.note(record, !faulted() && off_deg > 180);
        return true;
    }

    bool faulted() const
    {
        return fault_.came();
    }
    bool passed() const /* half an electrical turn */
    {
        return passed_.came();
    }
    double largest_deg() const /* electrical */
    {
        return largest_deg_;
    }
    double delay_s() const /* of the fault, or of the end, behind that; 0: not passed */
    {
        return passed() ? (faulted() ? fault_.time_s : last_s_) - passed_.time_s : 0;
    }
    double reported_ms() const /* the fault's; NaN: none behind it */
    {
        return passed() && faulted() ? delay_s() * 1e3 : Metrics::none;
    }

    /* The drive did not get ready, or the run is otherwise not what it is to be, and no fault says
       so: it shows nothing. */
    bool shows_nothing(const Result &result) const
    {
        return !result.not_as_described().empty() && !faulted();
    }

  private:
    double degrees_, largest_deg_ = 0, last_s_ = 0;
    First fault_, passed_;
};

} // namespace scenario

#endif
