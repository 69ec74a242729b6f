/* What a debugger's halt of the core does to the timers; RM0440, DBGMCU and "debug mode" of each.
 */
#include "sil/virtual_board/peripherals/stm32g474_device.h"

namespace virtual_board
{

namespace
{

enum : std::uint32_t { APB1FZR1 = 0x08, APB2FZR = 0x10 };
constexpr unsigned stop_tim1 = 11; /* of APB2FZR */

struct Stop {
    Trigger timer;
    std::uint32_t offset;
    unsigned position;
};
constexpr Stop stops[] = {{Trigger::tim2, APB1FZR1, 0}, {Trigger::tim3, APB1FZR1, 1},
                          {Trigger::tim4, APB1FZR1, 2}, {Trigger::tim6, APB1FZR1, 4},
                          {Trigger::tim7, APB1FZR1, 5}, {Trigger::tim15, APB2FZR, 16}};

} // namespace

/* While the count stands, time passes it by: its origin moves with it. */
void AdvancedTimer::hold(bool held)
{
    if (held && counting() && held_since_ == Event::never) {
        take_flags();
        held_since_ = chip_.now();
        for (Event *event : {&turning_event_, &compare_event_, &trigger_event_}) {
            chip_.schedule(*event, Event::never);
        }
    } else if (!held && held_since_ != Event::never) {
        const Ticks passed = chip_.now() - held_since_;
        const Ticks half = Ticks{reload_} * count_ticks();
        held_since_ = Event::never;
        origin_ += passed;
        flags_until_ += passed;
        chip_.schedule(turning_event_, origin_ + (up_ ? half : 2 * half));
        schedule_compare();
        schedule_trigger();
    }
}

void Timer::hold(bool held)
{
    const bool counts_time = counting() && !(kind_.general && encoder_mode());
    come_promptly();
    if (held && counts_time && held_since_ == Event::never) {
        take_flags();
        held_since_ = chip_.now();
        chip_.schedule(overflow_event_, Event::never);
        chip_.schedule(compare_event_, Event::never);
    } else if (!held && held_since_ != Event::never) {
        const Ticks passed = chip_.now() - held_since_;
        held_since_ = Event::never;
        origin_ += passed;
        flags_until_ += passed;
        chip_.schedule(overflow_event_, origin_ + (Ticks{top()} + 1) * count_ticks());
        schedule_compare();
    }
}

void Stm32g474Device::halt(bool halted)
{
    const auto stops_at_halt = [this](std::uint32_t offset, unsigned position) {
        return bit(dbgmcu_->read(offset, 4, Master::core), position);
    };
    if (!halted || stops_at_halt(APB2FZR, stop_tim1)) {
        tim1_.hold(halted);
    }
    for (const Stop &stop : stops) {
        if (!halted || stops_at_halt(stop.offset, stop.position)) {
            timer(stop.timer).hold(halted);
        }
    }
}

} // namespace virtual_board
