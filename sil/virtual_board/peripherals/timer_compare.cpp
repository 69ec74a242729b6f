/* General timers: compare flags, and captures of an encoder's count. */
#include "sil/virtual_board/peripherals/timer.h"

#include <algorithm>

namespace virtual_board
{

namespace
{

enum : std::uint32_t {
    DIER = 0x0c,
    SR = 0x10,
    CCMR1 = 0x18,
    CCMR2 = 0x1c,
    CCER = 0x20,
    CCR3 = 0x3c
};
enum : std::uint32_t { CC3IF = 1u << 3, CC3OF = 1u << 11 };

} // namespace

bool Timer::output(int channel) const
{
    const std::uint32_t mode = at(channel < 2 ? CCMR1 : CCMR2);
    return field(mode, channel % 2 == 0 ? 0 : 8, 2) == 0;
}

void Timer::capture(unsigned channel, bool rising, std::int32_t position)
{
    const unsigned upper = channel - 3; /* of CCMR2's two */
    const std::uint32_t enables = at(CCER) >> 4 * (channel - 1);
    const bool falls = bit(enables, 1), both = bit(enables, 3);
    if (!counting() || !encoder_mode() || field(at(CCMR2), 8 * upper, 2) != 1 || !bit(enables, 0)) {
        return;
    }
    require(!both, CCER, enables, "both edges: not modelled");
    if (rising == falls) {
        return;
    }
    at(SR) |= (bit(at(SR), channel) ? CC3OF << upper : 0u) | CC3IF << upper;
    at(CCR3 + 4 * upper) = count_at(position);
    interrupt();
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
