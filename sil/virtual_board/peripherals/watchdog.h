/*
 * IWDG: counts the 32 kHz of the LSI down from RLR; without a reload in time it resets the chip.
 * No window. RM0440, chapter IWDG.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_WATCHDOG_H
#define STEADYSTEP_VIRTUAL_BOARD_WATCHDOG_H

#include "sil/virtual_board/peripherals/register_block.h"

namespace virtual_board
{

class Watchdog : public RegisterBlock
{
  public:
    explicit Watchdog(Chip &chip);

    void reset() override;

    Ticks timeout() const;
    bool running() const
    {
        return running_;
    }
    struct Counters {
        std::uint64_t reloads = 0;
        Ticks longest = 0; /* between two reloads */
    };
    Counters counters;

  protected:
    std::uint32_t fetch(std::uint32_t offset, Master master) override;
    void put(std::uint32_t offset, std::uint32_t value, Master master) override;

  private:
    void key(std::uint32_t value);
    void reload();

    bool running_ = false, unlocked_ = false;
    Ticks reloaded_ = 0;
    Ticks prescaler_busy_ = 0, reload_busy_ = 0;
    Event timeout_event_;
};

} // namespace virtual_board

#endif
