#include "sil/virtual_board/block_costs.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace virtual_board
{

namespace
{

/* `waits`: for lines and literals, if the code runs from flash; this does if it lies there. */
Cycles cycles_of(unsigned nominal, unsigned worst, unsigned waits, CodePlace place)
{
    const unsigned flash = worst + waits;
    const bool lies_there = place == CodePlace::flash || place == CodePlace::flash_by_intent;
    return {nominal, lies_there ? flash : worst, flash};
}

template <typename Count> Count counted(std::size_t count)
{
    if (count > std::numeric_limits<Count>::max()) {
        throw std::length_error("more than the table of blocks can name");
    }
    return static_cast<Count>(count);
}

} // namespace

const BlockCost &BlockCosts::set(const BlockCost &block)
{
    BlockCost *known = &table_[place(block.address)];
    if (known->address == BlockCost::no_code) {
        if (++blocks_ > table_.size() / 2) {
            grow();
            known = &table_[place(block.address)];
        }
    }
    *known = block;
    return *known;
}

void BlockCosts::grow()
{
    const std::vector<BlockCost> known = std::move(table_);
    table_ = std::vector<BlockCost>(std::size_t{1} << (32 - --places_shift_));
    for (const BlockCost &block : known) {
        if (block.address != BlockCost::no_code) {
            table_[place(block.address)] = block;
        }
    }
}

void BlockCosts::forget()
{
    std::fill(table_.begin(), table_.end(), BlockCost());
    blocks_ = 0;
    parts_.clear();
    accesses_.clear();
}

void BlockCosts::set_accesses(BlockCost &block, const std::vector<TimedAccess> &accesses)
{
    block.first_access = counted<std::uint16_t>(accesses_.size());
    block.accesses = counted<std::uint8_t>(accesses.size());
    accesses_.insert(accesses_.end(), accesses.begin(), accesses.end());
}

BlockCost BlockCosts::sum(std::uint32_t address, const std::vector<InstructionCost> &instructions,
                          const CostRules &rules, CodePlace place)
{
    BlockCost block;
    block.address = address;
    block.place = place;
    block.instructions = counted<std::uint16_t>(instructions.size());
    block.first_part = counted<std::uint16_t>(parts_.size());
    std::uint32_t bytes = 0, nominal_behind_first = 0;
    std::uint32_t line_before = (address - 1) >> rules.flash_line_shift;
    for (const InstructionCost &cost : instructions) {
        const std::uint32_t begin = address + bytes, last = begin + cost.bytes - 1;
        const std::uint32_t first_line = begin >> rules.flash_line_shift;
        const std::uint32_t last_line = last >> rules.flash_line_shift;
        const unsigned beside = (last_line != first_line ? 1u : 0u) + cost.literals;
        const unsigned waits = (first_line != line_before ? 1u : 0u) + beside;
        const Cycles after =
            cycles_of(cost.nominal_after, cost.worst_after, waits * rules.flash_wait, place);
        if (bytes == 0) {
            block.stage = cost.stage;
            block.head_after = after;
            block.head =
                cycles_of(cost.nominal, cost.worst, (1 + beside) * rules.flash_wait, place);
        } else {
            const std::size_t parts = parts_.size() - block.first_part;
            const std::uint8_t stage = parts == 0 ? block.stage : parts_.back().stage;
            if (cost.stage != inherited_stage && cost.stage != stage) {
                parts_.push_back({cost.stage, Cycles()});
            }
            if (parts_.size() == block.first_part) {
                block.head_after += after;
                block.head += after;
            } else {
                parts_.back().cycles += after;
            }
            nominal_behind_first += after.nominal;
        }
        bytes += cost.bytes;
        line_before = last_line;
        if (cost.conditional > 0) {
            block.conditional_from = counted<std::uint16_t>(bytes);
            block.conditional_bytes = cost.conditional;
        }
    }
    block.parts = counted<std::uint8_t>(parts_.size() - block.first_part);
    block.bytes = counted<std::uint16_t>(bytes);
    block.nominal_after =
        counted<std::uint16_t>(instructions.front().nominal_after + nominal_behind_first);
    block.nominal = counted<std::uint16_t>(instructions.front().nominal + nominal_behind_first);
    return block;
}

} // namespace virtual_board
