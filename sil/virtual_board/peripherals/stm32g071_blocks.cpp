#include "sil/virtual_board/peripherals/stm32g071_blocks.h"

#include <cstdlib>

namespace virtual_board
{

namespace
{

/* Lines: of the STM32G474's model, and where the STM32G071 has them. */
constexpr unsigned lines[][2] = {
    {11, 9},  {12, 10}, {13, 10}, {14, 11}, {15, 11}, {16, 11}, {17, 11}, /* DMA1 channels 1...7 */
    {24, 13}, {25, 13}, {27, 14},                                         /* TIM1 */
    {91, 29},                                                             /* LPUART1 */
};

/* DMA requests: ADC, LPUART1 RX, TX. */
constexpr std::uint32_t requests[][2] = {{5, 5}, {14, 34}, {15, 35}};

enum : std::uint32_t { CR = 0x00, CFGR = 0x08, PLLCFGR = 0x0c, CSR = 0x60 };
/* Of the STM32G474's clock tree. */
enum : std::uint32_t { TREE_CSR = 0x94 };

} // namespace

void G071Lines::interrupt(unsigned line, bool level)
{
    levels_[line] = level;
    for (const auto &mapped : lines) {
        if (mapped[0] == line) {
            bool any = false;
            for (const auto &other : lines) {
                any = any || (other[1] == mapped[1] && levels_[other[0]]);
            }
            chip_.interrupt(mapped[1], any);
            return;
        }
    }
    if (level) {
        fail("interrupt line " + std::to_string(line) + " of a block that the STM32G071 has not");
    }
}

void G071Lines::fail(const std::string &what) const
{
    chip_.fail(what);
    std::abort(); /* never reached: the compiler does not take a virtual function's word */
}

G071Rcc::G071Rcc(Chip &chip)
    : RegisterBlock(chip, "RCC",
                    {{CR, "CR", 0x01000100, 0x500, 0x02000400},
                     {CFGR, "CFGR", 0x7f07, 0, 0x38},
                     {PLLCFGR, "PLLCFGR", 0xfb3f7f73, 0x1000},
                     {0x24, "IOPRSTR", 0x3f},
                     {0x28, "AHBRSTR", 0x1101},
                     {0x2c, "APBRSTR1", 0xffffffff},
                     {0x30, "APBRSTR2", 0x1fd801},
                     {0x34, "IOPENR", 0x2f},
                     {0x38, "AHBENR", 0x1101, 0x100},
                     {0x3c, "APBENR1", 0xfe7efc33},
                     {0x40, "APBENR2", 0x17d801},
                     {0x54, "CCIPR", 0},
                     {CSR, "CSR", 0x00800001, 0, 0xfe000002}}),
      power_(chip), tree_(chip, power_, {24e6, false})
{
}

void G071Rcc::reset()
{
    RegisterBlock::reset();
    power_.reset();
    tree_.reset();
}

std::uint32_t G071Rcc::fetch(std::uint32_t offset, Master master)
{
    switch (offset) {
    case CR:
        return tree_.read(CR, 4, master) & 0x03000500;
    case CFGR:
        return (at(CFGR) & ~0x38u) | (at(CFGR) & 7u) << 3;
    case CSR:
        return tree_.read(TREE_CSR, 4, master);
    default:
        return at(offset);
    }
}

void G071Rcc::put(std::uint32_t offset, std::uint32_t value, Master master)
{
    keep(offset, value);
    if (offset == CR) {
        tree_.write(CR, 4, value & 0x01000100, master);
    } else if (offset == CFGR) {
        const unsigned source = value & 7u;
        require(source == 0 || source == 2, offset, value, "SW: HSI16 and PLL are modelled");
        require((value & 0x7f00u) == 0, offset, value, "a divided bus clock is not modelled");
        tree_.write(CFGR, 4, source == 0 ? 1u : 3u, master);
    } else if (offset == PLLCFGR) {
        const unsigned r = field(value, 29, 3) + 1;
        require(r == 2 || r == 4 || r == 6 || r == 8, offset, value, "PLLR: expected 2, 4, 6, 8");
        require((value & 0x01010000u) == 0, offset, value, "PLLP and PLLQ are not modelled");
        tree_.write(PLLCFGR, 4,
                    (value & 0x7f73u) | (bit(value, 28) ? 1u << 24 : 0u) | (r / 2 - 1) << 25,
                    master);
    } else if (offset == CSR) {
        tree_.write(TREE_CSR, 4, value & 0x00800001u, master);
    }
}

std::uint32_t G071Dmamux::read(std::uint32_t offset, unsigned size, Master master)
{
    const std::uint32_t value = inner_.read(offset, size, master);
    for (const auto &request : requests) {
        if (offset < 0x40 && value == request[1]) {
            return request[0];
        }
    }
    return value;
}

void G071Dmamux::write(std::uint32_t offset, unsigned size, std::uint32_t value, Master master)
{
    for (const auto &request : requests) {
        if (offset < 0x1c && value == request[0]) {
            inner_.write(offset, size, request[1], master);
            return;
        }
    }
    inner_.write(offset, size, offset < 0x1c && value != 0 ? 0x7fu : value, master);
}

/* AF1: BKINE and BKINP to the comparator's BKCMP1E and BKCMP1P, and back. */
std::uint32_t G071Timer1::read(std::uint32_t offset, unsigned size, Master master)
{
    const std::uint32_t value = inner_.read(offset, size, master);
    return offset == 0x60 ? (value & 2u) >> 1 | (value & 0x400u) >> 1 : value;
}

void G071Timer1::write(std::uint32_t offset, unsigned size, std::uint32_t value, Master master)
{
    if (!connected_ && inner_.clocked()) { /* BKINE is set after a reset */
        connected_ = true;
        inner_.write(0x60, 4, 2, master);
    }
    if (offset == 0x60) {
        value = (value & 1u) << 1 | (value & 0x200u) << 1;
    }
    inner_.write(offset, size, value, master);
}

void G071Timer1::reset()
{
    inner_.reset();
    connected_ = false;
}

} // namespace virtual_board
