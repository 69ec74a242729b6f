/* The commands of a timeline as lines, and when to type them. */
#ifndef STEADYSTEP_SCENARIO_TAPE_H
#define STEADYSTEP_SCENARIO_TAPE_H

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sil/scenario/serial_line.h"
#include "sil/scenario/timeline.h"

namespace scenario
{

class Tape
{
  public:
    Tape(const std::vector<Event> &events, double period_s);

    /* Types what is to arrive in period n of the timeline. The drive counts its periods from
       n = -time_zero. Periods are asked for in order, none is left out. */
    void type(std::int64_t n, std::uint32_t time_zero, SerialLine &line);

  private:
    struct Entry {
        drive_command command;
        std::int64_t acts_in;
        std::int64_t typed_in;
        std::int64_t delay; /* from typing to acting, at least */
        std::string origin;
        double time_s; /* of the event, or of the set-point */
    };

    std::vector<Entry> entries_;
    std::size_t next_ = 0;
};

} // namespace scenario

#endif
