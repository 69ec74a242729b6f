#include <algorithm>

#include "sil/virtual_board/peripherals/flash.h"
#include "sil/virtual_board/peripherals/stm32g071_blocks.h"

namespace virtual_board
{

namespace
{

enum : std::uint32_t { DBG_SWEN = 1u << 18 };
enum : std::uint32_t { ACR = 0x00, KEYR = 0x08, SR = 0x10, CR = 0x14, ECCR = 0x18 };
enum : std::uint32_t { ECCD = 1u << 31 };
enum : std::uint32_t { PG = 1u << 0, PER = 1u << 1, STRT = 1u << 16, LOCK = 1u << 31 };
enum : std::uint32_t { EOP = 1u << 0, ERRORS = 0xc3fau, BSY = 1u << 16 };

constexpr Ticks erase_time = ticks_per_s / 1000 * 22;
constexpr Ticks program_time = ticks_per_s / 1000000 * 85;

} // namespace

G071Flash::G071Flash(Chip &chip, Rcc &tree)
    : RegisterBlock(chip, "FLASH",
                    {{ACR, "ACR", 0x50b07, 0x40600},
                     {KEYR, "KEYR", 0xffffffff},
                     {SR, "SR", 0, 0, EOP | ERRORS | BSY | (1u << 18)},
                     {CR, "CR", 0x800103fb, 0xc0000000, STRT | 0x40000000u},
                     {ECCR, "ECCR", 0, 0, 0xc0103fffu}}),
      tree_(tree), memory_(bytes, 0xff), damaged_(bytes / 8)
{
}

void G071Flash::reset()
{
    if (chip_.now() < busy_until_) { /* cut short: undefined cells, which here all fail the ECC */
        std::fill_n(memory_.begin() + target_, length_, std::uint8_t{0});
        std::fill_n(damaged_.begin() + target_ / 8, length_ / 8, true);
    }
    RegisterBlock::reset();
    key_step_ = 0;
    first_word_ = false;
    busy_until_ = 0;
    tree_.wait_states = 0;
}

std::uint32_t G071Flash::fetch(std::uint32_t offset, Master)
{
    if (offset == SR) {
        return at(SR) | (chip_.now() < busy_until_ || (worn_out_ && busy_until_ != 0) ? BSY : 0u);
    }
    require(offset != KEYR, offset, 0, "write only");
    return at(offset);
}

void G071Flash::put(std::uint32_t offset, std::uint32_t value, Master)
{
    if (offset == ACR) {
        require((value & DBG_SWEN) != 0, offset, value, Flash::debugger_off);
        keep(ACR, value);
        tree_.wait_states = field(value, 0, 3);
        tree_.check();
    } else if (offset == KEYR) {
        const std::uint32_t key[2] = {0x45670123u, 0xcdef89abu};
        require((at(CR) & LOCK) != 0, offset, value, "written while CR is unlocked already");
        require(value == key[key_step_], offset, value, "wrong key or order");
        if (++key_step_ == 2) {
            key_step_ = 0;
            at(CR) &= ~LOCK;
        }
    } else if (offset == SR) {
        at(SR) &= ~(value & (EOP | ERRORS));
    } else if (offset == ECCR) {
        at(ECCR) &= ~(value & ECCD);
    } else {
        control(value);
    }
}

void G071Flash::control(std::uint32_t value)
{
    require((at(CR) & LOCK) == 0, CR, value, "written while locked");
    require(chip_.now() >= busy_until_, CR, value, "written while BSY");
    keep(CR, value);
    at(CR) &= ~STRT;
    first_word_ = false;
    if ((value & STRT) != 0) {
        require((value & PER) != 0 && (value & PG) == 0, CR, value,
                "STRT: only a page erase (PER without PG) is modelled");
        const unsigned page = field(value, 3, 7);
        require(page < bytes / page_bytes, CR, value, "PNB: expected 0...63");
        target_ = page * page_bytes;
        length_ = page_bytes;
        std::fill_n(memory_.begin() + target_, length_, std::uint8_t{0xff});
        std::fill_n(damaged_.begin() + target_ / 8, length_ / 8, false);
        busy_until_ = chip_.now() + erase_time;
    }
}

void G071Flash::store(std::uint32_t address, unsigned size, std::uint32_t value)
{
    const std::string where = "FLASH memory at " + hexadecimal(address) + ": ";
    if ((at(CR) & (LOCK | PG | PER)) != PG) {
        chip_.fail(where + "programmed while CR is locked or PG is not set (PGSERR)");
    }
    if (size != 4 || chip_.now() < busy_until_) {
        chip_.fail(where + "programmed while BSY, or not by 4 bytes (SIZERR)");
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
        chip_.fail(where + "not the second half of the double word (PGAERR)");
    }
    for (std::uint32_t i = 0; i < 8; i++) {
        std::uint8_t &cell = memory_[first_address_ - base + i];
        if (cell != 0xff) {
            chip_.fail(where + "double word is not erased (PROGERR)");
        }
        cell = static_cast<std::uint8_t>((i < 4 ? first_value_ : value) >> (8 * (i % 4)));
    }
    target_ = first_address_ - base;
    length_ = 8;
    busy_until_ = chip_.now() + program_time;
}

void G071Flash::core_reads(std::uint32_t address, unsigned)
{
    const std::uint32_t word = (address - base) / 8;
    if (damaged_[word]) {
        double_errors_++;
        at(ECCR) = ECCD | word;
        chip_.non_maskable_interrupt();
    }
}

} // namespace virtual_board
