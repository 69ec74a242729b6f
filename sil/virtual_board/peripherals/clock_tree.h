/*
 * RCC and PWR: oscillators, PLL, bus clocks, enables, resets and their causes; the supply range
 * that the core clock needs. Reference: RM0440, chapters PWR and RCC; limits of DS12288.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_CLOCK_TREE_H
#define STEADYSTEP_VIRTUAL_BOARD_CLOCK_TREE_H

#include "sil/virtual_board/peripherals/register_block.h"

namespace virtual_board
{

class Pwr : public RegisterBlock
{
  public:
    explicit Pwr(Chip &chip);

    bool range_1() const
    {
        return field(at(0x00), 9, 2) == 1;
    }
    /* Range 1 boost: R1MODE (bit 8 of CR5) cleared. */
    bool boost() const
    {
        return range_1() && !bit(at(0x80), 8);
    }
    void set_supply(double supply_V); /* of the chip, 3.3 V; the monitor (PVD) looks */
    void reset() override;
    std::function<void()> on_change;         /* the clock tree checks its limits again */
    std::function<void(bool low)> on_supply; /* the monitor's output */

  protected:
    void put(std::uint32_t offset, std::uint32_t value, Master master) override;

  private:
    void watch_supply();

    double supply_V_ = 3.3;
};

struct ClockConfig {
    double crystal_Hz = 24e6; /* HSE */
    bool crystal_starts = true;
};

class Rcc : public RegisterBlock
{
  public:
    Rcc(Chip &chip, const Pwr &pwr, const ClockConfig &config);

    void reset() override; /* keeps the causes of resets */
    /* Causes as Chip::reset knows them: "power-on", "pin", "software", "watchdog"... */
    void record_cause(const std::string &cause);

    /* The bit of an enable register, as offset and position. */
    bool enabled(std::uint32_t offset, unsigned position) const
    {
        return bit(at(offset), position);
    }
    /* Resets the block while its bit in the reset register (0x20 below the enables) is 1. */
    void owns(Peripheral &block, std::uint32_t enable_offset, unsigned position);

    double hclk_Hz() const
    {
        return hclk_Hz_;
    }
    double pclk_Hz(unsigned bus) const; /* 1 or 2 */
    double sysclk_Hz() const;
    double hsi_Hz() const
    {
        return 16e6;
    }
    /* Of the timers on bus 1 or 2: the bus clock, doubled if the bus is divided. */
    Ticks timer_clock(unsigned bus) const
    {
        return timer_clocks_[bus - 1];
    }
    unsigned lpuart_source() const
    {
        return field(at(0x88), 10, 2);
    }
    unsigned fdcan_source() const /* 0: HSE, 1: PLL, 2: PCLK1 */
    {
        return field(at(0x88), 24, 2);
    }
    unsigned adc_source(unsigned group) const /* 0: ADC1/2, 1: ADC3/4/5; 0 none, 1 PLL, 2 SYSCLK */
    {
        return field(at(0x88), 28 + 2 * group, 2);
    }

    void check();                   /* limits of supply and flash at the present clock */
    unsigned wait_states = 0;       /* set by the flash */
    std::function<void()> on_clock; /* called after HCLK or a bus clock has changed */

  protected:
    std::uint32_t fetch(std::uint32_t offset, Master master) override;
    void put(std::uint32_t offset, std::uint32_t value, Master master) override;

  private:
    void control(std::uint32_t value);
    void configure(std::uint32_t value);
    void pll_configuration(std::uint32_t value);
    void apply();
    double pll_Hz() const;
    double source_Hz(unsigned source) const;

    struct Owned {
        Peripheral *block;
        std::uint32_t offset;
        unsigned position;
    };

    const Pwr &pwr_;
    ClockConfig config_;
    std::vector<Owned> owned_;
    double hclk_Hz_ = 16e6;
    Ticks timer_clocks_[2] = {1, 1};
    Ticks ready_hse_ = Event::never, ready_hsi_ = 0, ready_pll_ = Event::never;
    Ticks ready_lsi_ = Event::never;
    Ticks fast_since_ = 0; /* when SYSCLK went above 80 MHz behind a divided AHB */
    std::uint32_t causes_ = 0;
};

} // namespace virtual_board

#endif
