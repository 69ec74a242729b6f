/* TIM1: TRGO2 from the channels, dead time, break and the lock of its configuration. */
#include "sil/virtual_board/peripherals/advanced_timer.h"

#include <algorithm>

namespace virtual_board
{

namespace
{

enum : std::uint32_t { CR2 = 0x04, SR = 0x10, CCER = 0x20, BDTR = 0x44, AF1 = 0x60 };
enum : std::uint32_t { BKE = 1u << 12, BKP = 1u << 13, AOE = 1u << 14, MOE = 1u << 15 };
constexpr std::uint32_t ossi = 1u << 10;
constexpr std::uint32_t BIF = 1u << 7, SBIF = 1u << 13;

} // namespace

/* RM0440, DTG: 0xx t; 10x (64 + x) 2 t; 110 (32 + x) 8 t; 111 (32 + x) 16 t. */
unsigned dead_time_clocks(unsigned dtg)
{
    if (dtg < 0x80) {
        return dtg;
    }
    if (dtg < 0xc0) {
        return (64 + (dtg & 0x3fu)) * 2;
    }
    return (32 + (dtg & 0x1fu)) * (dtg < 0xe0 ? 8 : 16);
}

Ticks AdvancedTimer::dead_time() const
{
    const unsigned division = 1u << field(at(0x00), 8, 2); /* CKD */
    return Ticks{dead_time_clocks(at(BDTR) & 0xffu)} * division * clock_();
}

bool AdvancedTimer::idle_outputs_off() const
{
    return (at(BDTR) & ossi) == 0 || (at(CR2) & 0x7f00u) == 0;
}

bool AdvancedTimer::all_low(Ticks time) const
{
    if (!counting()) {
        return false;
    }
    const Ticks phase = phase_ticks(time), period = period_ticks();
    const Ticks count = count_ticks(), dead = dead_time();
    for (int leg = 0; leg < legs; leg++) {
        const std::uint32_t compare = std::min(active_compare(leg), reload_);
        const Ticks high = Ticks{compare} * count;
        if (output_mode(leg) != 6) {
            return false;
        }
        if (compare != 0 && (phase < high + dead || phase >= period - high)) {
            return false;
        }
    }
    return true;
}

/* Edges of the reference signals that drive TRGO2, by MMS2. */
std::vector<AdvancedTimer::Edge> AdvancedTimer::trigger_edges() const
{
    const TriggerEdge up = TriggerEdge::rising, down = TriggerEdge::falling;
    const unsigned mode = field(at(CR2), 20, 4);
    switch (mode) {
    case 4:
    case 5:
    case 6:
    case 7:
    case 8:
    case 9: {
        const int channel = static_cast<int>(mode) - 4;
        return {{channel, up, false}, {channel, down, false}};
    }
    case 10:
        return {{3, up, true}, {3, down, true}};
    case 11:
        return {{5, up, true}, {5, down, true}};
    case 12:
        return {{3, up, true}, {5, up, true}};
    case 13:
        return {{3, up, true}, {5, down, true}};
    case 14:
        return {{4, up, true}, {5, up, true}};
    case 15:
        return {{4, up, true}, {5, down, true}};
    default:
        return {};
    }
}

void AdvancedTimer::schedule_trigger()
{
    Ticks next = Event::never;
    due_.clear();
    const Ticks now = chip_.now();
    for (const Edge &edge : counting() ? trigger_edges() : std::vector<Edge>{}) {
        const std::uint32_t compare = active_compare(edge.channel);
        const unsigned mode = output_mode(edge.channel);
        if (mode == 0 || compare == 0 || compare >= reload_) {
            continue; /* a constant level */
        }
        const bool at_compare = (mode == 7) == (edge.edge == TriggerEdge::rising);
        const Ticks time = next_phase(at_compare ? compare : 2 * reload_ - compare, now);
        if (time < next) {
            due_.clear();
            next = time;
        }
        if (time == next) {
            due_.push_back(edge);
        }
    }
    chip_.schedule(trigger_event_, next);
}

void AdvancedTimer::trigger_event()
{
    const std::vector<Edge> due = due_;
    for (const Edge &edge : due) {
        if (edge.pulse) {
            triggers_.pulse(Trigger::tim1_2);
        } else {
            triggers_.edge(Trigger::tim1_2, edge.edge);
        }
    }
    schedule_trigger();
}

void AdvancedTimer::check_lock(std::uint32_t offset, std::uint32_t value) const
{
    std::uint32_t locked = 0;
    if (lock_level_ >= 1) {
        locked |= offset == BDTR ? 0xff0f70ffu & ~0x00f00000u : offset == CR2 ? 0x7f00u : 0u;
        locked |= offset == AF1 ? 0x3fffu : 0u;
    }
    if (lock_level_ >= 2) {
        locked |= offset == CCER ? 0x22aaaau : offset == BDTR ? 0xc00u : 0u;
    }
    if (lock_level_ >= 3) {
        locked |= offset == 0x18 || offset == 0x1c ? 0x01017878u : 0u;
    }
    if (offset == BDTR && lock_level_ >= 1) {
        locked |= 0x300u;
    }
    require(((at(offset) ^ value) & locked) == 0, offset, value,
            "changes bits that BDTR.LOCK protects until the next reset");
}

void AdvancedTimer::break_and_dead_time(std::uint32_t value)
{
    const bool was = outputs_enabled();
    require(field(value, 16, 4) == 0, BDTR, value, "BKF: a filtered break is not modelled");
    keep(BDTR, value);
    lock_level_ = std::max(lock_level_, field(value, 8, 2));
    if ((value & MOE) != 0) {
        if (break_active()) {
            refuse(BDTR, value, "MOE set while the break input is active");
        }
        if (!was && on_outputs_enabled) {
            on_outputs_enabled();
        }
    }
    check_break();
}

void AdvancedTimer::comparator(unsigned index, bool level)
{
    const unsigned mask = 1u << index;
    if (!level && (comparators_ & mask) == 0) {
        return; /* stays low, as a rule */
    }
    comparators_ = level ? comparators_ | mask : comparators_ & ~mask;
    take_flags();
    check_break();
    interrupt();
}

void AdvancedTimer::system_break(bool level)
{
    system_break_ = level;
    take_flags();
    check_break();
    interrupt();
}

/* The sources are OR-ed after their own inversion; BKP is the active level of the result. No pin
   carries BKIN, which reads 0. */
bool AdvancedTimer::break_active() const
{
    const std::uint32_t value = at(BDTR), sources = at(AF1);
    if ((value & BKE) == 0) {
        return false;
    }
    bool level = bit(sources, 0) && bit(sources, 9);
    for (unsigned i = 0; i < 7; i++) {
        const bool inverted = i < 4 && bit(sources, 10 + i);
        const bool input = bit(comparators_, i);
        level = level || (bit(sources, 1 + i) && input != inverted);
    }
    return system_break_ || level == ((value & BKP) != 0);
}

/* The break acts without a clock: outputs off at once. */
void AdvancedTimer::check_break()
{
    if (!clocked() || !break_active()) {
        return;
    }
    at(SR) |= system_break_ ? SBIF : BIF;
    if (outputs_enabled()) {
        at(BDTR) &= ~MOE;
        counters.breaks++;
    }
}

} // namespace virtual_board
