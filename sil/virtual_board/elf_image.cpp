#include "sil/virtual_board/elf_image.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <stdexcept>

namespace virtual_board
{

namespace
{

/* ELF-32, little-endian; names and offsets of the System V ABI, chapter 4. */
constexpr std::uint32_t machine_arm = 40;
constexpr std::uint32_t segment_load = 1;
constexpr std::uint32_t section_symbols = 2;
constexpr unsigned symbol_bytes = 16;
constexpr unsigned type_function = 2;

class Reader
{
  public:
    Reader(const std::string &name, const std::vector<std::uint8_t> &bytes)
        : name_(name), bytes_(bytes)
    {
    }

    [[noreturn]] void refuse(const std::string &what) const
    {
        throw std::invalid_argument(name_ + ": " + what);
    }

    std::uint32_t number(std::size_t offset, unsigned bytes) const
    {
        require(offset, bytes);
        std::uint32_t value = 0;
        for (unsigned i = 0; i < bytes; ++i) {
            value |= std::uint32_t{bytes_[offset + i]} << (8 * i);
        }
        return value;
    }
    std::uint32_t word(std::size_t offset) const
    {
        return number(offset, 4);
    }
    std::uint32_t half(std::size_t offset) const
    {
        return number(offset, 2);
    }

    std::string text(std::size_t offset) const
    {
        std::string text;
        for (; number(offset, 1) != 0; ++offset) {
            text += static_cast<char>(bytes_[offset]);
        }
        return text;
    }

    std::vector<std::uint8_t> bytes(std::size_t offset, std::size_t count) const
    {
        require(offset, count);
        const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(offset);
        return {begin, begin + static_cast<std::ptrdiff_t>(count)};
    }

  private:
    void require(std::size_t offset, std::size_t count) const
    {
        if (offset > bytes_.size() || count > bytes_.size() - offset) {
            refuse("ends in the middle of its tables");
        }
    }

    const std::string &name_;
    const std::vector<std::uint8_t> &bytes_;
};

} // namespace

ElfImage ElfImage::read(const std::string &file)
{
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    const std::streamoff size = stream ? static_cast<std::streamoff>(stream.tellg()) : 0;
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(std::max(size, std::streamoff{0})));
    stream.seekg(0);
    stream.read(reinterpret_cast<char *>(bytes.data()), size);
    if (!stream) {
        throw std::invalid_argument(file + ": cannot be read");
    }
    return parse(file, bytes);
}

ElfImage ElfImage::parse(const std::string &name, const std::vector<std::uint8_t> &bytes)
{
    const Reader elf(name, bytes);
    if (bytes.size() < 52 || elf.word(0) != 0x464c457f || elf.number(4, 1) != 1 ||
        elf.number(5, 1) != 1 || elf.half(18) != machine_arm) {
        elf.refuse("is no ELF program of a 32-bit little-endian Arm");
    }
    ElfImage image;
    const std::uint32_t segments = elf.word(28), segment_size = elf.half(42);
    for (std::uint32_t i = 0; i < elf.half(44); ++i) {
        const std::uint32_t header = segments + i * segment_size;
        const std::uint32_t in_file = elf.word(header + 16);
        if (elf.word(header) == segment_load && in_file > 0) {
            image.segments_.push_back(
                {elf.word(header + 12), elf.bytes(elf.word(header + 4), in_file)});
        }
    }
    const std::uint32_t sections = elf.word(32), section_size = elf.half(46);
    for (std::uint32_t i = 0; i < elf.half(48); ++i) {
        const std::uint32_t header = sections + i * section_size;
        if (elf.word(header + 4) != section_symbols) {
            continue;
        }
        const std::uint32_t names = elf.word(sections + elf.word(header + 24) * section_size + 16);
        const std::uint32_t begin = elf.word(header + 16), size = elf.word(header + 20);
        for (std::uint32_t at = begin; at + symbol_bytes <= begin + size; at += symbol_bytes) {
            const std::string symbol = elf.text(names + elf.word(at));
            const std::uint32_t value = elf.word(at + 4);
            if (symbol.empty() || symbol[0] == '$') {
                continue; /* mapping symbols distinguish code from data */
            }
            image.symbols_[symbol] = value;
            if ((elf.number(at + 12, 1) & 0xf) == type_function) {
                image.functions_[value & ~1u] = {symbol, elf.word(at + 8)};
            }
        }
    }
    if (image.segments_.empty()) {
        elf.refuse("holds nothing to load");
    }
    return image;
}

std::optional<std::uint32_t> ElfImage::symbol(const std::string &name) const
{
    const auto found = symbols_.find(name);
    return found == symbols_.end() ? std::nullopt : std::optional(found->second);
}

std::string ElfImage::place(std::uint32_t address) const
{
    char text[16];
    std::snprintf(text, sizeof text, "0x%08x", static_cast<unsigned>(address));
    std::string place = text;
    auto after = functions_.upper_bound(address);
    if (after != functions_.begin()) {
        const auto &[begin, function] = *--after;
        if (address - begin < std::max<std::uint32_t>(function.bytes, 2)) {
            std::snprintf(text, sizeof text, "+0x%x", static_cast<unsigned>(address - begin));
            place += " (" + function.name + text + ")";
        }
    }
    return place;
}

} // namespace virtual_board
