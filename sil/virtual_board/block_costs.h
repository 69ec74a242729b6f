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

/* Instructions of the same stage. */
struct BlockPart {
    std::uint8_t stage; /* inherited_stage: that of what comes before */
    Cycles cycles;
};

struct BlockCost {
    std::uint32_t bytes = 0;     /* 0: nothing is known of it any more */
    bool by_instruction = false; /* it is charged by the instruction: nothing of what follows */
    std::uint32_t instructions = 0;
    Cycles first_after, first; /* of its first instruction: come from the one before, or not */
    std::uint64_t nominal_of_others = 0;
    std::uint32_t first_part = 0, parts = 0; /* the first instruction's has its stage only */
    std::uint32_t last_line = 0;             /* of flash */
    AddressRange conditional = {0, 0};       /* instructions of its last IT block */
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
        return &parts_[block.first_part];
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
