/*
 * Where in a block of instructions its accesses to registers come: noted once, while the block is
 * watched by the instruction, so that it can be watched as a whole from then on.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_REGISTER_LESSONS_H
#define STEADYSTEP_VIRTUAL_BOARD_REGISTER_LESSONS_H

#include <cstdint>
#include <map>
#include <vector>

#include "sil/virtual_board/chip_description.h"

namespace virtual_board
{

struct RegisterAccess {
    std::uint32_t instruction, address;
};

class RegisterLessons
{
  public:
    bool running() const
    {
        return block_.bytes > 0;
    }
    /* The core begins with this block, by the instruction. */
    void begin(AddressRange block);
    void note(const RegisterAccess &access);
    /* Something has come between: nothing is learnt. */
    void abandon();
    /* The block has been executed: what it accesses is known. Returns the block. */
    AddressRange finish();

    /* nullptr: nothing is known of this block. */
    const std::vector<RegisterAccess> *known(AddressRange block) const;
    /* The block accesses other registers than it did: it is not learnt again. */
    void refute(std::uint32_t block);
    bool refuted(std::uint32_t block) const;

  private:
    struct Lesson {
        std::uint32_t bytes = 0; /* 0: refuted */
        std::vector<RegisterAccess> accesses;
    };

    AddressRange block_ = {0, 0}; /* 0 bytes: none is learnt */
    std::vector<RegisterAccess> noted_;
    std::map<std::uint32_t, Lesson> lessons_; /* by the block's address */
};

} // namespace virtual_board

#endif
