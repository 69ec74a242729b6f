/* General timers: compare flags. */
#include "sil/virtual_board/peripherals/timer.h"

#include <algorithm>

namespace virtual_board
{

namespace
{

enum : std::uint32_t { DIER = 0x0c, SR = 0x10, CCMR1 = 0x18, CCMR2 = 0x1c };

} // namespace

bool Timer::output(int channel) const
{
    const std::uint32_t mode = at(channel < 2 ? CCMR1 : CCMR2);
    return field(mode, channel % 2 == 0 ? 0 : 8, 2) == 0;
}

/* Sets the compare flags of all matches up to a time. */
void Timer::take_flags(Ticks until)
{
    if (!kind_.general || !counting() || encoder_mode() || until <= flags_until_) {
        return;
    }
    if ((at(SR) & compare_flags_) == compare_flags_) { /* all are set as it is */
        flags_until_ = until;
        return;
    }
    const Ticks count_time = count_ticks();
    for (int channel = 0; channel < 4; channel++) {
        const std::uint32_t compare = compare_[static_cast<std::size_t>(channel)];
        const Ticks match = origin_ + compare * count_time;
        if (output(channel) && compare <= top() && match > flags_until_ && match <= until) {
            at(SR) |= 2u << channel;
        }
    }
    flags_until_ = until;
}

void Timer::schedule_compare()
{
    Ticks next = Event::never;
    if ((at(DIER) & 0x1eu) == 0 && compare_event_.at == next) {
        return; /* as a rule */
    }
    const Ticks count_time = count_ticks();
    for (int channel = 0; kind_.general && counting() && channel < 4; channel++) {
        const std::uint32_t compare = compare_[static_cast<std::size_t>(channel)];
        const Ticks match = origin_ + compare * count_time;
        if (bit(at(DIER), static_cast<unsigned>(1 + channel)) && match > chip_.now() &&
            compare <= top()) {
            next = std::min(next, match);
        }
    }
    chip_.schedule(compare_event_, next);
}

} // namespace virtual_board
