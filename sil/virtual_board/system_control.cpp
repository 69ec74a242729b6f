#include "sil/virtual_board/system_control.h"

#include <cstdio>
#include <cstdlib>
#include <string>

namespace virtual_board
{

namespace
{

/* Addresses, ARMv7-M ARM tables B3-3 to B3-8 and C1-11. */
enum : std::uint32_t {
    ICTR = 0xe000e004,
    ACTLR = 0xe000e008,
    CPUID = 0xe000ed00,
    ICSR = 0xe000ed04,
    VTOR = 0xe000ed08,
    AIRCR = 0xe000ed0c,
    SCR = 0xe000ed10,
    CCR = 0xe000ed14,
    SHCSR = 0xe000ed24,
    CFSR = 0xe000ed28,
    HFSR = 0xe000ed2c,
    DFSR = 0xe000ed30,
    MMFAR = 0xe000ed34,
    BFAR = 0xe000ed38,
    CPACR = 0xe000ed88,
    MPU_TYPE = 0xe000ed90,
    DHCSR = 0xe000edf0,
    STIR = 0xe000ef00,
    FPCCR = 0xe000ef34,
    FPCAR = 0xe000ef38,
    FPDSCR = 0xe000ef3c
};

constexpr std::uint32_t fault_enables = 7u << 16; /* of SHCSR */
constexpr std::uint32_t key_write = 0x05fau << 16, key_read = 0xfa05u << 16;

} // namespace

SystemControl::SystemControl(Chip &chip, const ChipDescription &description,
                             InterruptController &interrupts)
    : chip_(chip), description_(description), interrupts_(interrupts), timers_(chip, interrupts)
{
    reset();
}

void SystemControl::reset()
{
    interrupts_.reset();
    vector_table_ = system_control_ = grouping_ = coprocessors_ = 0;
    configuration_ = 1u << 9 | (full() ? 0u : 1u << 3);
    floating_point_control_ = 0xc0000000;
    configurable_faults_ = hard_faults_ = fault_address_ = 0;
    timers_.reset();
}

void SystemControl::refuse(const char *what, std::uint32_t address) const
{
    char text[80];
    std::snprintf(text, sizeof text, "%s of 0x%08x, a register of the core that is not modelled",
                  what, static_cast<unsigned>(address));
    chip_.fail(text);
    std::abort(); /* not reached; gcc forgets that a virtual function does not return */
}

std::uint32_t SystemControl::read(std::uint32_t offset, unsigned size, Master master)
{
    const std::uint32_t address = base + offset;
    if (master != Master::core) {
        refuse("DMA access", address);
    }
    const std::uint32_t word = read_word(address & ~3u) >> (8 * (address & 3));
    return size == 4 ? word : word & ((1u << (8 * size)) - 1);
}

void SystemControl::write(std::uint32_t offset, unsigned size, std::uint32_t value, Master master)
{
    const std::uint32_t address = base + offset;
    if (master != Master::core) {
        refuse("DMA access", address);
    }
    if (is_priority(address)) {
        write_priorities(address, size, value);
    } else if (size == 4) {
        write_word(address, value);
    } else if ((address & ~3u) == CFSR) {
        write_word(CFSR, value << (8 * (address & 3)));
    } else {
        refuse("write of a part", address);
    }
}

std::uint32_t SystemControl::read_word(std::uint32_t address)
{
    if (CoreTimers::owns(address)) {
        return timers_.read(address);
    }
    if (is_interrupts(address)) {
        return read_interrupts(address);
    }
    switch (address) {
    case ICTR:
        return (description_.core.interrupt_lines - 1) / 32;
    case ACTLR:
    case DFSR:
    case DHCSR: /* no debugger */
    case FPCAR:
    case FPDSCR:
    case MPU_TYPE:
        return 0;
    case SHCSR: {
        std::uint32_t enables = 0;
        for (unsigned i = 0; i < 3; ++i) {
            enables |= interrupts_.enabled(exception::memory_fault + i) ? 1u << (16 + i) : 0u;
        }
        return enables;
    }
    case CPUID:
        return full() ? 0x410fc241 : 0x410cc601;
    case ICSR:
        return control_state();
    case VTOR:
        return vector_table_;
    case AIRCR:
        return key_read | grouping_ << 8;
    case SCR:
        return system_control_;
    case CCR:
        return configuration_;
    case CFSR:
        return configurable_faults_;
    case HFSR:
        return hard_faults_;
    case MMFAR:
    case BFAR:
        return fault_address_;
    case CPACR:
        return coprocessors_;
    case FPCCR:
        return floating_point_control_;
    default:
        refuse("read", address);
    }
}

void SystemControl::write_word(std::uint32_t address, std::uint32_t value)
{
    if (CoreTimers::owns(address)) {
        timers_.write(address, value);
        return;
    }
    if (is_interrupts(address)) {
        write_interrupts(address, value);
        return;
    }
    switch (address) {
    case ICSR:
        control_state(value);
        return;
    case VTOR:
        vector_table_ = value & 0xffffff80;
        if (vector_table_ != value) {
            chip_.fail("VTOR: the vector table must be aligned to its size");
        }
        return;
    case AIRCR:
        request_reset(value);
        return;
    case SCR:
        system_control_ = value & 0x1e;
        return;
    case CCR:
        if ((value & 1u << 3) != 0 && full()) {
            chip_.fail("CCR.UNALIGN_TRP is not modelled");
        }
        configuration_ = value;
        return;
    case SHCSR:
        if ((value & ~fault_enables) != 0) {
            refuse("write of other bits than the enables", address);
        }
        for (unsigned i = 0; i < 3; ++i) {
            interrupts_.set_enabled(exception::memory_fault + i, (value >> (16 + i) & 1) != 0);
        }
        return;
    case CFSR:
        configurable_faults_ &= ~value;
        return;
    case HFSR:
        hard_faults_ &= ~value;
        return;
    case CPACR:
        coprocessors_ = value;
        return;
    case FPCCR:
        floating_point_control_ = value;
        return;
    case STIR:
        interrupts_.set_pending(exception::first_interrupt + (value & 0x1ff));
        return;
    default:
        refuse("write", address);
    }
}

std::uint32_t SystemControl::control_state() const
{
    const unsigned waiting = interrupts_.next_pending();
    return interrupts_.running() | (waiting << 12) |
           (interrupts_.active_count() == 1 ? 1u << 11 : 0u) |
           (waiting >= exception::first_interrupt ? 1u << 22 : 0u) |
           (interrupts_.pending(exception::system_tick) ? 1u << 26 : 0u) |
           (interrupts_.pending(exception::pend_sv) ? 1u << 28 : 0u);
}

void SystemControl::control_state(std::uint32_t value)
{
    if ((value >> 31 & 1) != 0) {
        interrupts_.set_pending(exception::nmi);
    }
    if ((value >> 28 & 1) != 0) {
        interrupts_.set_pending(exception::pend_sv);
    }
    if ((value >> 27 & 1) != 0) {
        interrupts_.clear_pending(exception::pend_sv);
    }
    if ((value >> 26 & 1) != 0) {
        interrupts_.set_pending(exception::system_tick);
    }
    if ((value >> 25 & 1) != 0) {
        interrupts_.clear_pending(exception::system_tick);
    }
}

void SystemControl::request_reset(std::uint32_t value)
{
    if ((value & 0xffff0000) != key_write) {
        chip_.fail("AIRCR written without its key");
    }
    grouping_ = value >> 8 & 7;
    interrupts_.set_priority_grouping(grouping_);
    if ((value & 1u << 2) != 0) {
        chip_.reset("software");
    }
}

void SystemControl::record_fault(std::uint32_t configurable, bool escalated)
{
    configurable_faults_ |= configurable;
    hard_faults_ |= escalated ? std::uint32_t{fault_forced} : 0u;
}

} // namespace virtual_board
