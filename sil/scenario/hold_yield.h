/*
 * By how much a rotor at rest yields at most, by computation: the limit of a motor on a board in a
 * run, where its rest is judged.
 */
#ifndef STEADYSTEP_SCENARIO_HOLD_YIELD_H
#define STEADYSTEP_SCENARIO_HOLD_YIELD_H

#include <optional>

#include "sil/scenario/record.h"
#include "sil/scenario/scenario_file.h"

namespace scenario
{

/*
 * Angle of the rotor, rad. Without an encoder the hold yields
 *
 *   asin((T_unnoticed + T_detent + T_friction) / T_hold) / N  +  (u / Km) (8 / w_h)
 *
 * to a load step that is just not noticed (drive_hold_bearing) or, if that is more, to what the
 * loads of this run have changed by unnoticed since its last motion; to detent torque and friction,
 * of a torque that saturation diminishes; and what u, half a code of the leg voltages, feigns while
 * a step is followed. No value of a motor that the drive refuses.
 *
 * With an encoder and the default law there is a limit of this kind only where detent torque is
 * steeper than the law is stiff, N (4 T4 + 2 T2 + T1) > J w0^2: no place between two that it
 * prefers is stable until it has been learned, and the rotor hunts within
 *
 *   (T_detent + T_friction) / (J w0^2)  +  a count
 */
class HoldYield : public RowReader
{
  public:
    explicit HoldYield(const Scenario &scenario);

    void read(const Record &record, const Row &row) override;
    std::optional<double> yield_rad() const; /* of the rows read */

    /* Of the hold as it is designed; no value with an encoder, or of a motor that is refused. */
    const std::optional<drive_hold_bearing> &bearing() const
    {
        return bearing_;
    }

  private:
    const Scenario &scenario_;
    std::optional<drive_hold_bearing> bearing_;
    bool first_ = true;
    double load_Nm_ = 0; /* of the row before */
    double unnoticed_Nm_ = 0, most_unnoticed_Nm_ = 0;
};

} // namespace scenario

#endif
