#include "sil/virtual_board/peripherals/advanced_timer.h"

namespace virtual_board
{

namespace
{

enum : std::uint32_t {
    CR1 = 0x00,
    CR2 = 0x04,
    DIER = 0x0c,
    SR = 0x10,
    EGR = 0x14,
    CCMR1 = 0x18,
    CCMR2 = 0x1c,
    CCER = 0x20,
    CNT = 0x24,
    PSC = 0x28,
    ARR = 0x2c,
    RCR = 0x30,
    CCR1 = 0x34,
    BDTR = 0x44,
    CCR5 = 0x48,
    CCR6 = 0x4c,
    CCMR3 = 0x50,
    AF1 = 0x60,
    AF2 = 0x64
};
enum : std::uint32_t { CEN = 1u << 0, UDIS = 1u << 1, URS = 1u << 2, DIR = 1u << 4 };
enum : std::uint32_t { ARPE = 1u << 7, UIF = 1u << 0 };

constexpr std::uint32_t output_modes = 0x01017c7c & ~0x0404u; /* OCxPE, OCxM; output only */

/* CCR registers of channels 0...5. */
constexpr std::uint32_t compare_offset[AdvancedTimer::channels] = {CCR1,      CCR1 + 4, CCR1 + 8,
                                                                   CCR1 + 12, CCR5,     CCR6};

} // namespace

AdvancedTimer::AdvancedTimer(Chip &chip, Triggers &triggers, std::function<Ticks()> clock)
    : RegisterBlock(chip, "TIM1",
                    {{CR1, "CR1", 0x3f7},
                     {CR2, "CR2", 0x00f57f70},
                     {0x08, "SMCR", 0x80},
                     {DIER, "DIER", 0x9f},
                     {SR, "SR", 0, 0, 0xffffffff},
                     {EGR, "EGR", 0x81},
                     {CCMR1, "CCMR1", output_modes},
                     {CCMR2, "CCMR2", output_modes},
                     {CCER, "CCER", 0x33ffff},
                     {CNT, "CNT", 0xffff},
                     {PSC, "PSC", 0xffff},
                     {ARR, "ARR", 0xffff, 0xffff},
                     {RCR, "RCR", 0xffff},
                     {CCR1, "CCR1", 0xffff},
                     {CCR1 + 4, "CCR2", 0xffff},
                     {CCR1 + 8, "CCR3", 0xffff},
                     {CCR1 + 12, "CCR4", 0xffff},
                     {BDTR, "BDTR", 0xfffff},
                     {CCR5, "CCR5", 0xffff},
                     {CCR6, "CCR6", 0xffff},
                     {CCMR3, "CCMR3", output_modes},
                     {0x54, "DTR2", 0},
                     {0x5c, "TISEL", 0},
                     {AF1, "AF1", 0x3fff, 0x1},
                     {AF2, "AF2", 0x1, 0x1}}),
      triggers_(triggers), clock_(std::move(clock)), turning_event_([this] { turning_point(); }),
      compare_event_([this] { compare_event(); }), trigger_event_([this] { trigger_event(); })
{
}

void AdvancedTimer::reset()
{
    RegisterBlock::reset();
    prescaler_ = repetition_ = 0;
    reload_ = 0xffff;
    active_.fill(0);
    frozen_ = 0;
    up_ = true;
    lock_level_ = 0;
    moe_written_ = false;
    held_since_ = Event::never;
    for (Event *event : {&turning_event_, &compare_event_, &trigger_event_}) {
        chip_.schedule(*event, Event::never);
    }
    interrupt();
}

unsigned AdvancedTimer::output_mode(int channel) const
{
    const std::uint32_t value = at(channel < 2 ? CCMR1 : channel < 4 ? CCMR2 : CCMR3);
    const unsigned shift = channel % 2 == 0 ? 0 : 8;
    return field(value, 4 + shift, 3) | (bit(value, 16 + shift) ? 8u : 0u);
}

bool AdvancedTimer::preloaded(int channel) const
{
    const std::uint32_t value = at(channel < 2 ? CCMR1 : channel < 4 ? CCMR2 : CCMR3);
    return bit(value, channel % 2 == 0 ? 3 : 11);
}

Ticks AdvancedTimer::phase_ticks(Ticks time) const
{
    return (time - origin_) % period_ticks();
}

std::uint32_t AdvancedTimer::count() const
{
    if (!counting()) {
        return frozen_;
    }
    const std::uint32_t phase =
        static_cast<std::uint32_t>(phase_ticks(chip_.now()) / count_ticks());
    return phase <= reload_ ? phase : 2 * reload_ - phase;
}

std::uint32_t AdvancedTimer::fetch(std::uint32_t offset, Master)
{
    if (offset == CNT) {
        return count();
    }
    if (offset == SR) {
        take_flags();
    }
    if (offset == CR1 && counting()) {
        return (at(CR1) & ~DIR) | (up_ ? 0u : DIR);
    }
    return at(offset);
}

void AdvancedTimer::put(std::uint32_t offset, std::uint32_t value, Master)
{
    take_flags();
    check_lock(offset, value);
    for (int channel = 0; channel < channels; channel++) {
        if (offset == compare_offset[channel]) {
            compare(channel, offset, value);
            if (preloaded(channel)) {
                return; /* nothing is in force before the next update event */
            }
        }
    }
    switch (offset) {
    case CR1:
        control(value);
        break;
    case SR:
        at(SR) &= value;
        check_break(); /* an active break sets its flag again */
        break;
    case EGR:
        generate(value);
        break;
    case CNT:
        require(!counting() && value == 0, offset, value, "only CNT = 0 while stopped is modelled");
        break;
    case ARR:
        keep(offset, value);
        require(value != 0, offset, value, "the counter is blocked while ARR is 0");
        if ((at(CR1) & ARPE) == 0 && value != reload_) {
            require(!counting(), offset, value, "changed without preload while counting");
            reload_ = value;
        }
        break;
    case CCMR1:
    case CCMR2:
    case CCMR3:
        keep(offset, value);
        for (int channel = 0; channel < channels; channel++) {
            const unsigned mode = output_mode(channel);
            require(mode == 0 || mode == 6 || mode == 7, offset, value,
                    "OCxM: only frozen, PWM mode 1 and PWM mode 2 are modelled");
        }
        break;
    case CCER:
    case CR2:
    case AF1:
        keep(offset, value);
        if (outputs_enabled() && on_outputs_enabled) {
            on_outputs_enabled();
        }
        check_break();
        break;
    case BDTR:
        break_and_dead_time(value);
        break;
    case RCR:
        keep(offset, value);
        repetition_ = rcr_fills_while_stopped && !counting() ? value : repetition_;
        break;
    default:
        keep(offset, value);
    }
    schedule_compare();
    schedule_trigger();
    interrupt();
}

void AdvancedTimer::compare(int channel, std::uint32_t offset, std::uint32_t value)
{
    at(offset) = value;
    if (!preloaded(channel)) {
        require(channel >= legs || !outputs_enabled(), offset, value,
                "compare of a leg changed without preload while MOE is set");
        active_[static_cast<std::size_t>(channel)] = value;
    }
}

void AdvancedTimer::control(std::uint32_t value)
{
    const bool was = counting();
    require(!was || ((at(CR1) ^ value) & 0x60u) == 0, CR1, value, "CMS changed while counting");
    require((value & CEN) == 0 || field(value, 5, 2) != 0, CR1, value,
            "edge-aligned counting is not modelled (CMS = 0)");
    require((value & CEN) == 0 || was || (value & DIR) == 0, CR1, value,
            "started downwards: not modelled");
    if (was && (value & CEN) == 0) {
        refuse(CR1, value, "stopped while counting: not modelled");
    }
    keep(CR1, value & ~DIR);
    if (!was && (value & CEN) != 0) {
        start();
    }
}

void AdvancedTimer::start()
{
    up_ = true;
    origin_ = chip_.now();
    flags_until_ = origin_;
    chip_.schedule(turning_event_, origin_ + Ticks{reload_} * count_ticks());
    const unsigned mode = field(at(CR2), 4, 3);
    if (mode == 1) {
        triggers_.edge(Trigger::tim1, TriggerEdge::rising);
    }
}

/* Overflow at the peak, underflow at the valley; each takes one from the repetition counter. */
void AdvancedTimer::turning_point()
{
    const bool peak = up_;
    take_flags();
    if (!peak) {
        origin_ = chip_.now(); /* with the values in force until now */
    } else {
        counters.peaks++;
        if (on_peak) {
            on_peak();
        }
    }
    up_ = !up_;
    if (repetition_ > 0) {
        repetition_--;
    } else if ((at(CR1) & UDIS) == 0) {
        update(peak);
        at(SR) |= UIF;
    }
    const Ticks half = Ticks{reload_} * count_ticks();
    if (peak) {
        origin_ = chip_.now() - half;
    }
    chip_.schedule(turning_event_, chip_.now() + half);
    schedule_compare();
    schedule_trigger();
    interrupt();
}

/* The update event: preload registers into the active ones. */
void AdvancedTimer::update(bool at_peak)
{
    prescaler_ = at(PSC);
    reload_ = at(ARR);
    repetition_ = at(RCR);
    for (int channel = 0; channel < channels; channel++) {
        active_[static_cast<std::size_t>(channel)] = at(compare_offset[channel]);
    }
    counters.last_load = chip_.now();
    if (counting()) {
        (at_peak ? counters.updates_at_peak : counters.updates_at_valley)++;
    }
    if (bit(at(BDTR), 14) && !break_active()) {
        at(BDTR) |= 1u << 15; /* AOE */
        if (on_outputs_enabled) {
            on_outputs_enabled();
        }
    }
    if (field(at(CR2), 4, 3) == 2) {
        triggers_.pulse(Trigger::tim1);
    }
    if (field(at(CR2), 20, 4) == 2) {
        triggers_.pulse(Trigger::tim1_2);
    }
}

void AdvancedTimer::generate(std::uint32_t value)
{
    if (bit(value, 0)) {
        require(!counting(), EGR, value, "UG while counting: not modelled");
        if ((at(CR1) & UDIS) == 0) {
            update(false);
            if ((at(CR1) & URS) == 0) {
                at(SR) |= UIF;
            }
        }
        frozen_ = 0;
        if (field(at(CR2), 4, 3) == 0) {
            triggers_.pulse(Trigger::tim1);
        }
    }
    if (bit(value, 7)) {
        at(BDTR) &= ~(1u << 15);
        at(SR) |= 1u << 7;
        counters.breaks++;
    }
}

void AdvancedTimer::interrupt()
{
    const std::uint32_t pending = at(SR) & at(DIER);
    chip_.interrupt(line_break, (pending & 0x80u) != 0);
    chip_.interrupt(line_update, (pending & UIF) != 0);
    chip_.interrupt(line_compare, (pending & 0x1eu) != 0);
}

} // namespace virtual_board
