/*
 * Which exception runs next: lines, pending and active exceptions, enables and priorities of the
 * NVIC and the system handlers (ARMv7-M ARM, B1.5; ARMv6-M ARM, B1.5). Knows no registers of the
 * core: whoever runs it reads the masks and does entry and return.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_INTERRUPT_CONTROLLER_H
#define STEADYSTEP_VIRTUAL_BOARD_INTERRUPT_CONTROLLER_H

#include <cstdint>
#include <vector>

#include "sil/virtual_board/chip_description.h"

namespace virtual_board
{

/* Exception numbers; interrupt line n is exception first_interrupt + n. */
namespace exception
{
enum : unsigned {
    nmi = 2,
    hard_fault = 3,
    memory_fault = 4,
    bus_fault = 5,
    usage_fault = 6,
    supervisor_call = 11,
    pend_sv = 14,
    system_tick = 15,
    first_interrupt = 16
};
}

/* Of the core's registers, as they are. */
struct Masks {
    bool primask = false, faultmask = false;
    unsigned base_priority = 0;
};

class InterruptController
{
  public:
    explicit InterruptController(const CoreModel &core);

    void reset();

    void set_line(unsigned line, bool level)
    {
        if (of(exception::first_interrupt + line).line != level) {
            change_line(line, level);
        }
    }
    void set_pending(unsigned exception);
    void clear_pending(unsigned exception);
    void set_enabled(unsigned exception, bool enabled);
    void set_priority(unsigned exception, unsigned priority);
    void set_priority_grouping(unsigned grouping);

    bool pending(unsigned exception) const
    {
        return of(exception).pending;
    }
    bool enabled(unsigned exception) const
    {
        return of(exception).enabled;
    }
    bool active(unsigned exception) const
    {
        return of(exception).active;
    }
    unsigned priority(unsigned exception) const
    {
        return static_cast<unsigned>(of(exception).priority);
    }
    unsigned exceptions() const
    {
        return static_cast<unsigned>(exceptions_.size());
    }
    /* Most urgent pending and enabled exception whatever runs; 0: none. */
    unsigned next_pending() const
    {
        return next_;
    }
    /* The running exception; 0: thread mode. */
    unsigned running() const
    {
        return stack_.empty() ? 0 : stack_.back();
    }
    unsigned active_count() const
    {
        return static_cast<unsigned>(stack_.size());
    }

    /* Without regard of the masks: quick, asked again and again. */
    bool may_preempt() const
    {
        return next_priority_ < running_priority_;
    }
    /* The exception that is to be entered now; 0: none. */
    unsigned to_enter(const Masks &masks) const;
    /* Whether a core that sleeps wakes: PRIMASK does not count. */
    bool wakes(const Masks &masks) const;
    /* Whether a fault can be taken, or the core locks up. */
    bool hard_fault_possible(const Masks &masks) const
    {
        return priority_of_execution(masks) > hard_fault_priority;
    }

    void enter(unsigned exception);
    void leave(); /* the running one; pends again while its line is high */

  private:
    struct State {
        bool line = false, pending = false, enabled = false, active = false;
        int priority = 0;
    };
    static constexpr int idle_priority = 256, hard_fault_priority = -1;

    const State &of(unsigned exception) const
    {
        return exceptions_.at(exception);
    }
    State &of(unsigned exception)
    {
        return exceptions_.at(exception);
    }
    void change_line(unsigned line, bool level);
    int group(int priority) const
    {
        return priority < 0 ? priority : priority & group_mask_;
    }
    int priority_of_execution(const Masks &masks) const;
    void note(unsigned exception);
    void find_next();
    void find_running_priority();

    const CoreModel &core_;
    std::vector<State> exceptions_;
    std::vector<std::uint64_t> waiting_; /* pending and enabled exceptions, a bit each */
    std::vector<unsigned> stack_;        /* active exceptions, the running one last */
    int group_mask_ = 0xff;
    unsigned next_ = 0;
    int next_priority_ = idle_priority, running_priority_ = idle_priority; /* of their groups */
};

} // namespace virtual_board

#endif
