/* Events in the order of their time, those of the same time in the order of scheduling. */
#ifndef STEADYSTEP_VIRTUAL_BOARD_EVENT_QUEUE_H
#define STEADYSTEP_VIRTUAL_BOARD_EVENT_QUEUE_H

#include <vector>

#include "sil/virtual_board/chip.h"

namespace virtual_board
{

class EventQueue
{
  public:
    /* Event::never takes it back. */
    void schedule(Event &event, Ticks at);

    /* Time of the earliest event; Event::never if there is none. */
    Ticks next() const
    {
        return next_;
    }
    /* Takes the earliest event out, which must exist; its time becomes Event::never. */
    Event &take();

  private:
    struct Entry {
        Ticks at;
        Event *event;
    };

    void remember_next()
    {
        next_ = entries_.empty() ? Event::never : entries_.back().at;
    }

    std::vector<Entry> entries_; /* some twenty; the earliest last */
    Ticks next_ = Event::never;
};

} // namespace virtual_board

#endif
