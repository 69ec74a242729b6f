/* SysTick and the cycle counter of the DWT (ARMv7-M ARM, B3.3 and C1.8). */
#ifndef STEADYSTEP_VIRTUAL_BOARD_CORE_TIMERS_H
#define STEADYSTEP_VIRTUAL_BOARD_CORE_TIMERS_H

#include <cstdint>

#include "sil/virtual_board/interrupt_controller.h"

namespace virtual_board
{

class CoreTimers
{
  public:
    CoreTimers(Chip &chip, InterruptController &interrupts);

    /* Whether an address is a register of these; absolute. */
    static bool owns(std::uint32_t address);
    std::uint32_t read(std::uint32_t address);
    void write(std::uint32_t address, std::uint32_t value);
    void reset();
    /* The clock is about to change. */
    void clock_changes();

  private:
    std::uint32_t cycle_count() const;
    void tick();
    void start_tick(std::uint32_t control);
    std::uint32_t tick_value() const;
    Ticks tick_cycle() const;

    Chip &chip_;
    InterruptController &interrupts_;
    std::uint32_t debug_ = 0, trace_ = 0; /* DEMCR, DWT_CTRL */
    std::uint64_t count_ = 0;             /* at count_since_ */
    Ticks count_since_ = 0;
    std::uint32_t tick_control_ = 0, tick_reload_ = 0;
    bool tick_counted_ = false;
    Event tick_event_;
};

} // namespace virtual_board

#endif
