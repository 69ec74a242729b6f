/* Exception entry and return (ARMv7-M ARM, B1.5.6 to B1.5.8). */
#include "sil/virtual_board/machine.h"

#include <cstdio>
#include <cstring>

namespace virtual_board
{

namespace
{

constexpr std::uint32_t floating_point_in_use = 1u << 2; /* CONTROL.FPCA */
constexpr std::uint32_t process_stack = 1u << 1;         /* CONTROL.SPSEL */
constexpr std::uint32_t unprivileged = 1u << 0;          /* CONTROL.nPRIV */
constexpr std::uint32_t basic_words = 8, extended_words = 26;

/* The basic frame in its order, and behind it, no part of it, where it goes. */
constexpr CoreRegister frame_and_pointer[] = {
    CoreRegister::r0, CoreRegister::r1, CoreRegister::r2,   CoreRegister::r3, CoreRegister::r12,
    CoreRegister::lr, CoreRegister::pc, CoreRegister::xpsr, CoreRegister::sp};

Cycles plus(Cycles a, const Cycles &b)
{
    a += b;
    return a;
}

} // namespace

Masks Machine::masks() const
{
    if (description_.core.architecture == Architecture::armv6m) {
        return {(core_.get(CoreRegister::primask) & 1) != 0, false, 0};
    }
    std::uint32_t values[3];
    core_.get({CoreRegister::primask, CoreRegister::faultmask, CoreRegister::base_priority},
              values);
    return {(values[0] & 1) != 0, (values[1] & 1) != 0, values[2] & 0xff};
}

void Machine::check_stack(std::uint32_t stack_pointer) const
{
    if (stack_limit_ && stack_pointer < *stack_limit_) {
        char text[96];
        std::snprintf(text, sizeof text, "stack overflow: 0x%08x is below the limit 0x%08x",
                      static_cast<unsigned>(stack_pointer), static_cast<unsigned>(*stack_limit_));
        fail(text);
    }
}

/* The emulator's FPU is always on; the core's traps until CPACR allows it. */
void Machine::check_floating_point() const
{
    if (!system_.floating_point_allowed()) {
        fail("a floating-point instruction was executed while CPACR forbids it");
    }
}

/*
 * From the moment that the FPU is allowed on, CONTROL.FPCA is set, but for handlers that have done
 * nothing of floating point: the emulator begins a new floating-point context, FPSCR included, by a
 * flag that it keeps with the code it has translated, and behind a conditional instruction that
 * flag is not always right. So every exception from then on stacks the long frame; silicon spares
 * that where nothing of floating point was done before.
 */
void Machine::allow_floating_point()
{
    if (!description_.core.floating_point || !system_.floating_point_allowed()) {
        return;
    }
    const std::uint32_t control = core_.get(CoreRegister::control);
    if (!floating_point_begun_ && (control & floating_point_in_use) != 0) {
        fail("a floating-point instruction was executed before CPACR allowed it");
    }
    floating_point_begun_ = true;
    core_.set(CoreRegister::control, control | floating_point_in_use);
}

/* Returns the EXC_RETURN for what was running. */
std::uint32_t Machine::push_frame()
{
    const std::uint32_t control = core_.get(CoreRegister::control);
    if ((control & process_stack) != 0) {
        fail("the process stack (CONTROL.SPSEL) is not modelled");
    }
    if ((control & unprivileged) != 0) {
        fail("unprivileged code (CONTROL.nPRIV) is not modelled");
    }
    if ((control & floating_point_in_use) != 0) {
        check_floating_point();
    }
    const bool extended = system_.floating_point_allowed() && system_.keeps_floating_point();
    std::uint32_t frame[extended_words] = {};
    core_.get(frame_and_pointer, frame);
    const std::uint32_t before = frame[basic_words];
    const std::uint32_t padding = before & 4;
    const std::uint32_t status = frame[7];
    frame[6] &= ~1u;
    frame[7] = (status & 0xf80f0000) | 1u << 24 | interrupts_.running() | padding << 7;
    if (extended) {
        core_.get_floating_point(&frame[8]);
        frame[24] = core_.get(CoreRegister::fpscr);
    }
    const std::uint32_t words = extended ? extended_words : basic_words;
    const std::uint32_t after = before - padding - 4 * words;
    check_stack(after);
    std::uint8_t *const place = memory(after, 4 * words);
    if (place == nullptr || description_.flash.contains(after)) {
        fail("an exception is stacked where there is no memory");
    }
    std::memcpy(place, frame, 4 * words);
    core_.set(CoreRegister::sp, after);
    const std::uint32_t mode = interrupts_.running() != 0 ? 0xfffffff1 : 0xfffffff9;
    return extended ? mode & ~0x10u : mode;
}

void Machine::begin_control()
{
    if (system_.floating_point_allowed() && !system_.keeps_floating_point()) {
        fail("FPCCR.ASPEN is 0: the control interrupt would change S0...S15 under the program");
    }
    above_control_ = 1;
    first_of_control_ = true;
    control_instructions_ = 0;
    stage_ = entry_stage_;
    account_.begin();
}

void Machine::enter(unsigned exception)
{
    const std::uint32_t link = push_frame();
    const bool extended = (link & 0x10) == 0;
    const CostRules &rules = costs_.rules;
    const Cycles cycles = extended ? plus(rules.enter, rules.floating_point_frame) : rules.enter;
    if (exception == control_exception_) {
        begin_control();
    } else if (above_control_ > 0) {
        if (above_control_++ == 1) {
            account_.count_preemption();
        }
    }
    instruction_end_ = now_;
    add_time(cycles);
    enter_handler(exception, link);
}

void Machine::enter_handler(unsigned exception, std::uint32_t link)
{
    interrupts_.enter(exception);
    if (description_.core.floating_point) {
        core_.set(CoreRegister::control, core_.get(CoreRegister::control) & ~floating_point_in_use);
    }
    const std::uint32_t vector = load(system_.vector_table() + 4 * exception, 4);
    if ((vector & 1) == 0) {
        fail("the vector of exception " + std::to_string(exception) + " has no Thumb bit");
    }
    const std::uint32_t status = core_.get(CoreRegister::xpsr);
    const std::uint32_t values[] = {(status & 0xf80f0000) | 1u << 24 | exception, link, vector};
    core_.set({CoreRegister::xpsr, CoreRegister::lr, CoreRegister::pc}, values);
    next_address_ = 0;
    conditional_ = {0, 0};
}

void Machine::pop_frame(std::uint32_t exception_return)
{
    const bool extended = (exception_return & 0x10) == 0;
    const std::uint32_t words = extended ? extended_words : basic_words;
    const std::uint32_t before = core_.get(CoreRegister::sp);
    const std::uint8_t *const place = memory(before, 4 * words);
    if (place == nullptr || before % 4 != 0) {
        fail("return from an exception with a stack pointer that points nowhere");
    }
    std::uint32_t frame[extended_words];
    std::memcpy(frame, place, 4 * words);
    if (extended) {
        core_.set_floating_point(&frame[8]);
        core_.set(CoreRegister::fpscr, frame[24]);
        core_.set(CoreRegister::control, core_.get(CoreRegister::control) | floating_point_in_use);
    }
    const std::uint32_t padding = (frame[7] >> 9 & 1) != 0 ? 4 : 0;
    const std::uint32_t back[] = {frame[0],
                                  frame[1],
                                  frame[2],
                                  frame[3],
                                  frame[4],
                                  frame[5],
                                  frame[6] | 1,
                                  frame[7] & ~(1u << 9),
                                  before + 4 * words + padding};
    core_.set(frame_and_pointer, back);
    if ((frame[7] & 0x1ff) != interrupts_.running()) {
        fail("return from an exception to another mode than it came from: the stack is spoilt");
    }
    pc_ = frame[6];
}

void Machine::leave(std::uint32_t exception_return)
{
    const unsigned left = interrupts_.running();
    if (left == 0) {
        fail("return from an exception while none is active");
    }
    const std::uint32_t kind = exception_return | 0x10;
    const bool to_handler = interrupts_.active_count() > 1;
    if (kind != (to_handler ? 0xfffffff1 : 0xfffffff9)) {
        fail("return from an exception by a value that is not the one it was entered with");
    }
    if (left != exception::nmi && description_.core.architecture == Architecture::armv7em) {
        core_.set(CoreRegister::faultmask, 0);
    }
    const bool was_control = above_control_ == 1;
    if (was_control) {
        stage_ = exit_stage_;
    }
    interrupts_.leave();
    const unsigned next = interrupts_.to_enter(masks());
    const CostRules &rules = costs_.rules;
    const bool extended = (exception_return & 0x10) == 0;
    instruction_end_ = now_;
    if (next == 0) {
        add_time(extended ? plus(rules.leave, rules.floating_point_frame) : rules.leave);
    }
    if (was_control) {
        account_.end();
        ++control_interrupts_;
        stop_wanted_ = stop_wanted_ || stops_behind_control_interrupt;
    }
    if (above_control_ > 0) {
        --above_control_;
    }
    if (next != 0) { /* tail-chaining: the frame stays, another handler is entered */
        if (next == control_exception_) {
            begin_control();
        } else if (above_control_ > 0) {
            ++above_control_;
        }
        add_time(in_every_column(description_.core.tail_chain_cycles));
        enter_handler(next, exception_return);
    } else {
        pop_frame(exception_return);
        check_stack(core_.get(CoreRegister::sp));
        next_address_ = 0;
        conditional_ = {0, 0};
        if (system_.sleeps_on_exit() && interrupts_.running() == 0) {
            fail("SCR.SLEEPONEXIT is not modelled");
        }
    }
}

/* `status`: bits of CFSR, by which the fault is a bus or a usage fault. One whose own exception
   cannot be taken becomes a HardFault. */
void Machine::fault(const std::string &what, std::uint32_t status)
{
    try {
        fail("fault: " + what + " (LR " + image_.place(core_.get(CoreRegister::lr) & ~1u) + ")");
    } catch (const Failure &failure) {
        if (fault_.empty()) {
            fault_ = failure.what();
        }
        if (!interrupts_.hard_fault_possible(masks())) {
            throw Failure(std::string("lockup by a ") + failure.what());
        }
    }
    const bool fetch = (status & fault_bus_fetch) != 0; /* it is reported where the jump is */
    core_.set(CoreRegister::pc, (fetch ? core_.get(CoreRegister::pc) : pc_) | 1);
    const unsigned own = (status & 0xffff0000) != 0 ? exception::usage_fault : exception::bus_fault;
    unsigned taken = exception::hard_fault;
    if (interrupts_.enabled(own) && status != 0) {
        interrupts_.set_pending(own);
        taken = interrupts_.to_enter(masks()) == own ? own : taken;
    }
    if (taken != own) {
        interrupts_.clear_pending(own);
        interrupts_.set_pending(taken);
    }
    system_.record_fault(status, taken != own);
    enter(taken);
}

} // namespace virtual_board
