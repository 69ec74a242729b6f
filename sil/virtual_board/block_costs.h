/*
 * What a block of instructions costs, one behind the other without a jump into or out of their
 * midst: the sums of InstructionCosts, formed when it is first executed.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_BLOCK_COSTS_H
#define STEADYSTEP_VIRTUAL_BOARD_BLOCK_COSTS_H

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sil/virtual_board/instruction_costs.h"
#include "sil/virtual_board/register_lessons.h"

namespace virtual_board
{

/* Instructions of the same stage. */
struct BlockPart {
    std::uint8_t stage; /* inherited_stage: that of what comes before */
    Cycles cycles;
};

/* An access of a block's to a register. */
struct TimedAccess {
    RegisterAccess access;
    std::uint32_t left; /* nominal cycles of the block from the beginning of its instruction on */
    std::uint8_t stage; /* or inherited_stage */
};

/* Where code lies, as far as its cost goes: in the memory that is meant for it, in flash although
   another is, the same but meant to, with what it calls, or elsewhere. */
enum class CodePlace : std::uint8_t { as_wanted, flash, flash_by_intent, elsewhere };

/* One line of the host's cache: this is looked up at every block. */
struct alignas(64) BlockCost {
    std::uint32_t address = no_code;
    std::uint16_t bytes = 0; /* 0: an empty place */
    std::uint16_t instructions = 0;
    /* Of all of it: its first instruction comes from the one before, or not. */
    std::uint16_t nominal_after = 0, nominal = 0;
    std::uint16_t first_part = 0; /* of those behind its head */
    std::uint8_t parts = 0;
    std::uint8_t stage = 0;      /* of its head */
    Cycles head_after, head;     /* likewise */
    bool by_instruction = false; /* it is charged by the instruction: nothing of the above */
    CodePlace place = CodePlace::as_wanted;
    std::uint8_t accesses = 0;          /* to registers, as far as they are known */
    std::uint8_t conditional_bytes = 0; /* of the instructions of its last IT block */
    std::uint16_t first_access = 0;
    std::uint16_t conditional_from = 0; /* where they begin in it */

    static constexpr std::uint32_t no_code = 1; /* instructions have even addresses */
};
static_assert(sizeof(BlockCost) == 64);

/* Blocks by address: a table with open addressing, at least half empty. */
class BlockCosts
{
  public:
    /* The block at an address with this many bytes, or nullptr. Until the next `set`. */
    const BlockCost *find(std::uint32_t address, std::uint32_t bytes) const
    {
        const BlockCost *block = &table_[first_place(address)];
        if (block->address != address) {
            block = &table_[place(address)];
        }
        return block->bytes == bytes ? block : nullptr;
    }
    const BlockPart *parts(const BlockCost &block) const
    {
        return parts_.data() + block.first_part;
    }
    const TimedAccess *accesses(const BlockCost &block) const
    {
        return accesses_.data() + block.first_access;
    }
    /* These two throw std::length_error above 255 accesses or changes of stage in a block, 65,535
       of them in all, and as many bytes or cycles of a block. */
    void set_accesses(BlockCost &block, const std::vector<TimedAccess> &accesses);
    /* The sums over some instructions, one at least, from this address on; their parts are kept
       here. */
    BlockCost sum(std::uint32_t address, const std::vector<InstructionCost> &instructions,
                  const CostRules &rules, CodePlace place);
    /* In the place of what was known of that address. */
    const BlockCost &set(const BlockCost &block);
    /* Nothing is known any more. */
    void forget();

  private:
    std::size_t first_place(std::uint32_t address) const
    {
        return (address * scatter) >> places_shift_;
    }
    /* Where the block at an address lies, or is to lie. */
    std::size_t place(std::uint32_t address) const
    {
        std::size_t at = first_place(address);
        while (table_[at].address != address && table_[at].address != BlockCost::no_code) {
            at = (at + 1) & (table_.size() - 1);
        }
        return at;
    }
    void grow();

    /* 2^32 over the golden ratio: code lies close together, in the table it must not. */
    static constexpr std::uint32_t scatter = 0x9e3779b1;

    unsigned places_shift_ = 20; /* 32 less log2 of their number */
    std::vector<BlockCost> table_ = std::vector<BlockCost>(std::size_t{1} << (32 - places_shift_));
    std::size_t blocks_ = 0;
    std::vector<BlockPart> parts_;
    std::vector<TimedAccess> accesses_;
};

} // namespace virtual_board

#endif
