/*
 * A block of registers that refuses, by Chip::fail, what it does not model: an unknown offset, a
 * bit that is reserved or not modelled written 1, an access while its clock is off.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_REGISTER_BLOCK_H
#define STEADYSTEP_VIRTUAL_BOARD_REGISTER_BLOCK_H

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "sil/virtual_board/chip.h"

namespace virtual_board
{

struct Register {
    std::uint32_t offset;
    const char *name;
    std::uint32_t writable;   /* bits that keep what is written */
    std::uint32_t reset = 0;  /* value after a reset */
    std::uint32_t status = 0; /* bits of the hardware: a write does not change them by itself */
    bool narrow = false;      /* accesses of 1 and 2 bytes are served */
};

enum class Access { read, write };

/* Whether the clock of a block runs: its enable bit in the clock tree. */
using Clocked = std::function<bool()>;

std::string hexadecimal(std::uint32_t value);

class RegisterBlock : public Peripheral
{
  public:
    RegisterBlock(Chip &chip, std::string name, const std::vector<Register> &registers);

    std::uint32_t read(std::uint32_t offset, unsigned bytes, Master master) final;
    void write(std::uint32_t offset, unsigned bytes, std::uint32_t value, Master master) final;
    void reset() override;

    /* Without it the block is always clocked. */
    void clocked_by(Clocked clocked)
    {
        clocked_ = std::move(clocked);
    }
    /* Called before every access of the core: what was put off until somebody looks comes now. */
    void before_access(std::function<void(Access)> act)
    {
        before_access_ = std::move(act);
    }
    bool clocked() const
    {
        return !clocked_ || clocked_();
    }
    /* What a register keeps, clocked or not. */
    std::uint32_t kept(std::uint32_t offset) const
    {
        return at(offset);
    }
    const std::string &name() const
    {
        return name_;
    }

  protected:
    /* What a read yields and what a write does; `value` has only modelled bits. */
    virtual std::uint32_t fetch(std::uint32_t offset, Master master);
    virtual void put(std::uint32_t offset, std::uint32_t value, Master master);

    std::uint32_t &at(std::uint32_t offset)
    {
        return values_[offset / 4];
    }
    std::uint32_t at(std::uint32_t offset) const
    {
        return values_[offset / 4];
    }
    /* Keeps the writable bits of a value. */
    void keep(std::uint32_t offset, std::uint32_t value);

    [[noreturn]] void refuse(std::uint32_t offset, std::uint32_t value,
                             const std::string &why) const;
    void require(bool allowed, std::uint32_t offset, std::uint32_t value, const char *why) const
    {
        if (!allowed) {
            refuse(offset, value, why);
        }
    }

    Chip &chip_;

  private:
    const Register &find(std::uint32_t offset, unsigned bytes) const;

    std::string name_;
    std::vector<Register> registers_;
    std::vector<int> index_;
    std::vector<std::uint32_t> values_;
    Clocked clocked_;
    std::function<void(Access)> before_access_;
};

constexpr std::uint32_t field(std::uint32_t value, unsigned position, unsigned bits)
{
    return (value >> position) & ((1u << bits) - 1u);
}
constexpr bool bit(std::uint32_t value, unsigned position)
{
    return ((value >> position) & 1u) != 0;
}

} // namespace virtual_board

#endif
