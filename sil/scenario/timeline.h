/*
 * What happens in a scenario and what must come of it: its events, its expectations, and the
 * figures it reports besides.
 */
#ifndef STEADYSTEP_SCENARIO_TIMELINE_H
#define STEADYSTEP_SCENARIO_TIMELINE_H

#include <optional>
#include <string>
#include <vector>

#include "sil/board/board.h"
#include "sil/scenario/disturbance.h"
#include "sil/scenario/document.h"
#include "sil/scenario/window.h"
#include "sil/scenario/table_reader.h"

namespace scenario
{

/* Something that happens at a time; exactly one of them. */
struct Event {
    double time_s = 0; /* 0 is the first S(k) with the drive ready */
    std::optional<drive_command> command;
    std::vector<double> set_points_rad; /* of set-points: the first goes with the command, the
                                           others follow at its interval */
    bool power_cycle = false;           /* the board restarts, with its parameter store as it was */
    std::optional<std::string> type;    /* a line for the drive's console */
    std::optional<std::string> expects; /* the drive has written a line that begins so */
    std::optional<LoadChange> load;
    std::optional<int> shorted_leg; /* A+, A-, B+, B- */
    double short_circuit_A = 0;
    std::optional<std::uint32_t> inputs; /* levels of the machine's, HAL_INPUT_... */
    std::optional<double> stall_us;      /* holds the control interrupt up until then behind S(k) */
    std::vector<Drift> drifts;           /* within drift_ramp_s */
    double drift_ramp_s = 0;
    PlantFault fault; /* of motor, winding or converters */
    Location location;
};

/* One bound on one metric over one window; one that is only reported has no bound and holds. */
struct Expectation {
    std::string metric;
    Window window;
    std::optional<double> min, max, equals;
    std::vector<std::string> equals_text; /* of `fault`: one of these */

    bool of_fault() const
    {
        return !equals_text.empty();
    }
    bool bounded() const
    {
        return min || max || equals || of_fault();
    }
    std::string bound() const; /* "<= 0.001" */
};

/* As an event spells it. */
std::string command_name(drive_command_kind kind);

/* One event of a running board, which has no time: the keys of an inline table, as
   `load_torque_Nm = 0.1, ramp_s = 0.5`. Of commands, power-cycle alone; throws InputError. */
Event read_knob(const std::string &line, const std::string &name);

/* The arrays `event`, sorted by time, `expect` and `report` of a scenario; throw InputError. */
std::vector<Event> read_events(TableReader &scenario, double duration_s);
std::vector<Expectation> read_expectations(TableReader &scenario, double duration_s);
std::vector<Expectation> read_reports(TableReader &scenario, double duration_s);

} // namespace scenario

#endif
