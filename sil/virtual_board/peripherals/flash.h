/*
 * FLASH: 512 KB in two banks of 128 pages of 2 KB; erase 22 ms, double word 85 us. The contents
 * stay over resets; double words whose operation a reset or a loss of power cut short read as a
 * double error of the ECC. The core's bus calls `store` for writes into the memory, `busy_until`
 * for reads and fetches of a bank (read while write: only the same bank stalls) and `core_reads`.
 * Operations while the data cache is on are refused (erratum ES0430 2.2.2).
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_FLASH_H
#define STEADYSTEP_VIRTUAL_BOARD_FLASH_H

#include "sil/virtual_board/peripherals/clock_tree.h"

namespace virtual_board
{

class Flash : public RegisterBlock, public FlashMemory
{
  public:
    static constexpr std::uint32_t base = 0x08000000, bytes = 512 * 1024, page_bytes = 2048;
    static constexpr std::uint32_t bank_bytes = bytes / 2;
    static constexpr unsigned interrupt_line = 4;
    /* Why ACR.DBG_SWEN, 1 after reset, is not to be cleared. */
    static constexpr const char *debugger_off =
        "DBG_SWEN cleared: no debugger reaches the running program, it could not be flashed again";

    Flash(Chip &chip, Rcc &rcc);

    void reset() override;

    std::vector<std::uint8_t> &memory() override
    {
        return memory_;
    }
    /* A write of the core or a DMA channel into the memory; `address` is absolute. */
    void store(std::uint32_t address, unsigned size, std::uint32_t value) override;
    /* End of the operation on the bank of this address; now or earlier if there is none. */
    Ticks busy_until(std::uint32_t address) const override;
    /* Of a damaged double word: sets ECCR.ECCD and raises the non-maskable interrupt. */
    void core_reads(std::uint32_t address, unsigned size) override;

    /* From now on one bit of the double word there is wrong, which the ECC corrects: ECCR.ECCC is
       set, and while it is no double error is seen. */
    void weaken(std::uint32_t offset)
    {
        weak_ = offset / 8;
    }

    struct Counters {
        unsigned erases = 0, programs = 0, double_errors = 0; /* double words read damaged */
    };
    const Counters &counters() const
    {
        return counters_;
    }
    /* Called after the contents have changed: address, length. */
    std::function<void(std::uint32_t, std::uint32_t)> on_change;

  protected:
    std::uint32_t fetch(std::uint32_t offset, Master master) override;
    void put(std::uint32_t offset, std::uint32_t value, Master master) override;

  private:
    void control(std::uint32_t value);
    void unlock(std::uint32_t value);
    void start(Ticks duration);
    void finish();
    void interrupt();

    Rcc &rcc_;
    std::vector<std::uint8_t> memory_;
    std::vector<bool> damaged_;  /* double words that two and more bits of the check show wrong */
    std::uint32_t weak_ = bytes; /* double word with a single error; bytes: none */
    unsigned key_step_ = 0;
    unsigned bank_ = 0; /* of the present operation */
    bool busy_ = false;
    Ticks end_ = 0;
    bool first_word_ = false;
    std::uint32_t first_address_ = 0, first_value_ = 0;
    std::uint32_t target_ = 0, length_ = 0;
    std::uint8_t result_[8] = {};
    Counters counters_;
    Event done_;
};

} // namespace virtual_board

#endif
