/* What happens before every instruction: time, costs, events, and whether an exception comes. */
#include "sil/virtual_board/machine.h"

#include <algorithm>

namespace virtual_board
{

void Machine::serve_events()
{
    const Ticks present = now_;
    while (events_.next() <= present) {
        now_ = events_.next();
        events_.take().happen();
    }
    now_ = present;
}

/* Cycles of the present instruction or exception, on the control interrupt's bill if it is its. */
inline void Machine::account(const Cycles &cycles, unsigned stage)
{
    if (above_control_ == 1) {
        account_.add(stage, cycles);
    } else if (above_control_ > 1) {
        account_.add_preempting(cycles.nominal);
    }
}

/* Bytes of the IT block that the instruction at this address opens; 0: it is no IT. */
unsigned Machine::conditional_bytes(std::uint32_t address)
{
    std::uint32_t next = address;
    unsigned left = 1;
    for (bool first = true; left > 0; first = false, --left) {
        const std::uint8_t *const code = memory(next, 2);
        if (code == nullptr) {
            break;
        }
        const unsigned halfword = code[0] | static_cast<unsigned>(code[1]) << 8;
        left += first ? conditional_block(halfword) : 0;
        next += halfword >= 0xe800 ? 4 : 2;
    }
    return next - address - 2;
}

/* A first visit: what is known of the instruction, and whether it is what the map says. */
const InstructionCost &Machine::visit(std::uint32_t address, unsigned bytes)
{
    InstructionCost *const cost = costs_.find(address);
    if (cost == nullptr) {
        fail("code outside of the memories of the chip");
    }
    if (cost->bytes == 0) {
        if (!costs_.stand_in) {
            fail("an instruction that the image's map does not name");
        }
        *cost = stand_in_cost(address, bytes);
    } else if (cost->bytes != bytes) {
        fail("an instruction of another size than the image's map says");
    }
    if (bytes == 2) {
        cost->conditional = static_cast<std::uint8_t>(conditional_bytes(address));
    }
    return *cost;
}

/* What instructions that are executed behind one another cost. This and what it calls run before
   every block and every instruction that is watched by itself: much of the simulation's time. */
inline void Machine::charge(const BlockCost &block)
{
    const bool straight = block.address == next_address_;
    const bool behind_branch = !straight && next_address_ != 0;
    next_address_ = block.address + block.bytes;
    if (block.conditional_bytes > 0) {
        conditional_ = {block.address + block.conditional_from, block.conditional_bytes};
    }
    if (above_control_ == 1) {
        charge_control(block, straight, behind_branch);
    }
    const unsigned refill = behind_branch ? costs_.rules.refill.nominal : 0;
    const unsigned nominal = straight ? block.nominal_after : block.nominal;
    now_ += refill * core_cycle_;
    instruction_end_ = now_ + nominal * core_cycle_;
    if (above_control_ > 1) {
        account_.add_preempting(refill + nominal);
    }
}

inline void Machine::charge_control(const BlockCost &block, bool straight, bool behind_branch)
{
    if (behind_branch) {
        account_.add(stage_, costs_.rules.refill); /* belongs to the branch */
    }
    stage_ = block.stage != inherited_stage ? block.stage : stage_;
    account_.add(stage_, straight ? block.head_after : block.head);
    if (block.parts > 0) {
        const BlockPart *const parts = blocks_.parts(block);
        for (unsigned i = 0; i < block.parts; ++i) {
            stage_ = parts[i].stage; /* known, or it would be the part's before */
            account_.add(stage_, parts[i].cycles);
        }
    }
    control_instructions_ += block.instructions;
    if (block.place == CodePlace::flash_by_intent) {
        account_.excuse_place();
    } else if (block.place != CodePlace::as_wanted) {
        account_.count_outside_fast_code();
    }
}

/* In the control interrupt: its first instruction, and what a test injects. */
void Machine::look_after_control()
{
    if (above_control_ != 1) {
        return;
    }
    if (first_of_control_) {
        first_of_control_ = false;
        account_.latency((now_ - sampled_at_) / core_cycle_);
    }
    if (stall_cycles_ > 0 && control_instructions_ > stall_at_) {
        const Cycles stall = in_every_column(stall_cycles_);
        stall_cycles_ = 0;
        add_time(stall);
    }
}

inline void Machine::begin_block(const BlockCost &block)
{
    block_ = &block;
    accesses_ = 0;
    pc_ = block.address;
    charge(block);
}

/* Whether nothing comes before the next instruction: no event, and nothing wanted of the core. */
inline bool Machine::quiet() const
{
    return now_ < events_.next() && !stop_wanted_ && !reset_wanted_ && !watch_changes_ &&
           !interrupts_.may_preempt();
}

/* Until when blocks need no more than to be charged, unless something is wanted before. */
inline Ticks Machine::calm_until() const
{
    const bool calm = quiet() && !lessons_.running() && !first_of_control_ && stall_cycles_ == 0;
    return calm ? events_.next() : 0;
}

/* The events that are due; and whether the instruction at this address is the next, all the same.
 */
bool Machine::may_go_on(std::uint32_t address)
{
    serve_events();
    to_enter_ = 0;
    /* Never inside an IT block: the emulator stops behind it only, with its time not charged. */
    if (conditional_.contains(address)) {
        return true;
    }
    if (stop_wanted_ || reset_wanted_ || watch_changes_) {
        return false;
    }
    if (interrupts_.may_preempt()) {
        to_enter_ = interrupts_.to_enter(masks());
    }
    return to_enter_ == 0;
}

bool Machine::before_instruction(std::uint32_t address, unsigned bytes)
{
    block_ = nullptr;
    finish_instruction();
    if (!quiet() && !may_go_on(address)) {
        return false;
    }
    while (skipped_by_condition(address)) { /* costs what it costs when it is executed */
        charge(instruction(next_address_, costs_.find(next_address_)->bytes));
        finish_instruction();
    }
    pc_ = address;
    charge(instruction(address, bytes));
    look_after_control();
    return true;
}

void Machine::add_time(const Cycles &cycles, unsigned stage)
{
    account(cycles, stage);
    instruction_end_ += cycles.nominal * core_cycle_;
}

/* The usual case by itself, short: it comes 130 times a period. */
bool Machine::before_block(std::uint32_t address, unsigned bytes)
{
    finish_instruction();
    const BlockCost *const block = blocks_.find(address, bytes);
    if (block == nullptr || block->by_instruction || now_ >= calm_until_) {
        return before_unusual_block(address, bytes);
    }
    begin_block(*block);
    return true;
}

bool Machine::before_unusual_block(std::uint32_t address, unsigned bytes)
{
    block_ = nullptr;
    calm_until_ = 0;
    end_lesson();
    const BlockCost *block = blocks_.find(address, bytes);
    if (block == nullptr) {
        block = &visit_block(address, bytes);
    }
    if (block->by_instruction) {
        begin_lesson({address, bytes});
        return true;
    }
    if (!quiet() && !may_go_on(address)) {
        return false;
    }
    begin_block(*block);
    look_after_control();
    calm_until_ = calm_until();
    return true;
}

/* One that is watched by itself. */
inline const BlockCost &Machine::instruction(std::uint32_t address, unsigned bytes)
{
    const BlockCost *const known = instructions_.find(address, bytes);
    return known != nullptr ? *known : visit_instruction(address, bytes);
}

const BlockCost &Machine::visit_instruction(std::uint32_t address, unsigned bytes)
{
    return instructions_.set(
        instructions_.sum(address, {visit(address, bytes)}, costs_.rules, place_of(address)));
}

/* Where code lies, as far as its cost goes. */
CodePlace Machine::place_of(std::uint32_t address) const
{
    const AddressRange &fast = description_.fast_code;
    if (fast.bytes == 0 || fast.contains(address)) {
        return CodePlace::as_wanted;
    }
    const std::vector<std::uint32_t> &enabling = costs_.enabling;
    if (std::find(enabling.begin(), enabling.end(), address) != enabling.end()) {
        return CodePlace::flash_by_intent;
    }
    return description_.flash.contains(address) ? CodePlace::flash : CodePlace::elsewhere;
}

} // namespace virtual_board
