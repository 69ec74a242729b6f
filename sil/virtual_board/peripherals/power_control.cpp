/* PWR: the range of the core's supply, and the monitor of the chip's. */
#include "sil/virtual_board/peripherals/clock_tree.h"

namespace virtual_board
{

namespace
{

enum : std::uint32_t { CR2 = 0x04, SR2 = 0x14 };
constexpr std::uint32_t PVDO = 1u << 11;
constexpr double falling_V = 2.90, rising_V = 2.98; /* of level 6; DS12288 */

} // namespace

Pwr::Pwr(Chip &chip)
    : RegisterBlock(chip, "PWR",
                    {{0x00, "CR1", 0x700, 0x200},
                     {0x04, "CR2", 0xf},
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
    if (offset == CR2) {
        require(field(value, 0, 4) == 0xd, offset, value,
                "PVD: only level 6 (PLS), on, is modelled");
    }
    keep(offset, value);
    watch_supply();
    if (on_change) {
        on_change();
    }
}

void Pwr::set_supply(double supply_V)
{
    supply_V_ = supply_V;
    watch_supply();
}

void Pwr::reset()
{
    RegisterBlock::reset(); /* the monitor is off */
    if (on_supply) {
        on_supply(false);
    }
}

void Pwr::watch_supply()
{
    const bool was = (at(SR2) & PVDO) != 0;
    const bool low = bit(at(CR2), 0) && supply_V_ < (was ? rising_V : falling_V);
    at(SR2) = low ? at(SR2) | PVDO : at(SR2) & ~PVDO;
    if (low != was && on_supply) {
        on_supply(low);
    }
}

} // namespace virtual_board
