/*
 * What a block of instructions costs, one behind the other without a jump into or out of their
 * midst: the sums of InstructionCosts, formed when it is first executed.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_BLOCK_COSTS_H
#define STEADYSTEP_VIRTUAL_BOARD_BLOCK_COSTS_H

#include <cstdint>
#include <vector>

#include "sil/virtual_board/instruction_costs.h"

namespace virtual_board
{

/* Of a few instructions. */
struct BlockCycles {
    std::uint32_t nominal = 0, worst = 0, flash = 0;

    BlockCycles &operator+=(const BlockCycles &more)
    {
        nominal += more.nominal;
        worst += more.worst;
        flash += more.flash;
        return *this;
    }
    operator Cycles() const
    {
        return {nominal, worst, flash};
    }
};

/* Instructions of the same stage. */
struct BlockPart {
    std::uint8_t stage; /* inherited_stage: that of what comes before */
    BlockCycles cycles;
};

/* One line of the host's cache: this is looked up at every block. */
struct BlockCost {
    std::uint32_t bytes = 0; /* 0: nothing is known of it any more */
    /* Of its first part: its first instruction comes from the one before, or not. */
    BlockCycles head_after, head;
    std::uint32_t nominal_after = 0, nominal = 0; /* of all of it, likewise */
    std::uint32_t instructions = 0;
    std::uint32_t first_part = 0; /* of the others */
    std::uint16_t parts = 0;
    std::uint8_t stage = 0;            /* of its first part */
    bool by_instruction = false;       /* it is charged by the instruction: nothing of the above */
    std::uint32_t last_line = 0;       /* of flash */
    AddressRange conditional = {0, 0}; /* instructions of its last IT block */
};

/* Blocks have numbers, from 1. */
class BlockCosts
{
  public:
    const BlockCost &operator[](std::uint32_t number) const
    {
        return blocks_[number];
    }
    const BlockPart *parts(const BlockCost &block) const
    {
        return parts_.data() + block.first_part;
    }
    /* What is known of the block `number`, or of a new one if that is 0; returns its number. */
    std::uint32_t set(std::uint32_t number, const BlockCost &block);
    /* The sums over some instructions from this address on; their parts are kept here. */
    BlockCost sum(std::uint32_t address, const std::vector<InstructionCost> &instructions,
                  const CostRules &rules);
    /* Nothing is known any more; numbers stay. */
    void forget();

  private:
    std::vector<BlockCost> blocks_ = std::vector<BlockCost>(1);
    std::vector<BlockPart> parts_;
};

} // namespace virtual_board

#endif
