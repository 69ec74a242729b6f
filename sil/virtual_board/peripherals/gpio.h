/* GPIO ports A...G: what a pin is routed to decides whether a signal reaches it. */
#ifndef STEADYSTEP_VIRTUAL_BOARD_GPIO_H
#define STEADYSTEP_VIRTUAL_BOARD_GPIO_H

#include <array>
#include <memory>

#include "sil/virtual_board/peripherals/register_block.h"

namespace virtual_board
{

struct Pin {
    char port;
    unsigned number;
};

class Gpio : public RegisterBlock
{
  public:
    Gpio(Chip &chip, char port);

    unsigned mode(unsigned pin) const /* 0 input, 1 output, 2 alternate function, 3 analog */
    {
        return field(at(0x00), 2 * pin, 2);
    }
    unsigned alternate(unsigned pin) const
    {
        return field(at(pin < 8 ? 0x20 : 0x24), 4 * (pin % 8), 4);
    }
    bool output(unsigned pin) const
    {
        return bit(at(0x14), pin);
    }
    bool drives_high(unsigned pin) const
    {
        return mode(pin) == 1 && output(pin);
    }
    /* From outside; a pin that nothing drives follows its pull. */
    void drive(unsigned pin, bool high)
    {
        driven_ |= 1u << pin;
        inputs = (inputs & ~(1u << pin)) | (high ? 1u << pin : 0u);
    }
    std::uint32_t inputs = 0; /* levels of the pins that are driven from outside */

  protected:
    std::uint32_t fetch(std::uint32_t offset, Master master) override;
    void put(std::uint32_t offset, std::uint32_t value, Master master) override;

  private:
    std::uint32_t driven_ = 0;
};

class Pins
{
  public:
    static constexpr unsigned ports = 7;

    explicit Pins(Chip &chip);

    Gpio &port(char letter)
    {
        return *ports_[static_cast<std::size_t>(letter - 'A')];
    }
    const Gpio &port(char letter) const
    {
        return *ports_[static_cast<std::size_t>(letter - 'A')];
    }
    bool routed(Pin pin, unsigned alternate) const
    {
        const Gpio &gpio = port(pin.port);
        return gpio.mode(pin.number) == 2 && gpio.alternate(pin.number) == alternate;
    }
    bool analog(Pin pin) const
    {
        return port(pin.port).mode(pin.number) == 3;
    }

  private:
    std::array<std::unique_ptr<Gpio>, ports> ports_;
};

std::string text(Pin pin);

} // namespace virtual_board

#endif
