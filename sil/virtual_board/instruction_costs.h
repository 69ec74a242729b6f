/*
 * What an instruction costs, by address: cycles in three columns, and the stage of the control
 * interrupt that it belongs to. From the image's map (image_map.h); without one, a stand-in.
 *
 *   nominal  the published timings, memory without wait states; this is the time of the simulation
 *   worst    every hazard that the timings name taken, the code in zero-wait memory if it is linked
 *            there
 *   flash    worst, run from flash without cache and prefetch: wait states for every line that a
 *            straight run of instructions touches and for every literal
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_INSTRUCTION_COSTS_H
#define STEADYSTEP_VIRTUAL_BOARD_INSTRUCTION_COSTS_H

#include <cstdint>
#include <string>
#include <vector>

#include "sil/virtual_board/chip_description.h"

namespace virtual_board
{

/* Of a few instructions, or of one control interrupt: 25 s at most. */
struct alignas(16) Cycles {
    std::uint32_t nominal = 0, worst = 0, flash = 0;
    std::uint32_t fourth = 0; /* none: with it, the host adds all of them at once */

    Cycles &operator+=(const Cycles &more)
    {
        nominal += more.nominal;
        worst += more.worst;
        flash += more.flash;
        fourth += more.fourth;
        return *this;
    }
};

/* The same number in each column. */
inline Cycles in_every_column(std::uint64_t cycles)
{
    const std::uint32_t count = static_cast<std::uint32_t>(cycles);
    return {count, count, count};
}

/* Cycles are given twice: if the instruction at the address before was executed right before this
   one, so that the two may overlap, and otherwise. */
struct InstructionCost {
    std::uint8_t bytes = 0; /* 0: nothing is known of this address */
    std::uint8_t nominal_after = 0, nominal = 0;
    std::uint8_t worst_after = 0, worst = 0;
    std::uint8_t literals = 0;    /* constants that it loads from beside the code */
    std::uint8_t stage = 0;       /* index into stages, or inherited_stage */
    std::uint8_t conditional = 0; /* bytes of the IT block that it opens */
};

constexpr std::uint8_t inherited_stage = 255; /* the stage that the program came from */

/* Costs that belong to no instruction. */
struct CostRules {
    Cycles refill = {2, 3, 3};     /* behind a branch that is taken */
    Cycles peripheral = {0, 5, 5}; /* more than an access to memory: bridges of the buses */
    Cycles enter = {12, 12, 16}, leave = {12, 12, 16}; /* an exception */
    Cycles floating_point_frame = {17, 17, 17};        /* more, of each of them */
    unsigned flash_wait = 4;                           /* cycles per line or literal */
    unsigned flash_line_shift = 3;                     /* log2 of the bytes of a line */
};

class InstructionCosts
{
  public:
    explicit InstructionCosts(const ChipDescription &chip);
    InstructionCosts(const InstructionCosts &) = delete;
    InstructionCosts &operator=(const InstructionCosts &) = delete;

    CostRules rules;
    std::vector<std::string> stages = {"other"};
    /* Begin what the control interrupt may run from flash, being no part of operation. */
    std::vector<std::uint32_t> enabling;
    /* Without a map every instruction costs 1.5 cycles on the average; with one, an instruction
       that it does not name is an error. */
    bool stand_in = true;

    /* The entry of an address, or nullptr where the chip has no memory for code. */
    InstructionCost *find(std::uint32_t address)
    {
        if (last_->addresses.contains(address)) {
            return &last_->costs[(address - last_->addresses.base) >> 1];
        }
        return search(address);
    }

  private:
    struct Range {
        AddressRange addresses;
        std::vector<InstructionCost> costs;
    };

    InstructionCost *search(std::uint32_t address);

    std::vector<Range> ranges_;
    Range *last_ = nullptr; /* found in */
};

/* Of an instruction that nothing is known of but its size. */
InstructionCost stand_in_cost(std::uint32_t address, unsigned bytes);

/* Instructions of the IT block that a halfword opens; 0: it is no IT. */
unsigned conditional_block(unsigned halfword);

} // namespace virtual_board

#endif
