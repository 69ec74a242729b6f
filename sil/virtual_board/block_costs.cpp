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
BlockCycles cycles_of(unsigned nominal, unsigned worst, unsigned waits, CodePlace place)
{
    const unsigned flash = worst + waits;
    return {nominal, place == CodePlace::flash ? flash : worst, flash};
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
    table_ = std::vector<BlockCost>(std::size_t{1} << ++size_log2_);
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
    constexpr std::size_t most = std::numeric_limits<decltype(block.accesses)>::max();
    constexpr std::size_t most_in_all = std::numeric_limits<decltype(block.first_access)>::max();
    if (accesses.size() > most || accesses_.size() > most_in_all) {
        throw std::length_error("more accesses to registers than the table of blocks can name");
    }
    block.first_access = static_cast<std::uint16_t>(accesses_.size());
    block.accesses = static_cast<std::uint8_t>(accesses.size());
    accesses_.insert(accesses_.end(), accesses.begin(), accesses.end());
}

BlockCost BlockCosts::sum(std::uint32_t address, const std::vector<InstructionCost> &instructions,
                          const CostRules &rules, CodePlace place)
{
    BlockCost block;
    block.address = address;
    block.place = place;
    block.instructions = static_cast<std::uint32_t>(instructions.size());
    block.first_part = static_cast<std::uint32_t>(parts_.size());
    std::uint32_t line_before = (address - 1) >> rules.flash_line_shift;
    for (const InstructionCost &cost : instructions) {
        const bool first = block.bytes == 0;
        const std::uint32_t begin = address + block.bytes, last = begin + cost.bytes - 1;
        const std::uint32_t first_line = begin >> rules.flash_line_shift;
        const std::uint32_t last_line = last >> rules.flash_line_shift;
        const unsigned beside = (last_line != first_line ? 1u : 0u) + cost.literals;
        const unsigned waits = (first_line != line_before ? 1u : 0u) + beside;
        const BlockCycles after =
            cycles_of(cost.nominal_after, cost.worst_after, waits * rules.flash_wait, place);
        if (first) {
            block.stage = cost.stage;
            block.head_after = after;
            block.head =
                cycles_of(cost.nominal, cost.worst, (1 + beside) * rules.flash_wait, place);
            block.nominal_after = after.nominal;
            block.nominal = block.head.nominal;
        } else {
            const std::uint8_t stage = block.parts == 0 ? block.stage : parts_.back().stage;
            if (cost.stage != inherited_stage && cost.stage != stage) {
                parts_.push_back({cost.stage, BlockCycles()});
                ++block.parts;
            }
            if (block.parts == 0) {
                block.head_after += after;
                block.head += after;
            } else {
                parts_.back().cycles += after;
            }
            block.nominal_after += after.nominal;
            block.nominal += after.nominal;
        }
        block.bytes += cost.bytes;
        line_before = last_line;
        if (cost.conditional > 0) {
            block.conditional = {address + block.bytes, cost.conditional};
        }
    }
    return block;
}

} // namespace virtual_board
