/*
 * What of the STM32G071 differs from the blocks that are modelled for the STM32G474: clock tree,
 * flash controller, converter, and numbers: interrupt lines, DMA requests. RM0444.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_STM32G071_BLOCKS_H
#define STEADYSTEP_VIRTUAL_BOARD_STM32G071_BLOCKS_H

#include <map>

#include "sil/virtual_board/peripherals/advanced_timer.h"
#include "sil/virtual_board/peripherals/clock_tree.h"
#include "sil/virtual_board/peripherals/dma.h"
#include "sil/virtual_board/peripherals/trigger.h"

namespace virtual_board
{

/* The chip as a block of the STM32G474 sees it: the same, but for the numbers of the lines. */
class G071Lines final : public Chip
{
  public:
    explicit G071Lines(Chip &chip) : chip_(chip)
    {
    }
    Ticks now() const override
    {
        return chip_.now();
    }
    Ticks core_cycle() const override
    {
        return chip_.core_cycle();
    }
    void set_core_cycle(Ticks ticks) override
    {
        chip_.set_core_cycle(ticks);
    }
    void schedule(Event &event, Ticks at) override
    {
        chip_.schedule(event, at);
    }
    void interrupt(unsigned line, bool level) override;
    std::uint32_t load(std::uint32_t address, unsigned bytes) override
    {
        return chip_.load(address, bytes);
    }
    void store(std::uint32_t address, unsigned bytes, std::uint32_t value) override
    {
        chip_.store(address, bytes, value);
    }
    void reset(const std::string &cause) override
    {
        chip_.reset(cause);
    }
    [[noreturn]] void fail(const std::string &what) const override;

  private:
    Chip &chip_;
    std::map<unsigned, bool> levels_; /* of the lines of the STM32G474 */
};

/*
 * RCC. The oscillators, the PLL and their rules are those of the STM32G474's model, which stands
 * behind it; the registers are laid out anew.
 */
class G071Rcc : public RegisterBlock
{
  public:
    explicit G071Rcc(Chip &chip);

    void reset() override;
    void record_cause(const std::string &cause)
    {
        tree_.record_cause(cause);
    }
    bool enabled(std::uint32_t offset, unsigned position) const
    {
        return bit(at(offset), position);
    }
    Rcc &tree()
    {
        return tree_;
    }

  protected:
    std::uint32_t fetch(std::uint32_t offset, Master master) override;
    void put(std::uint32_t offset, std::uint32_t value, Master master) override;

  private:
    Pwr power_;
    Rcc tree_;
};

/* FLASH: 128 KB in one bank, 64 pages of 2 KB; erase 22 ms, double word 85 us. */
class G071Flash : public RegisterBlock, public FlashMemory
{
  public:
    static constexpr std::uint32_t base = 0x08000000, bytes = 128 * 1024, page_bytes = 2048;

    G071Flash(Chip &chip, Rcc &tree);

    void reset() override;
    std::vector<std::uint8_t> &memory() override
    {
        return memory_;
    }
    void store(std::uint32_t address, unsigned size, std::uint32_t value) override;
    Ticks busy_until(std::uint32_t) const override
    {
        return busy_until_;
    }
    /* Of a damaged double word: sets ECCR.ECCD and raises the non-maskable interrupt. */
    void core_reads(std::uint32_t address, unsigned size) override;
    /* From now on an operation does not end. */
    void wear_out()
    {
        worn_out_ = true;
    }
    unsigned double_errors() const
    {
        return double_errors_;
    }

  protected:
    std::uint32_t fetch(std::uint32_t offset, Master master) override;
    void put(std::uint32_t offset, std::uint32_t value, Master master) override;

  private:
    void control(std::uint32_t value);

    Rcc &tree_;
    std::vector<std::uint8_t> memory_;
    Ticks busy_until_ = 0;
    unsigned key_step_ = 0;
    bool first_word_ = false;
    std::uint32_t first_address_ = 0, first_value_ = 0;
    std::uint32_t target_ = 0, length_ = 0; /* of the present operation */
    std::vector<bool> damaged_;             /* double words that fail the ECC */
    bool worn_out_ = false;
    unsigned double_errors_ = 0;
};

/* DMAMUX: the requests have other numbers. */
class G071Dmamux : public Peripheral
{
  public:
    explicit G071Dmamux(Dmamux &inner) : inner_(inner)
    {
    }
    std::uint32_t read(std::uint32_t offset, unsigned size, Master master) override;
    void write(std::uint32_t offset, unsigned size, std::uint32_t value, Master master) override;
    void reset() override
    {
        inner_.reset();
    }

  private:
    Dmamux &inner_;
};

/* TIM1 with its break input at a pin; behind the pin stands the first comparator of the model. */
class G071Timer1 : public Peripheral
{
  public:
    explicit G071Timer1(AdvancedTimer &inner) : inner_(inner)
    {
    }
    std::uint32_t read(std::uint32_t offset, unsigned size, Master master) override;
    void write(std::uint32_t offset, unsigned size, std::uint32_t value, Master master) override;
    void reset() override;
    void break_pin(bool level)
    {
        inner_.comparator(0, level);
    }

  private:
    AdvancedTimer &inner_;
    bool connected_ = false; /* the pin, since the last reset */
};

/* The one ADC: sequence of channels in the order of CHSELR, hardware trigger TIM3 TRGO, DMA. */
class G071Adc : public RegisterBlock
{
  public:
    G071Adc(Chip &chip, Triggers &triggers, Dmamux &dmamux);

    void reset() override;

    /* 12-bit code of a channel whose conversion ends now. */
    std::function<std::uint32_t(unsigned channel)> input;
    /* A result has been moved by DMA: to this address. */
    std::function<void(unsigned channel, std::uint32_t address)> moved;

    /* For a test: no trigger arrives any more, until the next reset. */
    void lose_triggers()
    {
        deaf_ = true;
    }
    bool deaf() const
    {
        return deaf_;
    }

    struct Counters {
        std::uint64_t sequences = 0, overruns = 0, missed_triggers = 0;
    };
    Counters counters;

  protected:
    std::uint32_t fetch(std::uint32_t offset, Master master) override;
    void put(std::uint32_t offset, std::uint32_t value, Master master) override;

  private:
    void control(std::uint32_t value);
    void triggered(Trigger source, TriggerEdge edge);
    void converted();
    Ticks clock() const; /* period of the converter's clock */
    Ticks conversion() const;

    Dmamux &dmamux_;
    unsigned rank_ = 0;
    bool busy_ = false, calibrated_ = false, deaf_ = false;
    Ticks regulator_ready_ = Event::never, calibration_end_ = 0, ready_at_ = Event::never;
    Event end_;
};

} // namespace virtual_board

#endif
