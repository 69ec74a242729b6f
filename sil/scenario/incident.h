/*
 * What a drive did not do as it was asked: faults, commands refused, commands dropped. A run in
 * which one of these comes holds only if its scenario expects just that (Result::passed).
 */
#ifndef STEADYSTEP_SCENARIO_INCIDENT_H
#define STEADYSTEP_SCENARIO_INCIDENT_H

#include <cstdint>
#include <string>
#include <vector>

#include "sil/board/board.h"

namespace scenario
{

struct Incident {
    enum class Kind {
        fault,
        refused, /* when it was given */
        dropped  /* accepted, but the drive could not obey it in its period */
    };

    Kind kind = Kind::fault;
    double time_s = 0;  /* of the fault, of the drop; of the event whose command was refused */
    std::string what;   /* the fault, or the command as scenarios spell it, or the typed line */
    std::string reason; /* of a refusal: the drive's words behind the place in the scenario */
    bool expected = false;

    const char *metric() const; /* by which an [[expect]] names it */
    std::string text() const;   /* "fault stalled at 0.2031 s" */
};

/* Reports faults and drops from the signals of one period after another. */
class DriveWatch
{
  public:
    /* The drive has started, or starts again with the coming period. */
    void restart();
    void look(const drive_signals &signals, double time_s, std::vector<Incident> &incidents);

  private:
    drive_fault fault_ = DRIVE_FAULT_NONE;
    std::uint32_t dropped_ = 0;
};

} // namespace scenario

#endif
