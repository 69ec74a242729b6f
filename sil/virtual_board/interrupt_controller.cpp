#include "sil/virtual_board/interrupt_controller.h"

#include <algorithm>
#include <stdexcept>

namespace virtual_board
{

InterruptController::InterruptController(const CoreModel &core) : core_(core)
{
    reset();
}

void InterruptController::reset()
{
    const std::vector<State> before = exceptions_;
    exceptions_.assign(exception::first_interrupt + core_.interrupt_lines, State());
    for (std::size_t i = 0; i < before.size(); ++i) {
        exceptions_[i].line = before[i].line; /* the peripherals' own reset lowers it */
    }
    of(exception::nmi).priority = -2;
    of(exception::hard_fault).priority = hard_fault_priority;
    for (const unsigned always : {exception::nmi, exception::hard_fault, exception::supervisor_call,
                                  exception::pend_sv, exception::system_tick}) {
        of(always).enabled = true;
    }
    waiting_.assign((exceptions_.size() + 63) / 64, 0);
    stack_.clear();
    group_mask_ = 0xff;
    find_next();
    find_running_priority();
}

/* Whether it waits has changed. */
void InterruptController::note(unsigned exception)
{
    const State &state = of(exception);
    const std::uint64_t bit = std::uint64_t{1} << exception % 64;
    std::uint64_t &word = waiting_[exception / 64];
    word = state.pending && state.enabled ? word | bit : word & ~bit;
    find_next();
}

void InterruptController::change_line(unsigned line, bool level)
{
    const unsigned exception = exception::first_interrupt + line;
    State &state = of(exception);
    state.line = level;
    if (level && !state.pending) {
        state.pending = true;
        note(exception);
    }
}

void InterruptController::set_pending(unsigned exception)
{
    of(exception).pending = true;
    note(exception);
}

void InterruptController::clear_pending(unsigned exception)
{
    State &state = of(exception);
    state.pending = state.line && !state.active;
    note(exception);
}

void InterruptController::set_enabled(unsigned exception, bool enabled)
{
    of(exception).enabled = enabled;
    note(exception);
}

void InterruptController::set_priority(unsigned exception, unsigned priority)
{
    const unsigned implemented = 0xffu & ~(0xffu >> core_.priority_bits);
    of(exception).priority = static_cast<int>(priority & implemented);
    find_next();
    find_running_priority();
}

/* Field PRIGROUP: the bits above bit `grouping` decide on preemption. */
void InterruptController::set_priority_grouping(unsigned grouping)
{
    group_mask_ = static_cast<int>(0xffu & ~((2u << grouping) - 1));
    find_next();
    find_running_priority();
}

/* The whole priority, then the lower number, chooses among those that wait. */
void InterruptController::find_next()
{
    next_ = 0;
    int best = idle_priority;
    for (std::size_t word = 0; word < waiting_.size(); ++word) {
        for (std::uint64_t left = waiting_[word]; left != 0; left &= left - 1) {
            const unsigned exception =
                static_cast<unsigned>(64 * word) + static_cast<unsigned>(__builtin_ctzll(left));
            if (of(exception).priority < best) {
                next_ = exception;
                best = of(exception).priority;
            }
        }
    }
    next_priority_ = next_ == 0 ? idle_priority : group(best);
}

void InterruptController::find_running_priority()
{
    running_priority_ = idle_priority;
    for (const unsigned active : stack_) {
        running_priority_ = std::min(running_priority_, group(of(active).priority));
    }
}

int InterruptController::priority_of_execution(const Masks &masks) const
{
    int priority = running_priority_;
    if (masks.base_priority != 0) {
        priority = std::min(priority, group(static_cast<int>(masks.base_priority)));
    }
    if (masks.primask) {
        priority = std::min(priority, 0);
    }
    if (masks.faultmask) {
        priority = std::min(priority, hard_fault_priority);
    }
    return priority;
}

unsigned InterruptController::to_enter(const Masks &masks) const
{
    return next_priority_ < priority_of_execution(masks) ? next_ : 0;
}

bool InterruptController::wakes(const Masks &masks) const
{
    Masks without = masks;
    without.primask = false;
    return next_priority_ < priority_of_execution(without);
}

void InterruptController::enter(unsigned exception)
{
    State &state = of(exception);
    state.pending = false;
    state.active = true;
    stack_.push_back(exception);
    note(exception);
    find_running_priority();
}

void InterruptController::leave()
{
    if (stack_.empty()) {
        throw std::logic_error("return from an exception while none is active");
    }
    const unsigned left = stack_.back();
    State &state = of(left);
    stack_.pop_back();
    state.active = false;
    state.pending = state.pending || state.line;
    note(left);
    find_running_priority();
}

} // namespace virtual_board
