/* PWR: the range of the core's supply. */
#include "sil/virtual_board/peripherals/clock_tree.h"

namespace virtual_board
{

Pwr::Pwr(Chip &chip)
    : RegisterBlock(chip, "PWR",
                    {{0x00, "CR1", 0x700, 0x200},
                     {0x04, "CR2", 0},
                     {0x08, "CR3", 0xc000, 0x8000},
                     {0x10, "SR1", 0},
                     {0x14, "SR2", 0},
                     {0x18, "SCR", 0},
                     {0x80, "CR5", 0x100, 0x100}})
{
}

void Pwr::put(std::uint32_t offset, std::uint32_t value, Master)
{
    if (offset == 0x00) {
        const unsigned range = field(value, 9, 2);
        require(range == 1 || range == 2, offset, value, "VOS: expected range 1 (1) or 2 (2)");
    }
    keep(offset, value);
    if (on_change) {
        on_change();
    }
}

} // namespace virtual_board
