#include "sil/virtual_board/instruction_costs.h"

namespace virtual_board
{

InstructionCosts::InstructionCosts(const ChipDescription &chip)
{
    const auto add = [&](AddressRange range) {
        if (range.bytes > 0) {
            ranges_.push_back({range, std::vector<InstructionCost>(range.bytes / 2)});
        }
    };
    add(chip.fast_code);
    add(chip.flash);
    for (const MemoryRange &memory : chip.ram) {
        if (memory.base != chip.fast_code.base) {
            add({memory.base, memory.bytes});
        }
    }
    last_ = &ranges_.front();
}

InstructionCost *InstructionCosts::search(std::uint32_t address)
{
    for (Range &range : ranges_) {
        if (range.addresses.contains(address)) {
            last_ = &range;
            return &range.costs[(address - range.addresses.base) >> 1];
        }
    }
    return nullptr;
}

InstructionCost stand_in_cost(std::uint32_t address, unsigned bytes)
{
    InstructionCost cost;
    cost.bytes = static_cast<std::uint8_t>(bytes);
    cost.nominal = cost.nominal_after = (address & 2) == 0 ? 1 : 2;
    cost.worst = cost.worst_after = 3;
    return cost;
}

/* IT: 1011 1111 firstcond mask, the mask's lowest one ends the block (ARMv7-M ARM, A7.7.38). */
unsigned conditional_block(unsigned halfword)
{
    const unsigned mask = halfword & 0xf;
    if ((halfword & 0xff00) != 0xbf00 || mask == 0) {
        return 0;
    }
    unsigned length = 4;
    for (unsigned bit = mask; (bit & 1) == 0; bit >>= 1) {
        --length;
    }
    return length;
}

} // namespace virtual_board
