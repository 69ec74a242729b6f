/* An ELF program of a 32-bit Arm: what goes where, and what lies where. */
#ifndef STEADYSTEP_VIRTUAL_BOARD_ELF_IMAGE_H
#define STEADYSTEP_VIRTUAL_BOARD_ELF_IMAGE_H

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace virtual_board
{

/* What a programmer writes: bytes at a load address. */
struct Segment {
    std::uint32_t address;
    std::vector<std::uint8_t> bytes;
};

class ElfImage
{
  public:
    /* Throws std::invalid_argument that names the file and what is wrong with it. */
    static ElfImage read(const std::string &file);
    static ElfImage parse(const std::string &name, const std::vector<std::uint8_t> &bytes);

    const std::vector<Segment> &segments() const
    {
        return segments_;
    }
    /* Value of a symbol of the program or its linker script. */
    std::optional<std::uint32_t> symbol(const std::string &name) const;
    /* "function+0x12", or the address alone. */
    std::string place(std::uint32_t address) const;

  private:
    struct Function {
        std::string name;
        std::uint32_t bytes;
    };

    std::vector<Segment> segments_;
    std::map<std::string, std::uint32_t> symbols_;
    std::map<std::uint32_t, Function> functions_;
};

} // namespace virtual_board

#endif
