#include "sil/virtual_board/peripherals/timer.h"

namespace virtual_board
{

namespace
{

enum : std::uint32_t {
    CR1 = 0x00,
    CR2 = 0x04,
    SMCR = 0x08,
    DIER = 0x0c,
    SR = 0x10,
    EGR = 0x14,
    CCMR1 = 0x18,
    CCMR2 = 0x1c,
    CCER = 0x20,
    CNT = 0x24,
    PSC = 0x28,
    ARR = 0x2c,
    CCR1 = 0x34,
    CCR3 = 0x3c,
    CCR4 = 0x40
};
enum : std::uint32_t { CEN = 1u << 0, UDIS = 1u << 1, URS = 1u << 2, OPM = 1u << 3 };
enum : std::uint32_t { ARPE = 1u << 7, UIF = 1u << 0, TIF = 1u << 6 };
enum : std::uint32_t { CC3IF = 1u << 3, CC3OF = 1u << 11 };

std::vector<Register> registers(const TimerKind &kind)
{
    const std::uint32_t top = kind.wide ? 0xffffffffu : 0xffffu;
    std::vector<Register> table = {
        {CR1, "CR1", kind.general ? 0x8fu | 0x300u : 0x8fu, 0, 0, true},
        {CR2, "CR2", 0x70},
        {DIER, "DIER", kind.general ? 0x1fu : 0x1u},
        {SR, "SR", 0, 0, 0xffffffff},
        {EGR, "EGR", 0x1, 0, 0, true},
        {CNT, "CNT", top, 0, 0, true},
        {PSC, "PSC", 0xffff, 0, 0, true},
        {ARR, "ARR", top, top, 0, true},
    };
    if (kind.general) {
        table.push_back({SMCR, "SMCR", 0x3100f7});
        table.push_back({CCMR1, "CCMR1", 0xfbfb});
        table.push_back({CCMR2, "CCMR2", 0xfbfb});
        for (std::uint32_t i = 0; i < 4; i++) {
            static const char *const names[4] = {"CCR1", "CCR2", "CCR3", "CCR4"};
            table.push_back({CCR1 + 4 * i, names[i], top});
        }
        table.push_back({CCER, "CCER", 0xbbbb});
        table.push_back({0x5c, "TISEL", 0});
    }
    return table;
}

/* Timer on the internal trigger input; the same numbers in all timers of the G4. */
constexpr Trigger internal_triggers[4] = {Trigger::tim1, Trigger::tim2, Trigger::tim3,
                                          Trigger::tim4};

constexpr unsigned most_late = 32; /* overflows; nearly twice those of a PWM period */

} // namespace

Timer::Timer(Chip &chip, const TimerKind &kind, Triggers &triggers, std::function<Ticks()> clock)
    : RegisterBlock(chip, kind.name, registers(kind)), kind_(kind), triggers_(triggers),
      clock_(std::move(clock)), overflow_event_([this] { overflow(); }),
      trigger_event_([this] { act_on_trigger(); }), compare_event_([this] {
          take_flags();
          schedule_compare();
          interrupt();
      })
{
    reload_ = at(ARR);
    if (kind_.general) {
        triggers_in_ = &triggers_.listen(
            [this](Trigger source, TriggerEdge edge) { triggered(source, edge); });
        triggers_.choose(*triggers_in_, 0); /* until the slave controller is set to one */
    }
}

void Timer::reset()
{
    RegisterBlock::reset();
    prescaler_ = 0;
    reload_ = at(ARR);
    frozen_ = 0;
    updates_ = 0;
    late_period_ = 0; /* those that are late are lost with what they would have started */
    triggers_.end_late(kind_.output);
    held_since_ = Event::never;
    compare_.fill(0);
    compare_flags_ = 0x1e;
    if (kind_.general) {
        triggers_.choose(*triggers_in_, 0);
    }
    chip_.schedule(compare_event_, Event::never);
    chip_.schedule(overflow_event_, Event::never);
    chip_.schedule(trigger_event_, Event::never);
    interrupt();
}

Ticks Timer::count_ticks() const
{
    return clock_() * (prescaler_ + 1);
}

std::uint32_t Timer::count() const
{
    if (!counting()) {
        return frozen_;
    }
    if (kind_.general && encoder_mode()) {
        return count_at(encoder());
    }
    return static_cast<std::uint32_t>((chip_.now() - origin_) / count_ticks() % (Ticks{top()} + 1));
}

std::uint32_t Timer::count_at(std::int32_t position) const
{
    const std::int64_t turns = std::int64_t{top()} + 1;
    const std::int64_t moved = std::int64_t{position} - encoder_origin_;
    const std::int64_t within = (std::int64_t{frozen_} + moved) % turns;
    return static_cast<std::uint32_t>(within < 0 ? within + turns : within);
}

std::uint32_t Timer::fetch(std::uint32_t offset, Master)
{
    if (offset == SR) {
        catch_up(chip_.now());
        take_flags();
    }
    if (kind_.general && (offset == CCR3 || offset == CCR4) && !output(offset == CCR3 ? 2 : 3)) {
        at(SR) &= ~(offset == CCR3 ? CC3IF : CC3IF << 1);
        interrupt();
    }
    require(offset != CNT || !counting() || !kind_.general || !encoder_mode() || !encoder_routed ||
                encoder_routed(),
            offset, 0, "read in encoder mode while the encoder's pins are not routed to the timer");
    return offset == CNT ? count() : offset == EGR ? 0 : at(offset);
}

void Timer::put(std::uint32_t offset, std::uint32_t value, Master)
{
    come_promptly();
    take_flags();
    switch (offset) {
    case CR1:
        control(value);
        return;
    case CR2: {
        const unsigned mode = field(value, 4, 3);
        require(mode <= 2, offset, value, "MMS: only reset, enable and update are modelled");
        keep(offset, value);
        return;
    }
    case SMCR:
        slave_mode(value);
        return;
    case DIER:
        require(value == 0 || kind_.interrupt_line >= 0, offset, value,
                "this interrupt shares its line with TIM1 break: not modelled");
        keep(offset, value);
        schedule_compare();
        interrupt();
        return;
    case SR:
        at(SR) &= value;
        interrupt();
        return;
    case EGR:
        if ((value & 1u) != 0) {
            update(true);
        }
        return;
    case CNT:
        require(value <= top(), offset, value, "above ARR");
        frozen_ = value;
        encoder_origin_ = encoder ? encoder() : 0;
        if (counting() && !(kind_.general && encoder_mode())) {
            origin_ = chip_.now() - value * count_ticks();
            chip_.schedule(overflow_event_, origin_ + (Ticks{top()} + 1) * count_ticks());
            schedule_compare();
        }
        return;
    case ARR:
        require(value != 0, offset, value, "the counter is blocked while ARR is 0");
        keep(offset, value);
        if ((at(CR1) & ARPE) == 0 && reload_ != value) {
            require(!counting(), offset, value, "changed without preload while counting");
            reload_ = value;
        }
        return;
    default:
        keep(offset, value);
        compare_flags_ = 0;
        for (unsigned channel = 0; kind_.general && channel < 4; channel++) {
            compare_flags_ |= output(static_cast<int>(channel)) ? 2u << channel : 0u;
        }
        if (kind_.general && offset >= CCR1 && offset <= CCR4) {
            const unsigned channel = (offset - CCR1) / 4;
            const std::uint32_t mode = at(channel < 2 ? CCMR1 : CCMR2);
            if (!bit(mode, channel % 2 == 0 ? 3 : 11)) {
                compare_[channel] = value;
            }
            schedule_compare();
        }
    }
}

void Timer::control(std::uint32_t value)
{
    const bool was = counting();
    if (was && (value & CEN) == 0) {
        stop();
    }
    keep(CR1, value);
    if (!was && (value & CEN) != 0) {
        at(CR1) &= ~CEN;
        start();
    }
}

void Timer::slave_mode(std::uint32_t value)
{
    const unsigned mode = field(value, 0, 3) | (bit(value, 16) ? 8u : 0u);
    const unsigned input = field(value, 4, 3) | field(value, 20, 2) << 3;
    require(mode == 0 || mode == 3 || mode == 4 || mode == 6, SMCR, value,
            "SMS: only off, encoder 3, reset and trigger are modelled");
    require(mode == 0 || mode == 3 || input < 4, SMCR, value,
            "TS: only the internal triggers of TIM1...TIM4 are modelled");
    require(mode != 3 || encoder, SMCR, value, "no encoder is wired to this timer");
    require(!counting() || (at(SMCR) & 0x10007u) == (value & 0x10007u), SMCR, value,
            "slave mode changed while counting");
    keep(SMCR, value);
    triggers_.choose(*triggers_in_,
                     mode == 4 || mode == 6 ? only(internal_triggers[input & 3u]) : 0);
}

void Timer::start()
{
    at(CR1) |= CEN;
    if (kind_.general && encoder_mode()) {
        require(field(at(CCMR1), 0, 2) == 1 && field(at(CCMR1), 8, 2) == 1, CCMR1, at(CCMR1),
                "encoder mode needs CC1S = 1 and CC2S = 1");
        require((at(CCER) & 0xaau) == 0, CCER, at(CCER), "inverted encoder inputs: not modelled");
        require(prescaler_ == 0, PSC, prescaler_, "encoder mode: expected no prescaler");
        encoder_origin_ = encoder();
        return;
    }
    origin_ = chip_.now() - frozen_ * count_ticks();
    flags_until_ = chip_.now();
    schedule_compare();
    chip_.schedule(overflow_event_, origin_ + (Ticks{top()} + 1) * count_ticks());
    if (field(at(CR2), 4, 3) == 1) {
        triggers_.edge(kind_.output, TriggerEdge::rising);
    }
}

void Timer::stop()
{
    frozen_ = count();
    chip_.schedule(overflow_event_, Event::never);
    chip_.schedule(compare_event_, Event::never);
    if (field(at(CR2), 4, 3) == 1) {
        triggers_.edge(kind_.output, TriggerEdge::falling);
    }
}

/* Whether nobody can see when an overflow comes, but those that let it come late. */
bool Timer::may_be_late(Ticks period) const
{
    return at(DIER) == 0 && field(at(CR2), 4, 3) == 2 && (at(CR1) & UDIS) == 0 &&
           field(at(SMCR), 0, 3) != 4 && triggers_.all_patient(kind_.output, period);
}

/* What as many overflows would have done one by one. UIF is set since the last that was an event,
   and the compares that match do so in the whole period behind it. */
void Timer::catch_up(Ticks until)
{
    const Ticks first = origin_ + late_period_;
    if (late_period_ == 0 || first > until) {
        return;
    }
    const auto count = static_cast<unsigned>((until - first) / late_period_ + 1);
    take_flags(first);
    origin_ = first + (count - 1) * late_period_;
    flags_until_ = origin_;
    updates_ += count;
    triggers_.hand_on_late(kind_.output, first, late_period_, count);
}

void Timer::come_promptly()
{
    if (late_period_ > 0) {
        catch_up(chip_.now());
        chip_.schedule(overflow_event_, origin_ + late_period_);
        late_period_ = 0;
        triggers_.end_late(kind_.output);
    }
}

std::uint64_t Timer::updates()
{
    catch_up(chip_.now());
    return updates_;
}

void Timer::overflow()
{
    if (late_period_ > 0) {
        catch_up(chip_.now());
        chip_.schedule(overflow_event_, origin_ + most_late * late_period_);
        return;
    }
    take_flags();
    origin_ = chip_.now();
    flags_until_ = origin_ - 1; /* a compare of 0 matches now */
    if ((at(CR1) & OPM) != 0) {
        at(CR1) &= ~CEN;
        frozen_ = 0;
    }
    update(false);
    if (counting()) {
        const Ticks period = (Ticks{top()} + 1) * count_ticks();
        const bool late = may_be_late(period);
        if (late) {
            late_period_ = period;
            triggers_.begin_late(kind_.output, *this);
        }
        chip_.schedule(overflow_event_, origin_ + (late ? most_late : 1) * period);
        take_flags();
        schedule_compare();
        interrupt();
    }
}

/* The update event; by UG or the slave controller it also clears the count. */
void Timer::update(bool by_software)
{
    const bool disabled = (at(CR1) & UDIS) != 0;
    if (!disabled) {
        prescaler_ = at(PSC);
        reload_ = at(ARR);
        if (kind_.general) {
            compare_ = {at(CCR1), at(CCR1 + 4), at(CCR1 + 8), at(CCR1 + 12)};
        }
        updates_++;
    }
    if (by_software) {
        frozen_ = 0;
        encoder_origin_ = encoder ? encoder() : 0;
        if (counting() && !(kind_.general && encoder_mode())) {
            origin_ = chip_.now();
            chip_.schedule(overflow_event_, origin_ + (Ticks{top()} + 1) * count_ticks());
        }
    }
    if (!disabled && !(by_software && (at(CR1) & URS) != 0)) {
        at(SR) |= UIF;
        interrupt();
    }
    const unsigned mode = field(at(CR2), 4, 3);
    if ((mode == 2 && !disabled) || (mode == 0 && by_software)) {
        triggers_.pulse(kind_.output);
    }
}

void Timer::triggered(Trigger source, TriggerEdge edge)
{
    const unsigned mode = field(at(SMCR), 0, 3);
    const unsigned input = field(at(SMCR), 4, 3);
    if (edge != TriggerEdge::rising || (mode != 4 && mode != 6) ||
        internal_triggers[input & 3u] != source || !clocked()) {
        return;
    }
    chip_.schedule(trigger_event_, chip_.now() + slave_delay_cycles * clock_());
}

void Timer::act_on_trigger()
{
    at(SR) |= TIF;
    if (field(at(SMCR), 0, 3) == 4) {
        update(true);
    } else if (!counting()) {
        start();
    }
}

void Timer::interrupt()
{
    if (kind_.interrupt_line >= 0) {
        chip_.interrupt(static_cast<unsigned>(kind_.interrupt_line),
                        (at(SR) & at(DIER) & 0x1fu) != 0);
    }
}

} // namespace virtual_board
