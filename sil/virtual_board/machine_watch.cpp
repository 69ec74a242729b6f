/* Whether code is watched by the block or by the instruction, and when a block accesses registers.
 */
#include "sil/virtual_board/machine.h"

#include <algorithm>

namespace virtual_board
{

/* What runs in the block at this address, whose instructions the map names. */
const BlockCost &Machine::visit_block(std::uint32_t address, unsigned bytes)
{
    std::vector<InstructionCost> instructions;
    std::uint32_t next = address;
    while (next < address + bytes) {
        const InstructionCost *const known = costs_.find(next);
        instructions.push_back(visit(next, known == nullptr ? 0 : known->bytes));
        next += instructions.back().bytes;
    }
    if (next != address + bytes) {
        fail("an instruction of another size than the image's map says");
    }
    BlockCost block = blocks_.sum(address, instructions, costs_.rules, place_of(address));
    for (const AddressRange &range : by_instruction_) {
        const bool begins = range.contains(address), ends = range.contains(next - 1);
        if (begins && ends) {
            block.by_instruction = true;
        } else if (begins || ends || range.base - address < bytes) {
            watch_by_instruction({address, bytes}); /* one of both, all of it */
        }
    }
    if (const auto *const accesses = lessons_.known({address, bytes})) {
        blocks_.set_accesses(block, timed(*accesses, block));
    }
    return blocks_.set(block);
}

/* When in the block these accesses come. */
std::vector<TimedAccess> Machine::timed(const std::vector<RegisterAccess> &accesses,
                                        const BlockCost &block)
{
    std::vector<TimedAccess> all;
    std::uint32_t at = block.address, left = block.nominal_after;
    std::uint8_t stage = block.stage;
    for (const RegisterAccess &access : accesses) {
        while (at < access.instruction) {
            left -= costs_.find(at)->nominal_after;
            at += costs_.find(at)->bytes;
            const std::uint8_t own = costs_.find(at)->stage;
            stage = own != inherited_stage ? own : stage;
        }
        all.push_back({access, left, stage});
    }
    return all;
}

/* The core is about to access a register: now is the time of its instruction, as far as that is
   known. Returns the stage that it belongs to. */
unsigned Machine::time_access(std::uint32_t address)
{
    if (block_ == nullptr) {
        lessons_.note({pc_, address});
        return stage_;
    }
    const BlockCost &block = *block_;
    if (accesses_ < block.accesses) {
        const TimedAccess &next = blocks_.accesses(block)[accesses_++];
        if (next.access.address == address) {
            pc_ = next.access.instruction;
            if (pc_ != block.address) {
                now_ = std::max(now_, instruction_end_ - next.left * core_cycle_);
                if (now_ >= events_.next()) {
                    serve_events();
                }
            }
            return next.stage != inherited_stage ? next.stage : stage_;
        }
    }
    if (interrupts_.running() != 0) {
        if (lessons_.known({block.address, block.bytes}) != nullptr) {
            lessons_.refute(block.address);
        }
        watch_by_instruction({block.address, block.bytes});
    }
    return stage_;
}

/* From now on, what it does comes at its own time. */
void Machine::watch_by_instruction(AddressRange block)
{
    to_be_watched_ = block;
    watch_changes_ = true;
}

void Machine::end_lesson()
{
    if (lessons_.running()) {
        to_be_released_ = lessons_.finish();
        watch_changes_ = true;
    }
}

void Machine::begin_lesson(AddressRange block)
{
    for (const AddressRange &range : by_instruction_) {
        if (range.base == block.base && range.bytes == block.bytes &&
            !lessons_.refuted(block.base)) {
            lessons_.begin(block);
        }
    }
}

/* While the core stands. */
void Machine::change_watch()
{
    watch_changes_ = false;
    AddressRange watched = to_be_watched_;
    const AddressRange released = to_be_released_;
    to_be_watched_ = to_be_released_ = {0, 0};
    std::vector<AddressRange> apart;
    for (const AddressRange &range : by_instruction_) {
        const std::uint32_t end = range.base + range.bytes,
                            watched_end = watched.base + watched.bytes;
        if (range.base == released.base && range.bytes == released.bytes) {
            core_.forget_code(range);
        } else if (watched.bytes == 0 || range.base >= watched_end || watched.base >= end) {
            apart.push_back(range);
        } else { /* they overlap: they become one */
            watched.base = std::min(range.base, watched.base);
            watched.bytes = std::max(end, watched_end) - watched.base;
        }
    }
    if (watched.bytes > 0) {
        apart.push_back(watched);
    }
    by_instruction_ = apart;
    blocks_.forget();
    core_.watch_blocks(by_instruction_);
}

} // namespace virtual_board
