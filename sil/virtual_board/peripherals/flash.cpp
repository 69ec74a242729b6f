#include "sil/virtual_board/peripherals/flash.h"

#include <algorithm>

namespace virtual_board
{

namespace
{

enum : std::uint32_t { ACR = 0x00, KEYR = 0x08, SR = 0x10, CR = 0x14, ECCR = 0x18, OPTR = 0x20 };
enum : std::uint32_t { PG = 1u << 0, PER = 1u << 1, STRT = 1u << 16, LOCK = 1u << 31 };
enum : std::uint32_t { DCEN = 1u << 10, DBG_SWEN = 1u << 18 };
enum : std::uint32_t { ECCC = 1u << 30, ECCD = 1u << 31, BK_ECC = 1u << 21 };
enum : std::uint32_t { EOP = 1u << 0, ERRORS = 0xc3fau, BSY = 1u << 16, EOPIE = 1u << 24 };

constexpr Ticks erase_time = ticks_per_s / 1000 * 22;
constexpr Ticks program_time = ticks_per_s / 1000000 * 85;

} // namespace

Flash::Flash(Chip &chip, Rcc &rcc)
    : RegisterBlock(chip, "FLASH",
                    {{ACR, "ACR", 0x47f0f & ~0x6000u, 0x40600},
                     {KEYR, "KEYR", 0xffffffff},
                     {SR, "SR", 0, 0, EOP | ERRORS | BSY},
                     {CR, "CR", 0xc3000bfb & ~0x40000000u, 0xc0000000, STRT | 0x40000000u},
                     {ECCR, "ECCR", 0, 0, 0xf1000000u | BK_ECC | 0x7ffffu},
                     {OPTR, "OPTR", 0, 0xffeff8aa}}),
      rcc_(rcc), memory_(bytes, 0xff), damaged_(bytes / 8), done_([this] { finish(); })
{
}

void Flash::reset()
{
    if (busy_) {
        /* The operation is cut short: the cells of the page or double word are undefined, and what
           the ECC makes of them, too; here they all fail it. */
        std::fill_n(memory_.begin() + target_, length_, std::uint8_t{0});
        std::fill_n(damaged_.begin() + target_ / 8, length_ / 8, true);
        busy_ = false;
        chip_.schedule(done_, Event::never);
        if (on_change) {
            on_change(base + target_, length_);
        }
    }
    RegisterBlock::reset();
    key_step_ = 0;
    first_word_ = false;
    rcc_.wait_states = 0;
}

std::uint32_t Flash::fetch(std::uint32_t offset, Master)
{
    if (offset == SR) {
        return (at(SR) & ~BSY) | (busy_ ? BSY : 0u);
    }
    require(offset != KEYR, offset, 0, "write only");
    return at(offset);
}

void Flash::put(std::uint32_t offset, std::uint32_t value, Master)
{
    switch (offset) {
    case ACR:
        require((value & DBG_SWEN) != 0, offset, value, debugger_off);
        require((value & at(ACR) & 0x200u) == 0 || (value & 0x800u) == 0, offset, value,
                "ICRST while the instruction cache is enabled");
        require((value & at(ACR) & 0x400u) == 0 || (value & 0x1000u) == 0, offset, value,
                "DCRST while the data cache is enabled");
        require(
            !busy_ || (value & DCEN) == 0, offset, value,
            "DCEN during an operation: reads while writing may corrupt the cache (ES0430, 2.2.2)");
        keep(ACR, value);
        rcc_.wait_states = field(value, 0, 4);
        rcc_.check();
        return;
    case KEYR:
        unlock(value);
        return;
    case SR:
        at(SR) &= ~(value & (EOP | ERRORS));
        interrupt();
        return;
    case CR:
        control(value);
        return;
    case ECCR:
        require((value & ~(at(ECCR) | ECCD)) == 0, offset, value, "ECCC and ECCD are modelled");
        at(ECCR) &= ~(value & (ECCC | ECCD));
        return;
    default:
        refuse(offset, value, "not modelled");
    }
}

void Flash::unlock(std::uint32_t value)
{
    require((at(CR) & LOCK) != 0, KEYR, value, "written while CR is unlocked already");
    const std::uint32_t key[2] = {0x45670123u, 0xcdef89abu};
    require(value == key[key_step_], KEYR, value,
            "wrong key or order: CR would stay locked until the next reset");
    if (++key_step_ == 2) {
        key_step_ = 0;
        at(CR) &= ~LOCK;
    }
}

void Flash::control(std::uint32_t value)
{
    require((at(CR) & LOCK) == 0, CR, value, "written while locked");
    require(!busy_, CR, value, "written while BSY");
    require((value & (PG | STRT)) == 0 || (at(ACR) & DCEN) == 0, CR, value,
            "PG or STRT while the data cache is on: reads while writing may corrupt it (ES0430, "
            "2.2.2)");
    keep(CR, value);
    at(CR) &= ~STRT;
    first_word_ = false;
    if ((value & STRT) != 0) {
        require((value & PER) != 0 && (value & PG) == 0, CR, value,
                "STRT: only a page erase (PER without PG) is modelled");
        require((at(SR) & ERRORS) == 0, CR, value, "STRT while error flags are set");
        bank_ = bit(value, 11) ? 1 : 0;
        target_ = bank_ * bank_bytes + field(value, 3, 7) * page_bytes;
        length_ = page_bytes;
        counters_.erases++;
        start(erase_time);
    }
    interrupt();
}

void Flash::store(std::uint32_t address, unsigned size, std::uint32_t value)
{
    const std::string where = "FLASH memory at " + hexadecimal(address) + ": ";
    if ((at(CR) & LOCK) != 0) {
        chip_.fail(where + "programmed while CR is locked (PGSERR)");
    }
    if ((at(CR) & (PG | PER)) != PG) {
        chip_.fail(where + "programmed while PG is not set (PGSERR)");
    }
    if (size != 4) {
        chip_.fail(where + "programmed with " + std::to_string(size) +
                   " bytes; expected 4 (SIZERR)");
    }
    if (busy_) {
        chip_.fail(where + "programmed while BSY");
    }
    if ((at(SR) & ERRORS) != 0) {
        chip_.fail(where + "programmed while error flags are set (PGSERR)");
    }
    if (!first_word_) {
        if (address % 8 != 0) {
            chip_.fail(where + "not the first half of a double word (PGAERR)");
        }
        first_word_ = true;
        first_address_ = address;
        first_value_ = value;
        return;
    }
    first_word_ = false;
    if (address != first_address_ + 4) {
        chip_.fail(where + "not the second half of the double word at " +
                   hexadecimal(first_address_) + " (PGAERR)");
    }
    target_ = first_address_ - base;
    length_ = 8;
    bank_ = target_ / bank_bytes;
    const bool all_zero = first_value_ == 0 && value == 0;
    for (std::uint32_t i = 0; i < 8; i++) {
        if (memory_[target_ + i] != 0xff && !all_zero) {
            chip_.fail(where + "double word is not erased (PROGERR)");
        }
        result_[i] = static_cast<std::uint8_t>((i < 4 ? first_value_ : value) >> (8 * (i % 4)));
    }
    counters_.programs++;
    start(program_time);
}

void Flash::start(Ticks duration)
{
    busy_ = true;
    end_ = chip_.now() + duration;
    chip_.schedule(done_, end_);
}

void Flash::finish()
{
    if (length_ == page_bytes) {
        std::fill_n(memory_.begin() + target_, length_, std::uint8_t{0xff});
        std::fill_n(damaged_.begin() + target_ / 8, length_ / 8, false);
    } else {
        std::copy_n(result_, length_, memory_.begin() + target_);
    }
    busy_ = false;
    if ((at(CR) & EOPIE) != 0) {
        at(SR) |= EOP; /* RM0440: set only if the interrupt is enabled */
    }
    interrupt();
    if (on_change) {
        on_change(base + target_, length_);
    }
}

void Flash::interrupt()
{
    chip_.interrupt(interrupt_line, (at(SR) & EOP) != 0 && (at(CR) & EOPIE) != 0);
}

void Flash::core_reads(std::uint32_t address, unsigned)
{
    const std::uint32_t word = (address - base) / 8;
    const std::uint32_t place = (word * 8 >= bank_bytes ? BK_ECC : 0u) | word * 8 % bank_bytes;
    if (word == weak_ && (at(ECCR) & (ECCC | ECCD)) == 0) {
        at(ECCR) = ECCC | place;
    }
    if (damaged_[word] && (at(ECCR) & ECCC) == 0) {
        counters_.double_errors++;
        at(ECCR) = ECCD | place;
        chip_.non_maskable_interrupt();
    }
}

Ticks Flash::busy_until(std::uint32_t address) const
{
    const bool same = (address - base) / bank_bytes == bank_;
    return busy_ && same ? end_ : chip_.now();
}

} // namespace virtual_board
