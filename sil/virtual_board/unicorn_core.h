/*
 * The instructions of a Cortex-M, executed by libunicorn; nothing of exceptions, time or
 * peripherals. The only file that knows libunicorn.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_UNICORN_CORE_H
#define STEADYSTEP_VIRTUAL_BOARD_UNICORN_CORE_H

#include <cstdint>
#include <exception>
#include <list>
#include <vector>

#include "sil/virtual_board/chip_description.h"

struct uc_struct;

namespace virtual_board
{

/* Who watches the core. What these throw ends UnicornCore::run with that exception. */
class CoreObserver
{
  public:
    virtual ~CoreObserver() = default;

    /* Before every instruction that is watched by itself; false: stop before it. */
    virtual bool before_instruction(std::uint32_t address, unsigned bytes) = 0;
    /* Before a straight run of instructions, if watched by the block; false: stop before it. It
       may contain instructions that are watched by themselves, too. */
    virtual bool before_block(std::uint32_t address, unsigned bytes) = 0;
    /* An access of the present instruction, or of one of the present block's, to registers. */
    virtual std::uint32_t read(std::uint32_t address, unsigned bytes) = 0;
    virtual void write(std::uint32_t address, unsigned bytes, std::uint32_t value) = 0;
};

enum class CoreRegister {
    r0,
    r1,
    r2,
    r3,
    r12,
    sp,
    lr,
    pc,
    xpsr,
    control,
    primask,
    base_priority,
    faultmask,
    fpscr
};

enum class Stopped {
    by_observer,
    by_itself, /* behind the instruction that let it, WFI as a rule */
    exception_return,
    supervisor_call,
    breakpoint,
    unmapped_read, /* here and below: the last instruction was not executed */
    unmapped_write,
    unmapped_fetch,
    read_only,
    unaligned,
    undefined_instruction
};

/* What the core may do with memory besides reading it. */
enum class MemoryUse {
    program, /* run it */
    both
};

class UnicornCore
{
  public:
    UnicornCore(const CoreModel &model, CoreObserver &observer);
    ~UnicornCore();
    UnicornCore(const UnicornCore &) = delete;
    UnicornCore &operator=(const UnicornCore &) = delete;

    /* `host`: the memory's contents; they stay the caller's. Whole pages of 4 KB. */
    void map_memory(AddressRange range, std::uint8_t *host, MemoryUse use);
    void map_registers(AddressRange range);
    /* Every instruction is watched by itself, until this is called: from then on all blocks are,
       and instructions in these ranges only, which must not overlap. While the core stands. */
    void watch_blocks(const std::vector<AddressRange> &by_instruction);
    /* Contents of memory with code have changed behind the core's back. */
    void forget_code(AddressRange range);

    std::uint32_t get(CoreRegister name) const;
    void set(CoreRegister name, std::uint32_t value);
    /* Several at once, which is quicker. */
    template <std::size_t count>
    void get(const CoreRegister (&names)[count], std::uint32_t *values) const
    {
        get(names, count, values);
    }
    template <std::size_t count>
    void set(const CoreRegister (&names)[count], const std::uint32_t *values)
    {
        set(names, count, values);
    }
    void get_floating_point(std::uint32_t s0_to_s15[16]) const;
    void set_floating_point(const std::uint32_t s0_to_s15[16]);

    Stopped run(std::uint32_t address);

  private:
    struct Window {
        UnicornCore *core;
        std::uint32_t base;
    };
    struct Callbacks;
    friend struct Callbacks;

    static constexpr std::size_t most = 16; /* registers at once */

    void check(int error, const char *what) const;
    void get(const CoreRegister *names, std::size_t count, std::uint32_t *values) const;
    void set(const CoreRegister *names, std::size_t count, const std::uint32_t *values);
    /* By libunicorn's numbers, which it does not change; each of so many words. */
    void get(int *numbers, std::size_t count, std::uint32_t *values, std::size_t words = 1) const;
    void set(int *numbers, std::size_t count, const std::uint32_t *values, std::size_t words = 1);
    void set_page_size();
    void renew_mode(std::uint32_t status);
    void stop();
    void watch_instructions(std::uint64_t first, std::uint64_t last);

    CoreObserver &observer_;
    uc_struct *engine_ = nullptr;
    std::list<Window> windows_; /* their addresses are given away */
    std::vector<std::size_t> instruction_hooks_;
    bool watches_blocks_ = false;
    std::uint32_t stopped_before_ = 0; /* this block; 0: the emulator itself knows where */
    std::exception_ptr thrown_;
    Stopped reason_ = Stopped::by_itself;
};

} // namespace virtual_board

#endif
