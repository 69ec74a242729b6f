#include "sil/virtual_board/peripherals/analog.h"

namespace virtual_board
{

namespace
{

constexpr Ticks microseconds(unsigned count)
{
    return ticks_per_s / 1000000 * count;
}

/* Start-up times of DS12288, the longest ones. */
constexpr Ticks opamp_start = microseconds(6), comparator_start = microseconds(5);
constexpr Ticks dac_start = microseconds(3); /* internal, without buffer */

enum : std::uint32_t {
    DAC_CR = 0x00,
    DAC_DHR1 = 0x08,
    DAC_DHR2 = 0x14,
    DAC_DOR1 = 0x2c,
    DAC_DOR2 = 0x30,
    DAC_SR = 0x34,
    DAC_MCR = 0x3c
};

constexpr std::uint32_t lock = 1u << 31;

std::vector<Register> comparator_registers()
{
    static const char *const names[Comparators::count] = {"C1CSR", "C2CSR", "C3CSR", "C4CSR",
                                                          "C5CSR", "C6CSR", "C7CSR"};
    std::vector<Register> table;
    for (std::uint32_t i = 0; i < Comparators::count; i++) {
        table.push_back({4 * i, names[i], 0x80078171, 0, 1u << 30});
    }
    return table;
}

} // namespace

Opamps::Opamps(Chip &chip)
    : RegisterBlock(chip, "OPAMP",
                    {{0x00, "OPAMP1_CSR", 0x8007c1ed},
                     {0x04, "OPAMP2_CSR", 0x8007c1ed},
                     {0x08, "OPAMP3_CSR", 0x8007c1ed},
                     {0x0c, "OPAMP4_CSR", 0x8007c1ed},
                     {0x10, "OPAMP5_CSR", 0x8007c1ed},
                     {0x14, "OPAMP6_CSR", 0x8007c1ed}})
{
}

void Opamps::put(std::uint32_t offset, std::uint32_t value, Master)
{
    require((at(offset) & lock) == 0, offset, value, "written while LOCK is set");
    if ((value & ~at(offset) & 1u) != 0) {
        ready_[offset / 4] = chip_.now() + opamp_start;
    }
    keep(offset, value);
}

unsigned Opamps::gain(unsigned number) const
{
    const std::uint32_t offset = 4 * (number - 1), value = at(offset);
    require(bit(value, 0), offset, value, "its output is converted while OPAMPEN is 0");
    require(chip_.now() >= ready_[number - 1], offset, value,
            "its output is converted within its start-up time of 6 us");
    require(bit(value, 8), offset, value,
            "the converter's internal channel is not connected (OPAINTOEN = 0)");
    require(field(value, 2, 2) == 0, offset, value, "VP_SEL: the shunt is wired to VINP0 (0)");
    const unsigned inverting = field(value, 5, 2), code = field(value, 14, 5);
    require(inverting >= 2, offset, value, "VM_SEL: external feedback is not wired");
    require(inverting == 3 || code < 6, offset, value, "PGA_GAIN: expected 0...5");
    return inverting == 3 ? 1u : 2u << code;
}

Dac::Dac(Chip &chip, unsigned number, const Rcc &rcc)
    : RegisterBlock(chip, "DAC" + std::to_string(number),
                    {{DAC_CR, "CR", 0x00010001},
                     {DAC_DHR1, "DHR12R1", 0xfff},
                     {DAC_DHR2, "DHR12R2", 0xfff},
                     {0x20, "DHR12RD", 0x0fff0fff},
                     {DAC_DOR1, "DOR1", 0},
                     {DAC_DOR2, "DOR2", 0},
                     {DAC_SR, "SR", 0, 0, 0x20002000},
                     {DAC_MCR, "MCR", 0x0007c007}}),
      rcc_(rcc)
{
}

std::uint32_t Dac::fetch(std::uint32_t offset, Master)
{
    if (offset == DAC_SR) {
        std::uint32_t value = 0;
        for (unsigned channel = 0; channel < 2; channel++) {
            const bool ready = enabled(channel) && chip_.now() >= ready_[channel];
            value |= ready ? 1u << (11 + 16 * channel) : 0u;
        }
        return value;
    }
    return at(offset);
}

void Dac::put(std::uint32_t offset, std::uint32_t value, Master)
{
    if (offset == DAC_MCR) {
        require((at(DAC_CR) & 0x00010001u) == 0, offset, value,
                "written while a channel is enabled");
    } else if (offset == DAC_CR) {
        const unsigned needed = rcc_.hclk_Hz() > 160e6 ? 2 : rcc_.hclk_Hz() > 80e6 ? 1 : 0;
        require(value == 0 || field(at(DAC_MCR), 14, 2) >= needed, offset, value,
                "enabled while MCR.HFSEL does not fit the bus clock");
        for (unsigned channel = 0; channel < 2; channel++) {
            if (bit(value, 16 * channel) && !enabled(channel)) {
                ready_[channel] = chip_.now() + dac_start;
            }
        }
    } else if (offset == DAC_SR || offset == DAC_DOR1 || offset == DAC_DOR2) {
        return;
    }
    keep(offset, value);
    if (offset == DAC_DHR1) {
        at(DAC_DOR1) = value;
    } else if (offset == DAC_DHR2) {
        at(DAC_DOR2) = value;
    } else if (offset == 0x20) {
        at(DAC_DOR1) = value & 0xfffu;
        at(DAC_DOR2) = value >> 16;
    }
}

std::uint32_t Dac::level(unsigned channel) const
{
    require(enabled(channel), DAC_CR, at(DAC_CR),
            "a comparator uses the channel while it is disabled");
    const unsigned mode = field(at(DAC_MCR), 16 * channel, 3);
    require(mode == 1 || mode == 3, DAC_MCR, at(DAC_MCR),
            "a comparator uses the channel, MODE does not connect it to on-chip peripherals");
    return at(channel == 0 ? DAC_DOR1 : DAC_DOR2);
}

Comparators::Comparators(Chip &chip, const Dac &dac1, const Dac &dac3)
    : RegisterBlock(chip, "COMP", comparator_registers()), dac1_(dac1), dac3_(dac3)
{
}

void Comparators::put(std::uint32_t offset, std::uint32_t value, Master)
{
    require((at(offset) & lock) == 0, offset, value, "written while LOCK is set");
    const unsigned selected = field(value, 4, 3);
    require(!bit(value, 0) || selected == 4 || selected == 5, offset, value,
            "INMSEL: only the converters to analog (4, 5) are modelled");
    if ((value & ~at(offset) & 1u) != 0) {
        ready_[offset / 4] = chip_.now() + comparator_start;
    }
    keep(offset, value);
    if (bit(value, 0)) {
        (void)threshold(offset / 4);
    }
}

/* RM0440, table of the inputs: 4 is DAC3 (channel 1 of COMP1 and 3, channel 2 of COMP2 and 4), 5
   is DAC1 (channel 1 of COMP1, 3 and 4, channel 2 of COMP2). */
double Comparators::threshold(unsigned index) const
{
    const unsigned selected = field(at(4 * index), 4, 3);
    if (index > 3) {
        refuse(4 * index, at(4 * index), "only COMP1...COMP4 are wired");
    }
    return selected == 4 ? dac3_.level(index % 2) : dac1_.level(index == 1 ? 1 : 0);
}

bool Comparators::compare(unsigned index, double plus_code)
{
    std::uint32_t &value = at(4 * index);
    if (!bit(value, 0) || chip_.now() < ready_[index]) {
        above_[index] = false;
        return false;
    }
    /* 10 mV a step, of a reference of 3.3 V */
    const double hysteresis = field(value, 16, 3) * 10e-3 / 3.3 * 4096;
    const double limit = threshold(index) - (above_[index] ? hysteresis : 0.0);
    above_[index] = plus_code > limit;
    const bool output = above_[index] != bit(value, 15);
    value = (value & ~(1u << 30)) | (output ? 1u << 30 : 0u);
    return output;
}

RegisterBlock *make_syscfg(Chip &chip)
{
    return new RegisterBlock(chip, "SYSCFG",
                             {{0x00, "MEMRMP", 0},
                              {0x04, "CFGR1", 0x100},
                              {0x08, "EXTICR1", 0},
                              {0x0c, "EXTICR2", 0},
                              {0x10, "EXTICR3", 0},
                              {0x14, "EXTICR4", 0},
                              {0x18, "SCSR", 0},
                              {0x1c, "CFGR2", 0xf, 0, 0x100},
                              {0x20, "SWPR", 0xffffffff},
                              {0x24, "SKR", 0xff}});
}

RegisterBlock *make_dbgmcu(Chip &chip)
{
    return new RegisterBlock(chip, "DBGMCU",
                             {{0x00, "IDCODE", 0, 0x20036469},
                              {0x04, "CR", 0xe7},
                              {0x08, "APB1FZR1", 0xc0e01c3f},
                              {0x0c, "APB1FZR2", 0x2},
                              {0x10, "APB2FZR", 0x3c172800}});
}

} // namespace virtual_board
