#include "sil/virtual_board/event_queue.h"

#include <algorithm>

namespace virtual_board
{

void EventQueue::schedule(Event &event, Ticks at)
{
    if (event.at == Event::never && at == Event::never) {
        return;
    }
    if (event.at != Event::never) {
        entries_.erase(std::find_if(entries_.begin(), entries_.end(),
                                    [&](const Entry &entry) { return entry.event == &event; }));
    }
    event.at = at;
    if (at != Event::never) {
        /* Before all of the same time, so behind them in the order of taking. */
        const auto place =
            std::lower_bound(entries_.begin(), entries_.end(), at,
                             [](const Entry &entry, Ticks time) { return entry.at > time; });
        entries_.insert(place, {at, &event});
    }
    remember_next();
}

Event &EventQueue::take()
{
    Event &event = *entries_.back().event;
    entries_.pop_back();
    event.at = Event::never;
    remember_next();
    return event;
}

} // namespace virtual_board
