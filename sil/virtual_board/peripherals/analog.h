/*
 * Amplifiers, comparators and the converters to analog that set their thresholds; and the small
 * blocks without behaviour of their own. RM0440, chapters OPAMP, COMP, DAC, SYSCFG, DBG.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_ANALOG_H
#define STEADYSTEP_VIRTUAL_BOARD_ANALOG_H

#include <array>

#include "sil/virtual_board/peripherals/clock_tree.h"

namespace virtual_board
{

/* OPAMP1...6 */
class Opamps : public RegisterBlock
{
  public:
    explicit Opamps(Chip &chip);

    /* Gain from VINP0 to the converter (1, 2, 4...64) of amplifier 1...6, refused if it is not on,
       not connected inside, or not ready. */
    unsigned gain(unsigned number) const;

  protected:
    void put(std::uint32_t offset, std::uint32_t value, Master master) override;

  private:
    std::array<Ticks, 6> ready_{};
};

/* DAC1...DAC4: channels that hold a level. */
class Dac : public RegisterBlock
{
  public:
    Dac(Chip &chip, unsigned number, const Rcc &rcc);

    bool enabled(unsigned channel) const /* 0 or 1 */
    {
        return bit(at(0x00), 16 * channel);
    }
    /* Output code of 12 bits; refused if the channel is off or not led to the chip's inside. */
    std::uint32_t level(unsigned channel) const;

  protected:
    std::uint32_t fetch(std::uint32_t offset, Master master) override;
    void put(std::uint32_t offset, std::uint32_t value, Master master) override;

  private:
    const Rcc &rcc_;
    std::array<Ticks, 2> ready_{};
};

/* COMP1...7 */
class Comparators : public RegisterBlock
{
  public:
    static constexpr unsigned count = 7;

    Comparators(Chip &chip, const Dac &dac1, const Dac &dac3);

    bool enabled(unsigned index) const
    {
        return bit(at(4 * index), 0);
    }
    bool second_input(unsigned index) const /* INPSEL */
    {
        return bit(at(4 * index), 8);
    }
    /* Output at a level of the plus input, in codes of 12 bits of the reference; with hysteresis
       on release. Keeps it as VALUE. */
    bool compare(unsigned index, double plus_code);

  protected:
    void put(std::uint32_t offset, std::uint32_t value, Master master) override;

  private:
    double threshold(unsigned index) const;

    const Dac &dac1_, &dac3_;
    std::array<bool, count> above_{};
    std::array<Ticks, count> ready_{};
};

/* Blocks that only keep what is written. */
RegisterBlock *make_syscfg(Chip &chip);
RegisterBlock *make_dbgmcu(Chip &chip);

} // namespace virtual_board

#endif
