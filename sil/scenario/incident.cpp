#include "sil/scenario/incident.h"

#include "sil/scenario/text.h"
#include "sil/scenario/timeline.h"

namespace scenario
{

const char *Incident::metric() const
{
    switch (kind) {
    case Kind::fault:
        break;
    case Kind::refused:
        return "commands_refused";
    case Kind::dropped:
        return "commands_dropped";
    }
    return "fault";
}

std::string Incident::text() const
{
    const std::string at = format(" at %.6g s", time_s);
    switch (kind) {
    case Kind::fault:
        break;
    case Kind::refused:
        return "refused" + at + ": " + reason;
    case Kind::dropped:
        return "dropped" + at + ": " + what;
    }
    return "fault " + what + at;
}

void DriveWatch::restart()
{
    *this = DriveWatch();
}

void DriveWatch::look(const drive_signals &signals, double time_s, std::vector<Incident> &incidents)
{
    const drive_fault fault = signals.state == DRIVE_FAULT ? signals.fault : DRIVE_FAULT_NONE;
    if (fault != fault_ && fault != DRIVE_FAULT_NONE) {
        incidents.push_back({Incident::Kind::fault, time_s, drive_fault_name(fault), ""});
    }
    fault_ = fault;
    if (signals.commands_dropped != dropped_) { /* by one: the drive looks at one a period */
        incidents.push_back(
            {Incident::Kind::dropped, time_s, command_name(signals.dropped_kind), ""});
    }
    dropped_ = signals.commands_dropped;
}

} // namespace scenario
