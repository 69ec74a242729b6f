/*
 * The knobs of a served drive: lines of text that do to its plant what events of a scenario do,
 * each answered by one line, "ok time_s=..." or "error: ...". The keys are those of an event
 * without its time; `state` answers with what is true of the motor, unseen by the drive.
 */
#ifndef STEADYSTEP_SERVE_KNOBS_H
#define STEADYSTEP_SERVE_KNOBS_H

#include <cstdint>
#include <string>

#include "sil/scenario/plant_events.h"

namespace serve
{

class Knobs
{
  public:
    Knobs(const scenario::Scenario &scenario, sil::DriveBoard &board);

    /* Bytes of any number of lines, in period n; the answers to those that have ended. */
    std::string turn(const std::string &bytes, std::uint32_t n);

    /* In each period, before its control(). */
    void act(std::uint32_t n);

    /* The drive has been switched off and on since the last call. */
    bool take_restart();

  private:
    std::string obey(const std::string &line, std::uint32_t n);
    std::string state(std::uint32_t n) const;

    const scenario::Scenario &scenario_;
    sil::DriveBoard &board_;
    scenario::PlantEvents events_;
    std::string line_; /* that has not ended */
    bool restarted_ = false;
};

} // namespace serve

#endif
