/* Offsets and bits of an ADC that both halves of its model use. */
#ifndef STEADYSTEP_VIRTUAL_BOARD_ADC_REGISTERS_H
#define STEADYSTEP_VIRTUAL_BOARD_ADC_REGISTERS_H

#include <cstdint>

namespace virtual_board::adc_registers
{

enum : std::uint32_t {
    ISR = 0x00,
    IER = 0x04,
    CR = 0x08,
    CFGR = 0x0c,
    CFGR2 = 0x10,
    SMPR1 = 0x14,
    SMPR2 = 0x18,
    SQR1 = 0x30,
    SQR2 = 0x34,
    SQR3 = 0x38,
    SQR4 = 0x3c,
    DR = 0x40,
    JSQR = 0x4c,
    JDR1 = 0x80,
    CALFACT = 0xb4
};
enum : std::uint32_t {
    ADRDY = 1u << 0,
    EOSMP = 1u << 1,
    EOC = 1u << 2,
    EOS = 1u << 3,
    OVR = 1u << 4,
    JEOC = 1u << 5,
    JEOS = 1u << 6
};
enum : std::uint32_t {
    ADEN = 1u << 0,
    ADDIS = 1u << 1,
    ADSTART = 1u << 2,
    JADSTART = 1u << 3,
    ADSTP = 1u << 4,
    JADSTP = 1u << 5,
    ADVREGEN = 1u << 28,
    DEEPPWD = 1u << 29,
    ADCAL = 1u << 31
};
enum : std::uint32_t { DMAEN = 1u << 0, OVRMOD = 1u << 12, JQDIS = 1u << 31 };

} // namespace virtual_board::adc_registers

#endif
