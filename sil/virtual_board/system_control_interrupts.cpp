/* The registers of the NVIC: a bit per interrupt in banks, a byte of priority per exception. */
#include "sil/virtual_board/system_control.h"

#include <string>

namespace virtual_board
{

namespace
{

/* Addresses, ARMv7-M ARM tables B3-4 and B3-8. */
enum : std::uint32_t {
    NVIC_ISER = 0xe000e100,
    NVIC_ICER = 0xe000e180,
    NVIC_ISPR = 0xe000e200,
    NVIC_ICPR = 0xe000e280,
    NVIC_IABR = 0xe000e300,
    NVIC_IPR = 0xe000e400,
    SHPR1 = 0xe000ed18,
    SHPR_END = 0xe000ed24
};

constexpr std::uint32_t bank_bytes = 0x20; /* of the registers with one bit per interrupt */

bool in(std::uint32_t address, std::uint32_t first, std::uint32_t length)
{
    return address - first < length;
}

} // namespace

/* One byte of priority per exception: interrupts, then the system handlers 4...15. */
bool SystemControl::is_priority(std::uint32_t address) const
{
    return in(address, NVIC_IPR, description_.core.interrupt_lines) ||
           in(address, SHPR1, SHPR_END - SHPR1);
}

unsigned SystemControl::exception_of_priority(std::uint32_t address) const
{
    return in(address, SHPR1, SHPR_END - SHPR1) ? exception::memory_fault + (address - SHPR1)
                                                : exception::first_interrupt + (address - NVIC_IPR);
}

void SystemControl::write_priorities(std::uint32_t address, unsigned size, std::uint32_t value)
{
    if (!full() && size != 4) {
        chip_.fail("priorities of a Cortex-M0+ are written as whole words only");
    }
    for (unsigned i = 0; i < size; ++i) {
        if (is_priority(address + i)) {
            interrupts_.set_priority(exception_of_priority(address + i), value >> (8 * i) & 0xff);
        }
    }
}

bool SystemControl::is_interrupts(std::uint32_t address) const
{
    for (const std::uint32_t bank : {NVIC_ISER, NVIC_ICER, NVIC_ISPR, NVIC_ICPR, NVIC_IABR}) {
        if (in(address, bank, bank_bytes)) {
            return true;
        }
    }
    return is_priority(address);
}

std::uint32_t SystemControl::interrupt_bits(std::uint32_t word,
                                            bool (InterruptController::*is)(unsigned) const) const
{
    std::uint32_t bits = 0;
    for (unsigned i = 0; i < 32; ++i) {
        const unsigned line = word * 32 + i;
        if (line < description_.core.interrupt_lines &&
            (interrupts_.*is)(exception::first_interrupt + line)) {
            bits |= 1u << i;
        }
    }
    return bits;
}

std::uint32_t SystemControl::read_interrupts(std::uint32_t address) const
{
    const std::uint32_t word = (address % bank_bytes) / 4;
    if (in(address, NVIC_ISER, bank_bytes) || in(address, NVIC_ICER, bank_bytes)) {
        return interrupt_bits(word, &InterruptController::enabled);
    }
    if (in(address, NVIC_ISPR, bank_bytes) || in(address, NVIC_ICPR, bank_bytes)) {
        return interrupt_bits(word, &InterruptController::pending);
    }
    if (in(address, NVIC_IABR, bank_bytes)) {
        return interrupt_bits(word, &InterruptController::active);
    }
    std::uint32_t priorities = 0;
    for (unsigned i = 0; i < 4 && is_priority(address + i); ++i) {
        priorities |= interrupts_.priority(exception_of_priority(address + i)) << (8 * i);
    }
    return priorities;
}

void SystemControl::write_interrupts(std::uint32_t address, std::uint32_t value)
{
    const std::uint32_t first_line = (address % bank_bytes) / 4 * 32;
    const auto each = [&](auto act) {
        for (unsigned i = 0; i < 32; ++i) {
            if ((value >> i & 1) == 0) {
                continue;
            }
            if (first_line + i >= description_.core.interrupt_lines) {
                chip_.fail("interrupt " + std::to_string(first_line + i) + " does not exist");
            }
            act(exception::first_interrupt + first_line + i);
        }
    };
    if (in(address, NVIC_ISER, bank_bytes)) {
        each([&](unsigned exception) { interrupts_.set_enabled(exception, true); });
        return;
    }
    if (in(address, NVIC_ICER, bank_bytes)) {
        each([&](unsigned exception) { interrupts_.set_enabled(exception, false); });
        return;
    }
    if (in(address, NVIC_ISPR, bank_bytes)) {
        each([&](unsigned exception) { interrupts_.set_pending(exception); });
        return;
    }
    if (in(address, NVIC_ICPR, bank_bytes)) {
        each([&](unsigned exception) { interrupts_.clear_pending(exception); });
        return;
    }
    refuse("write", address);
}

} // namespace virtual_board
