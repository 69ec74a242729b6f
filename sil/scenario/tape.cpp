#include "sil/scenario/tape.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "sil/board/typed_line.h"
#include "sil/scenario/record.h"

namespace scenario
{

namespace
{

std::int64_t periods(double time_s, double period_s)
{
    return static_cast<std::int64_t>(std::floor(time_s / period_s + 0.5));
}

} // namespace

/*
 * Lines are typed in the order of their commands. One that is typed earlier than it need be, for
 * the sake of a planned command behind it, is addressed with at=. Nothing is typed before a power
 * cycle for after it.
 */
Tape::Tape(const std::vector<Event> &events, double period_s)
{
    std::int64_t restart = INT64_MIN; /* of the drive, before the event */
    for (const Event &event : events) {
        const std::int64_t begin = periods(event.time_s, period_s);
        if (event.power_cycle) {
            restart = begin;
        }
        if (!event.command) {
            continue;
        }
        drive_command command = *event.command;
        const std::size_t count = std::max<std::size_t>(1, event.set_points_rad.size());
        for (std::size_t i = 0; i < count; ++i) {
            if (!event.set_points_rad.empty()) {
                command.position_rad = event.set_points_rad[i];
            }
            const std::int64_t interval =
                std::max<std::int64_t>(1, periods(command.interval_s, period_s));
            const std::int64_t acts_in = begin + static_cast<std::int64_t>(i) * interval;
            /* a store, say, acts when it is read: with what has been learned before period n */
            const std::int64_t delay = drive_command_is(command.kind, DRIVE_AT_ONCE)
                                           ? 1
                                           : sil::typed_delay(command.kind, period_s);
            entries_.push_back({command, acts_in, std::max(acts_in - delay, restart), delay,
                                event.location.text(),
                                time_of(static_cast<double>(acts_in), period_s)});
        }
    }
    std::stable_sort(entries_.begin(), entries_.end(),
                     [](const Entry &a, const Entry &b) { return a.acts_in < b.acts_in; });
    for (std::size_t i = entries_.size(); i-- > 1;) {
        Entry &before = entries_[i - 1];
        if (!drive_command_is(before.command.kind, DRIVE_AT_ONCE)) {
            before.typed_in = std::min(before.typed_in, entries_[i].typed_in);
        }
    }
    std::stable_sort(entries_.begin(), entries_.end(),
                     [](const Entry &a, const Entry &b) { return a.typed_in < b.typed_in; });
}

void Tape::type(std::int64_t n, std::uint32_t time_zero, SerialLine &line)
{
    for (; next_ < entries_.size() && entries_[next_].typed_in <= n; ++next_) {
        const Entry &entry = entries_[next_];
        std::optional<std::uint32_t> at_period;
        if (entry.typed_in + entry.delay < entry.acts_in) {
            at_period = time_zero + static_cast<std::uint32_t>(entry.acts_in);
        }
        line.type(sil::typed_line(entry.command, at_period), entry.origin, entry.time_s);
    }
}

} // namespace scenario
