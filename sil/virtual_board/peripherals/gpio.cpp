#include "sil/virtual_board/peripherals/gpio.h"

namespace virtual_board
{

namespace
{

enum : std::uint32_t { PUPDR = 0x0c, IDR = 0x10, ODR = 0x14, BSRR = 0x18, BRR = 0x28 };

/* The debug port's pins are alternate functions after a reset, all others analog. */
std::vector<Register> registers(char port)
{
    const std::uint32_t mode = port == 'A' ? 0xabffffffu : port == 'B' ? 0xfffffebfu : 0xffffffffu;
    const std::uint32_t speed = port == 'A' ? 0x0c000000u : port == 'B' ? 0xc0u : 0u;
    const std::uint32_t pull = port == 'A' ? 0x64000000u : port == 'B' ? 0x100u : 0u;
    return {{0x00, "MODER", 0xffffffff, mode},
            {0x04, "OTYPER", 0xffff},
            {0x08, "OSPEEDR", 0xffffffff, speed},
            {PUPDR, "PUPDR", 0xffffffff, pull},
            {IDR, "IDR", 0},
            {ODR, "ODR", 0xffff},
            {BSRR, "BSRR", 0xffffffff},
            {0x20, "AFRL", 0xffffffff},
            {0x24, "AFRH", 0xffffffff},
            {BRR, "BRR", 0xffff}};
}

} // namespace

Gpio::Gpio(Chip &chip, char port) : RegisterBlock(chip, std::string("GPIO") + port, registers(port))
{
}

std::uint32_t Gpio::fetch(std::uint32_t offset, Master)
{
    if (offset == BSRR || offset == BRR) {
        return 0;
    }
    if (offset != IDR) {
        return at(offset);
    }
    std::uint32_t levels = 0;
    for (unsigned pin = 0; pin < 16; pin++) {
        const std::uint32_t mask = 1u << pin;
        const bool pulled_up = field(at(PUPDR), 2 * pin, 2) == 1 && (driven_ & mask) == 0;
        const std::uint32_t outside = pulled_up ? mask : inputs;
        levels |= mode(pin) == 3 ? 0u : (mode(pin) == 1 ? at(ODR) : outside) & mask;
    }
    return levels;
}

void Gpio::put(std::uint32_t offset, std::uint32_t value, Master)
{
    if (offset == BSRR) {
        at(ODR) = (at(ODR) & ~(value >> 16)) | (value & 0xffffu); /* setting wins */
    } else if (offset == BRR) {
        at(ODR) &= ~value;
    } else {
        keep(offset, value);
    }
}

Pins::Pins(Chip &chip)
{
    for (unsigned i = 0; i < ports; i++) {
        ports_[i] = std::make_unique<Gpio>(chip, static_cast<char>('A' + i));
    }
}

std::string text(Pin pin)
{
    return std::string("P") + pin.port + std::to_string(pin.number);
}

} // namespace virtual_board
