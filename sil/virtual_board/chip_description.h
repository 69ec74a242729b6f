/*
 * The chips that the virtual board knows, as data: the core, the memories and where code is meant
 * to run. Peripherals are a Device's own (chip.h).
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_CHIP_DESCRIPTION_H
#define STEADYSTEP_VIRTUAL_BOARD_CHIP_DESCRIPTION_H

#include <cstdint>
#include <vector>

#include "sil/virtual_board/chip.h"

namespace virtual_board
{

enum class Architecture { armv6m, armv7em };

/* A core, and what its exceptions cost in cycles with memory of no wait states. */
struct CoreModel {
    const char *name;
    Architecture architecture;
    bool floating_point;
    unsigned priority_bits;
    unsigned interrupt_lines;
    unsigned entry_cycles, exit_cycles, tail_chain_cycles;
    unsigned floating_point_frame_cycles; /* more, to store or restore S0...S15 and FPSCR */
};

struct MemoryRange {
    const char *name;
    std::uint32_t base, bytes;
    std::uint32_t alias; /* a second address of the same memory; 0: none */
};

struct AddressRange {
    std::uint32_t base, bytes;

    bool contains(std::uint32_t address) const
    {
        return address - base < bytes;
    }
};

struct ChipDescription {
    const char *name;
    CoreModel core;
    std::vector<MemoryRange> ram;
    AddressRange flash;      /* where the vector table lies after reset */
    AddressRange data_flash; /* part of it that is read and programmed, never run */
    AddressRange fast_code;  /* zero-wait memory that the control interrupt must run from; 0 bytes:
                                the chip has none */
    unsigned control_line;   /* of the interrupt that the converter's end raises */
    Ticks waking_core_cycle; /* of the clock after reset */
};

/* STM32G474RE: RM0440 section 2 (memory), Arm DDI 0439 (Cortex-M4). */
const ChipDescription &stm32g474();
/* STM32G071RB: RM0444 section 2, Arm DDI 0484 (Cortex-M0+). */
const ChipDescription &stm32g071();

} // namespace virtual_board

#endif
