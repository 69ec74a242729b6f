#include "sil/virtual_board/core_timers.h"

namespace virtual_board
{

namespace
{

enum : std::uint32_t {
    DWT_CTRL = 0xe0001000,
    DWT_CYCCNT = 0xe0001004,
    SYST_CSR = 0xe000e010,
    SYST_RVR = 0xe000e014,
    SYST_CVR = 0xe000e018,
    SYST_CALIB = 0xe000e01c,
    DEMCR = 0xe000edfc
};

constexpr std::uint32_t trace_enable = 1u << 24, count_enable = 1u;
constexpr std::uint32_t tick_enable = 1u, tick_interrupt = 2u, tick_core_clock = 4u;

} // namespace

CoreTimers::CoreTimers(Chip &chip, InterruptController &interrupts)
    : chip_(chip), interrupts_(interrupts), tick_event_([this] { tick(); })
{
}

bool CoreTimers::owns(std::uint32_t address)
{
    return address == DWT_CTRL || address == DWT_CYCCNT || address == DEMCR ||
           (address >= SYST_CSR && address <= SYST_CALIB);
}

void CoreTimers::reset()
{
    debug_ = 0;
    trace_ = 0x40000000; /* four comparators, none of which is modelled */
    count_ = 0;
    tick_control_ = tick_reload_ = 0;
    tick_counted_ = false;
    if (tick_event_.at != Event::never) {
        chip_.schedule(tick_event_, Event::never);
    }
}

std::uint32_t CoreTimers::read(std::uint32_t address)
{
    switch (address) {
    case DEMCR:
        return debug_;
    case DWT_CTRL:
        return trace_;
    case DWT_CYCCNT:
        return cycle_count();
    case SYST_CSR: {
        const std::uint32_t flag = tick_counted_ ? 1u << 16 : 0;
        tick_counted_ = false;
        return tick_control_ | flag;
    }
    case SYST_RVR:
        return tick_reload_;
    case SYST_CVR:
        return tick_value();
    default: /* SYST_CALIB: nothing is known */
        return 0;
    }
}

void CoreTimers::write(std::uint32_t address, std::uint32_t value)
{
    switch (address) {
    case DEMCR:
        debug_ = value & trace_enable;
        return;
    case DWT_CTRL:
        if ((debug_ & trace_enable) == 0) {
            chip_.fail("DWT_CTRL written while DEMCR.TRCENA is clear");
        }
        count_ = cycle_count();
        count_since_ = chip_.now();
        trace_ = (trace_ & ~count_enable) | (value & count_enable);
        return;
    case DWT_CYCCNT:
        count_ = value;
        count_since_ = chip_.now();
        return;
    case SYST_CSR:
        start_tick(value & (tick_enable | tick_interrupt | tick_core_clock));
        return;
    case SYST_RVR:
        tick_reload_ = value & 0xffffff;
        return;
    case SYST_CVR:
        tick_counted_ = false;
        start_tick(tick_control_);
        return;
    default:
        chip_.fail("SYST_CALIB is read-only");
    }
}

std::uint32_t CoreTimers::cycle_count() const
{
    const bool counts = (trace_ & count_enable) != 0;
    const std::uint64_t passed =
        counts ? (chip_.now() - count_since_) / chip_.core_cycle() : std::uint64_t{0};
    return static_cast<std::uint32_t>(count_ + passed);
}

void CoreTimers::clock_changes()
{
    count_ = cycle_count();
    count_since_ = chip_.now();
    if ((tick_control_ & tick_enable) != 0) {
        chip_.fail("the clock changes while SysTick counts, which is not modelled");
    }
}

/* CLKSOURCE: the core's clock, or an eighth of it (RM0440, 10.1). */
Ticks CoreTimers::tick_cycle() const
{
    return chip_.core_cycle() * ((tick_control_ & tick_core_clock) != 0 ? 1 : 8);
}

void CoreTimers::start_tick(std::uint32_t control)
{
    tick_control_ = control;
    const bool counts = (control & tick_enable) != 0 && tick_reload_ != 0;
    chip_.schedule(tick_event_,
                   counts ? chip_.now() + (tick_reload_ + 1) * tick_cycle() : Event::never);
}

void CoreTimers::tick()
{
    tick_counted_ = true;
    if ((tick_control_ & tick_interrupt) != 0) {
        interrupts_.set_pending(exception::system_tick);
    }
    start_tick(tick_control_);
}

std::uint32_t CoreTimers::tick_value() const
{
    if (tick_event_.at == Event::never) {
        return 0;
    }
    return static_cast<std::uint32_t>((tick_event_.at - chip_.now()) / tick_cycle());
}

} // namespace virtual_board
