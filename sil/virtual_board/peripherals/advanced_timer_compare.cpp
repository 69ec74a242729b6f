/* TIM1: when the count meets the compares. */
#include "sil/virtual_board/peripherals/advanced_timer.h"

#include <algorithm>

namespace virtual_board
{

namespace
{

enum : std::uint32_t { CR1 = 0x00, DIER = 0x0c, SR = 0x10 };

} // namespace

Ticks AdvancedTimer::next_phase(std::uint32_t phase, Ticks after) const
{
    const Ticks period = period_ticks();
    const Ticks first = origin_ + Ticks{phase} * count_ticks();
    if (first > after) {
        const Ticks ahead = first - after - 1;
        return ahead < period ? first : first - ahead / period * period;
    }
    const Ticks behind = after - first;
    return first + (behind < period ? 1 : behind / period + 1) * period;
}

/* Phases at which the flag of a channel is set, by CMS. A compare above ARR matches at the
   overflow. */
int AdvancedTimer::match_phases(int channel, std::uint32_t *phases) const
{
    const std::uint32_t compare = std::min(active_[static_cast<std::size_t>(channel)], reload_);
    const unsigned alignment = field(at(CR1), 5, 2); /* 1: down, 2: up, 3: both */
    if (compare == reload_ || compare == 0) {
        phases[0] = compare;
        return 1;
    }
    int count = 0;
    if ((alignment & 2u) != 0) {
        phases[count++] = compare;
    }
    if ((alignment & 1u) != 0) {
        phases[count++] = 2 * reload_ - compare;
    }
    return count;
}

/* Sets the compare flags of all matches up to now. */
void AdvancedTimer::take_flags()
{
    const Ticks now = chip_.now();
    if (!counting() || held() || now <= flags_until_) {
        return;
    }
    for (int channel = 0; channel < channels; channel++) {
        const std::uint32_t flag = 1u << (channel < 4 ? 1 + channel : 12 + channel);
        if ((at(SR) & flag) != 0) {
            continue; /* set as it is */
        }
        std::uint32_t phases[2];
        const int matches = match_phases(channel, phases);
        for (int i = 0; i < matches; i++) {
            if (next_phase(phases[i], flags_until_) <= now) {
                at(SR) |= flag;
            }
        }
    }
    flags_until_ = now;
}

void AdvancedTimer::schedule_compare()
{
    Ticks next = Event::never;
    for (int channel = 0; counting() && channel < 4; channel++) {
        if (!bit(at(DIER), static_cast<unsigned>(1 + channel))) {
            continue;
        }
        std::uint32_t phases[2];
        const int matches = match_phases(channel, phases);
        for (int i = 0; i < matches; i++) {
            next = std::min(next, next_phase(phases[i], chip_.now()));
        }
    }
    chip_.schedule(compare_event_, next);
}

void AdvancedTimer::compare_event()
{
    take_flags();
    schedule_compare();
    interrupt();
}

} // namespace virtual_board
