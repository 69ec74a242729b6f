/*
 * A chip that executes an image: core, memories, exceptions, time, and the peripherals of a Device.
 * Single-threaded and deterministic; time is that of the nominal cycles of what is executed.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_MACHINE_H
#define STEADYSTEP_VIRTUAL_BOARD_MACHINE_H

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "sil/virtual_board/block_costs.h"
#include "sil/virtual_board/elf_image.h"
#include "sil/virtual_board/event_queue.h"
#include "sil/virtual_board/instruction_costs.h"
#include "sil/virtual_board/interrupt_account.h"
#include "sil/virtual_board/system_control.h"
#include "sil/virtual_board/unicorn_core.h"

namespace virtual_board
{

/* The firmware has done what silicon would not forgive; text, time and place. */
class Failure : public std::runtime_error
{
  public:
    using std::runtime_error::runtime_error;
};

class Machine final : private CoreObserver, public Chip
{
  public:
    explicit Machine(const ChipDescription &description);
    ~Machine() override;

    /* Once, before power_on: the peripherals, which stay the caller's, and the image, whose bytes
       go into the device's flash. Throws std::invalid_argument if it does not fit the chip. */
    void attach(Device &device);
    void load(const ElfImage &image);
    InstructionCosts &costs()
    {
        return costs_;
    }

    /* The supply comes: memory holds garbage, the core starts at its reset vector. */
    void power_on();
    /* Until stop() is called, by an event or at the end of a control interrupt, or the chip has
       been reset; what happens next is up to the caller. */
    void run();
    void stop()
    {
        stop_wanted_ = true;
    }
    /* Between two calls of run(): halts the core, as a debugger does, for so long; all else goes
     * on.
     */
    void halt(Ticks duration);
    /* run() returns at the end of every control interrupt, if wanted. */
    bool stops_behind_control_interrupt = false;

    /* To be called at the instant that the control interrupt's latency counts from. */
    void mark_sampling()
    {
        sampled_at_ = now_;
    }
    /* Holds the core up for `cycles` at the n-th instruction of the coming control interrupt. */
    void stall_control_interrupt(std::uint32_t instruction, std::uint64_t cycles);

    std::uint64_t control_interrupts() const
    {
        return control_interrupts_;
    }
    const InterruptAccount &account() const
    {
        return account_;
    }
    /* Exception that runs, 0: thread mode. */
    unsigned running() const
    {
        return interrupts_.running();
    }
    /* Causes of all resets since power_on, the power-on not counted. */
    const std::vector<std::string> &resets() const
    {
        return resets_;
    }
    /* The first fault since power_on, with its place; "" if there was none. */
    const std::string &fault() const
    {
        return fault_;
    }
    /* Bytes of stack that have been in use; nullopt if the image does not state its limit. */
    std::optional<std::uint32_t> stack_used() const;

    /* Contents of memory, without side effects; nullptr if there is none. */
    std::uint8_t *memory(std::uint32_t address, std::uint32_t bytes);

    Ticks now() const override
    {
        return now_;
    }
    Ticks core_cycle() const override
    {
        return core_cycle_;
    }
    void set_core_cycle(Ticks ticks) override;
    void schedule(Event &event, Ticks at) override;
    void interrupt(unsigned line, bool level) override;
    void non_maskable_interrupt() override;
    std::uint32_t load(std::uint32_t address, unsigned bytes) override;
    void store(std::uint32_t address, unsigned bytes, std::uint32_t value) override;
    std::uint8_t *plain_memory(std::uint32_t address, std::uint32_t bytes) override
    {
        return description_.flash.contains(address) ? nullptr : memory(address, bytes);
    }
    void reset(const std::string &cause) override;
    [[noreturn]] void fail(const std::string &what) const override;

  private:
    struct Ram {
        MemoryRange range;
        std::vector<std::uint8_t> bytes;
    };
    static constexpr AddressRange peripherals = {0x40000000, 0x20000000};

    bool before_instruction(std::uint32_t address, unsigned bytes) override;
    bool before_block(std::uint32_t address, unsigned bytes) override;
    std::uint32_t read(std::uint32_t address, unsigned bytes) override;
    void write(std::uint32_t address, unsigned bytes, std::uint32_t value) override;

    bool may_go_on(std::uint32_t address);
    bool before_unusual_block(std::uint32_t address, unsigned bytes);
    unsigned conditional_bytes(std::uint32_t address);
    const InstructionCost &visit(std::uint32_t address, unsigned bytes);
    const BlockCost &instruction(std::uint32_t address, unsigned bytes);
    const BlockCost &visit_instruction(std::uint32_t address, unsigned bytes);
    CodePlace place_of(std::uint32_t address) const;
    bool quiet() const;
    Ticks calm_until() const;
    void begin_block(const BlockCost &block);
    const BlockCost &visit_block(std::uint32_t address, unsigned bytes);
    std::vector<TimedAccess> timed(const std::vector<RegisterAccess> &accesses,
                                   const BlockCost &block);
    unsigned time_access(std::uint32_t address);
    void watch_by_instruction(AddressRange block);
    void begin_lesson(AddressRange block);
    void end_lesson();
    void change_watch();
    /* Whether the program came here past the instruction at next_address_, in an IT block. */
    bool skipped_by_condition(std::uint32_t address)
    {
        return conditional_.contains(next_address_) && address > next_address_ &&
               address - conditional_.base <= conditional_.bytes &&
               costs_.find(next_address_)->bytes > 0;
    }
    void charge(const BlockCost &block);
    void charge_control(const BlockCost &block, bool straight, bool behind_branch);
    void add_time(const Cycles &cycles, unsigned stage);
    void add_time(const Cycles &cycles)
    {
        add_time(cycles, stage_);
    }
    void account(const Cycles &cycles, unsigned stage);
    void look_after_control();
    void serve_events();
    void finish_instruction()
    {
        now_ = now_ < instruction_end_ ? instruction_end_ : now_;
    }

    std::uint32_t bus_read(std::uint32_t address, unsigned bytes, Master master);
    void bus_write(std::uint32_t address, unsigned bytes, std::uint32_t value, Master master);
    const Mapping &mapping(std::uint32_t address, unsigned bytes, const char *what) const;
    [[noreturn]] void refuse_access(std::uint32_t address, unsigned bytes, const char *what,
                                    const char *why) const;

    Masks masks() const;
    void act_on(Stopped stopped);
    void fall_asleep();
    void sleep();
    void start();
    void begin_control();
    void enter(unsigned exception);
    void enter_handler(unsigned exception, std::uint32_t link);
    std::uint32_t push_frame();
    void pop_frame(std::uint32_t exception_return);
    void leave(std::uint32_t exception_return);
    void fault(const std::string &what, std::uint32_t status);
    void check_stack(std::uint32_t stack_pointer) const;
    void check_floating_point() const;
    void allow_floating_point();

    const ChipDescription &description_;
    ElfImage image_;
    std::vector<Ram> ram_;
    Device *device_ = nullptr;
    FlashMemory *flash_ = nullptr;
    std::vector<Mapping> mappings_;
    mutable std::array<std::size_t, 64> mapping_at_ = {}; /* found, by bits of the address */

    EventQueue events_;
    InterruptController interrupts_;
    SystemControl system_;
    InstructionCosts costs_;
    BlockCosts blocks_, instructions_; /* the latter of one instruction each */
    InterruptAccount account_;
    UnicornCore core_;
    unsigned control_exception_;

    /* time */
    Ticks now_ = 0, instruction_end_ = 0, core_cycle_ = 1;
    /* Before that, blocks only have to be charged: no event comes, nothing is wanted of the core.
       0 behind what may have changed that, an access of the core's that is not to plain memory or
       anything while it stood; the next block finds out. */
    Ticks calm_until_ = 0;
    Ticks sampled_at_ = 0;

    /* the present instruction, and what the next one has to know of it */
    std::uint32_t pc_ = 0;
    std::uint32_t next_address_ = 0; /* 0: the program does not come from an instruction */
    unsigned stage_ = 0, entry_stage_ = 0, exit_stage_ = 0;
    AddressRange conditional_ = {0, 0}; /* instructions of the last IT block */
    bool floating_point_begun_ = false;

    /* blocks that access registers in an exception, as it shows: watched by the instruction until
       it is known when in the block they do */
    const BlockCost *block_ = nullptr; /* the present one, if it is watched as a whole */
    unsigned accesses_ = 0;            /* of it, so far */
    RegisterLessons lessons_;
    std::vector<AddressRange> by_instruction_;
    AddressRange to_be_watched_ = {0, 0}, to_be_released_ = {0, 0}; /* 0 bytes: none */
    bool watch_changes_ = false;

    /* what the core is to do before the next instruction */
    unsigned to_enter_ = 0;
    bool stop_wanted_ = false, reset_wanted_ = false;
    bool asleep_ = false; /* by WFI */
    std::string reset_cause_;

    /* control interrupt: 0 not active, 1 it runs, 2 and more: others above it */
    unsigned above_control_ = 0;
    bool first_of_control_ = false;
    std::uint64_t control_interrupts_ = 0;
    std::uint32_t control_instructions_ = 0;
    std::uint32_t stall_at_ = 0;
    std::uint64_t stall_cycles_ = 0;

    std::optional<std::uint32_t> stack_limit_, stack_top_;
    std::vector<std::string> resets_;
    std::string fault_;
};

} // namespace virtual_board

#endif
