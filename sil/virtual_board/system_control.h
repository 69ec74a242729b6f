/*
 * The core's own registers at 0xE000E000 and its cycle counter: NVIC, SCB, SysTick, FPU, DWT
 * (ARMv7-M ARM, B3 and C1). What is not modelled (MPU, ITM, breakpoints) is refused.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_SYSTEM_CONTROL_H
#define STEADYSTEP_VIRTUAL_BOARD_SYSTEM_CONTROL_H

#include <cstdint>

#include "sil/virtual_board/core_timers.h"

namespace virtual_board
{

/* Bits of CFSR and HFSR that a fault leaves. */
enum : std::uint32_t {
    fault_bus_precise = 1u << 9,
    fault_bus_address_valid = 1u << 15,
    fault_bus_fetch = 1u << 8,
    fault_undefined_instruction = 1u << 16,
    fault_unaligned = 1u << 24,
    fault_forced = 1u << 30
};

class SystemControl : public Peripheral
{
  public:
    static constexpr std::uint32_t base = 0xe0000000, bytes = 0x100000;

    SystemControl(Chip &chip, const ChipDescription &description, InterruptController &interrupts);

    std::uint32_t read(std::uint32_t offset, unsigned bytes, Master master) override;
    void write(std::uint32_t offset, unsigned bytes, std::uint32_t value, Master master) override;
    void reset() override;

    /* The clock is about to change. */
    void clock_changes()
    {
        timers_.clock_changes();
    }

    std::uint32_t vector_table() const
    {
        return vector_table_ == 0 ? description_.flash.base : vector_table_;
    }
    bool floating_point_allowed() const
    {
        return (coprocessors_ & 0x00f00000) == 0x00f00000;
    }
    /* FPCCR.ASPEN: an exception keeps S0...S15 if they are in use. */
    bool keeps_floating_point() const
    {
        return (floating_point_control_ & 0x80000000) != 0;
    }
    bool aligns_stack() const
    {
        return (configuration_ & 1u << 9) != 0;
    }
    bool deep_sleep() const
    {
        return (system_control_ & 1u << 2) != 0;
    }
    bool sleeps_on_exit() const
    {
        return (system_control_ & 1u << 1) != 0;
    }
    void record_fault(std::uint32_t configurable, bool escalated);

  private:
    std::uint32_t read_word(std::uint32_t address);
    void write_word(std::uint32_t address, std::uint32_t value);
    std::uint32_t interrupt_bits(std::uint32_t word,
                                 bool (InterruptController::*is)(unsigned) const) const;
    bool is_interrupts(std::uint32_t address) const;
    std::uint32_t read_interrupts(std::uint32_t address) const;
    void write_interrupts(std::uint32_t address, std::uint32_t value);
    void write_priorities(std::uint32_t address, unsigned size, std::uint32_t value);
    void control_state(std::uint32_t value);
    void request_reset(std::uint32_t value);
    std::uint32_t control_state() const;
    bool is_priority(std::uint32_t address) const;
    unsigned exception_of_priority(std::uint32_t address) const;
    bool full() const
    {
        return description_.core.architecture == Architecture::armv7em;
    }

    [[noreturn]] void refuse(const char *what, std::uint32_t address) const;

    Chip &chip_;
    const ChipDescription &description_;
    InterruptController &interrupts_;

    std::uint32_t vector_table_ = 0, system_control_ = 0, configuration_ = 0, grouping_ = 0;
    std::uint32_t coprocessors_ = 0, floating_point_control_ = 0;
    std::uint32_t configurable_faults_ = 0, hard_faults_ = 0, fault_address_ = 0;

    CoreTimers timers_;
};

} // namespace virtual_board

#endif
