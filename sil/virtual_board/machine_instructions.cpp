/* What happens before every instruction: time, costs, events, and whether an exception comes. */
#include "sil/virtual_board/machine.h"

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
inline void Machine::account(const Cycles &cycles)
{
    if (above_control_ == 1) {
        account_.add(stage_, cycles);
    } else if (above_control_ > 1) {
        account_.add_preempting(cycles);
    }
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
    const std::uint8_t *const code = memory(address, 2);
    if (code != nullptr && bytes == 2) {
        const unsigned halfword = code[0] | static_cast<unsigned>(code[1]) << 8;
        cost->conditional = static_cast<std::uint8_t>(conditional_block(halfword));
    }
    cost->visited = 1;
    return *cost;
}

/* This and what it calls run before every instruction: nearly all of the simulation's time. */
inline void Machine::charge(std::uint32_t address, unsigned bytes)
{
    const CostRules &rules = costs_.rules;
    const InstructionCost *known = costs_.find(address);
    const InstructionCost &cost =
        known != nullptr && known->visited != 0 ? *known : visit(address, bytes);
    const bool straight = address == next_address_;
    if (!straight && next_address_ != 0) {
        account(rules.refill); /* belongs to the branch */
        now_ += rules.refill.nominal * core_cycle_;
    }
    next_address_ = address + bytes;
    conditional_left_ = conditional_left_ > 0 ? conditional_left_ - 1 : cost.conditional;
    const unsigned nominal = straight ? cost.nominal_after : cost.nominal;
    instruction_end_ = now_ + nominal * core_cycle_;
    if (above_control_ == 0) {
        return;
    }
    if (cost.stage != inherited_stage) {
        stage_ = cost.stage;
    }
    const std::uint32_t first_line = address >> rules.flash_line_shift;
    const std::uint32_t last_line = (address + bytes - 1) >> rules.flash_line_shift;
    const bool new_line = !straight || first_line != flash_line_;
    const unsigned waits =
        (new_line ? 1u : 0u) + (last_line != first_line ? 1u : 0u) + cost.literals;
    flash_line_ = last_line;
    Cycles cycles;
    cycles.nominal = nominal;
    cycles.worst = straight ? cost.worst_after : cost.worst;
    cycles.flash = cycles.worst + waits * rules.flash_wait;
    if (description_.fast_code.bytes > 0 && description_.flash.contains(address)) {
        cycles.worst = cycles.flash; /* this one does run from flash */
    }
    account(cycles);
}

bool Machine::before_instruction(std::uint32_t address, unsigned bytes)
{
    finish_instruction();
    if (now_ >= events_.next()) {
        serve_events();
    }
    to_enter_ = 0;
    /* Never inside an IT block: the emulator does not know there what it would have to go on with.
     */
    if (conditional_left_ == 0) {
        if (stop_wanted_ || reset_wanted_) {
            return false;
        }
        if (interrupts_.may_preempt()) {
            to_enter_ = interrupts_.to_enter(masks());
            if (to_enter_ != 0) {
                return false;
            }
        }
    }
    pc_ = address;
    charge(address, bytes);
    if (above_control_ == 1) {
        inject(address);
    }
    return true;
}

void Machine::add_time(const Cycles &cycles)
{
    account(cycles);
    instruction_end_ += cycles.nominal * core_cycle_;
}

/* In the control interrupt: its first instruction, code out of place, and what a test injects. */
void Machine::inject(std::uint32_t address)
{
    if (first_of_control_) {
        first_of_control_ = false;
        account_.latency((now_ - sampled_at_) / core_cycle_);
    }
    if (description_.fast_code.bytes > 0 && !description_.fast_code.contains(address)) {
        account_.count_outside_fast_code();
    }
    if (stall_cycles_ > 0 && control_instructions_++ == stall_at_) {
        const Cycles stall = {stall_cycles_, stall_cycles_, stall_cycles_};
        stall_cycles_ = 0;
        add_time(stall);
    }
}

} // namespace virtual_board
