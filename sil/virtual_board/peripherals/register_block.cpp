#include "sil/virtual_board/peripherals/register_block.h"

#include <cstdlib>

namespace virtual_board
{

std::string hexadecimal(std::uint32_t value)
{
    std::string text = "0x";
    bool started = false;
    for (int shift = 28; shift >= 0; shift -= 4) {
        const unsigned digit = (value >> shift) & 15u;
        if (digit != 0 || started || shift == 0) {
            started = true;
            text += "0123456789abcdef"[digit];
        }
    }
    return text;
}

RegisterBlock::RegisterBlock(Chip &chip, std::string name, const std::vector<Register> &registers)
    : chip_(chip), name_(std::move(name)), registers_(registers)
{
    std::uint32_t last = 0;
    for (const Register &entry : registers_) {
        last = entry.offset > last ? entry.offset : last;
    }
    index_.assign(last / 4 + 1, -1);
    values_.assign(last / 4 + 1, 0);
    for (std::size_t i = 0; i < registers_.size(); i++) {
        index_[registers_[i].offset / 4] = static_cast<int>(i);
    }
    RegisterBlock::reset();
}

void RegisterBlock::reset()
{
    for (const Register &entry : registers_) {
        at(entry.offset) = entry.reset;
    }
}

const Register &RegisterBlock::find(std::uint32_t offset, unsigned bytes) const
{
    const std::size_t place = offset / 4;
    if (place >= index_.size() || index_[place] < 0) {
        chip_.fail(name_ + ": no register is modelled at offset " + hexadecimal(offset));
    }
    const Register &entry = registers_[static_cast<std::size_t>(index_[place])];
    if (bytes != 4 && !(entry.narrow && offset == entry.offset)) {
        chip_.fail(name_ + "." + entry.name + ": access of " + std::to_string(bytes) +
                   " bytes at offset " + hexadecimal(offset) + "; expected the whole word");
    }
    if (!clocked()) {
        chip_.fail(name_ + "." + entry.name + ": access while its clock is off (RCC enable bit)");
    }
    return entry;
}

std::uint32_t RegisterBlock::read(std::uint32_t offset, unsigned bytes, Master master)
{
    find(offset, bytes);
    if (before_access_ && master == Master::core) {
        before_access_(Access::read);
    }
    const std::uint32_t value = fetch(offset, master);
    return bytes == 4 ? value : value & ((1u << (8 * bytes)) - 1u);
}

void RegisterBlock::write(std::uint32_t offset, unsigned bytes, std::uint32_t value, Master master)
{
    const Register &entry = find(offset, bytes);
    const std::uint32_t unknown = value & ~(entry.writable | entry.status);
    if (unknown != 0) {
        refuse(offset, value,
               "bits " + hexadecimal(unknown) + " are reserved, read-only or not modelled");
    }
    if (before_access_ && master == Master::core) {
        before_access_(Access::write);
    }
    put(offset, value, master);
}

std::uint32_t RegisterBlock::fetch(std::uint32_t offset, Master)
{
    return at(offset);
}

void RegisterBlock::put(std::uint32_t offset, std::uint32_t value, Master)
{
    keep(offset, value);
}

void RegisterBlock::keep(std::uint32_t offset, std::uint32_t value)
{
    const Register &entry =
        registers_[static_cast<std::size_t>(index_[static_cast<std::size_t>(offset / 4)])];
    at(offset) = (value & entry.writable) | (at(offset) & ~entry.writable);
}

void RegisterBlock::refuse(std::uint32_t offset, std::uint32_t value, const std::string &why) const
{
    const int place = index_[static_cast<std::size_t>(offset / 4)];
    chip_.fail(name_ + "." + registers_[static_cast<std::size_t>(place)].name + " = " +
               hexadecimal(value) + ": " + why);
    std::abort(); /* Chip::fail has thrown; the compiler does not see it through a virtual call */
}

} // namespace virtual_board
