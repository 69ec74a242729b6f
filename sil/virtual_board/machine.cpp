#include "sil/virtual_board/machine.h"

#include <algorithm>
#include <cstdio>

namespace virtual_board
{

namespace
{

/* What memory holds at power-on, and a stack that has never been used. */
constexpr std::uint8_t garbage = 0xa7;

unsigned stage_named(const std::vector<std::string> &names, const char *name)
{
    const auto found = std::find(names.begin(), names.end(), name);
    const auto last = static_cast<std::ptrdiff_t>(names.size()) - 1;
    return static_cast<unsigned>(found == names.end() ? last : found - names.begin());
}

} // namespace

Machine::Machine(const ChipDescription &description)
    : description_(description), interrupts_(description.core),
      system_(*this, description, interrupts_), costs_(description), core_(description.core, *this),
      control_exception_(exception::first_interrupt + description.control_line)
{
    for (const MemoryRange &range : description.ram) {
        ram_.push_back({range, std::vector<std::uint8_t>(range.bytes, garbage)});
    }
    for (Ram &ram : ram_) {
        for (const std::uint32_t base : {ram.range.base, ram.range.alias}) {
            if (base != 0) {
                core_.map_memory({base, ram.range.bytes}, ram.bytes.data(), MemoryUse::both);
            }
        }
    }
    core_.map_registers(peripherals);
    core_.map_registers({SystemControl::base, SystemControl::bytes});
    core_.map_registers(description.data_flash);
}

Machine::~Machine() = default;

void Machine::attach(Device &device)
{
    device_ = &device;
    flash_ = &device.flash();
    mappings_ = device.mappings();
    const AddressRange all = description_.flash, data = description_.data_flash;
    if (flash_->memory().size() != all.bytes) {
        throw std::logic_error("the device's flash is not the chip's");
    }
    core_.map_memory({all.base, all.bytes - data.bytes}, flash_->memory().data(),
                     MemoryUse::program);
}

void Machine::load(const ElfImage &image)
{
    image_ = image;
    for (const Segment &segment : image.segments()) {
        const std::uint32_t offset = segment.address - description_.flash.base;
        if (offset > description_.flash.bytes ||
            segment.bytes.size() > description_.flash.bytes - offset) {
            throw std::invalid_argument("the image has a segment outside of the flash of " +
                                        std::string(description_.name));
        }
        std::copy(segment.bytes.begin(), segment.bytes.end(),
                  flash_->memory().begin() + static_cast<std::ptrdiff_t>(offset));
    }
    stack_limit_ = image.symbol("stack_bottom");
    stack_top_ = image.symbol("stack_top");
    account_.set_stages(costs_.stages);
    entry_stage_ = stage_named(costs_.stages, "sampling");
    exit_stage_ = stage_named(costs_.stages, "outputs");
    if (!costs_.stand_in) { /* without a map nothing is known of what a block consists of */
        core_.watch_blocks({});
    }
}

void Machine::power_on()
{
    for (Ram &ram : ram_) {
        std::fill(ram.bytes.begin(), ram.bytes.end(), garbage);
        core_.forget_code({ram.range.base, ram.range.bytes});
    }
    resets_.clear();
    fault_.clear();
    reset_cause_ = "power-on";
    start();
}

/* The core leaves reset. */
void Machine::start()
{
    reset_wanted_ = asleep_ = false;
    core_cycle_ = description_.waking_core_cycle;
    system_.reset();
    device_->reset(reset_cause_);
    core_.set(CoreRegister::xpsr, 1u << 24 | exception::hard_fault); /* may write the others */
    for (const CoreRegister name :
         {CoreRegister::control, CoreRegister::primask, CoreRegister::faultmask,
          CoreRegister::base_priority, CoreRegister::fpscr}) {
        if (name != CoreRegister::fpscr || description_.core.floating_point) {
            core_.set(name, 0);
        }
    }
    core_.set(CoreRegister::xpsr, 1u << 24);
    core_.set(CoreRegister::lr, 0xffffffff);
    core_.set(CoreRegister::sp, load(system_.vector_table(), 4));
    const std::uint32_t entry = load(system_.vector_table() + 4, 4);
    if ((entry & 1) == 0) {
        fail("the reset vector has no Thumb bit: there is no program in the flash");
    }
    core_.set(CoreRegister::pc, entry);
    pc_ = entry & ~1u;
    instruction_end_ = now_;
    next_address_ = 0;
    conditional_ = {0, 0};
    to_enter_ = 0;
    above_control_ = 0;
    floating_point_begun_ = false;
}

void Machine::set_core_cycle(Ticks ticks)
{
    if (ticks != core_cycle_) {
        system_.clock_changes();
        core_cycle_ = ticks;
    }
}

void Machine::schedule(Event &event, Ticks at)
{
    if (at < now_) {
        fail("an event is scheduled for the past");
    }
    events_.schedule(event, at);
}

void Machine::interrupt(unsigned line, bool level)
{
    interrupts_.set_line(line, level);
}

void Machine::non_maskable_interrupt()
{
    interrupts_.set_pending(exception::nmi);
}

void Machine::reset(const std::string &cause)
{
    reset_wanted_ = true;
    reset_cause_ = cause;
}

void Machine::fail(const std::string &what) const
{
    char time[32];
    std::snprintf(time, sizeof time, "%.7f s", static_cast<double>(now_) / ticks_per_s);
    throw Failure(what + ", at " + image_.place(pc_) + ", " + time + " after power-on");
}

std::uint8_t *Machine::memory(std::uint32_t address, std::uint32_t bytes)
{
    const auto inside = [&](std::uint32_t base, std::uint32_t size) {
        return address - base < size && bytes <= size - (address - base);
    };
    Ram &last = ram_.back();
    if (inside(last.range.base, last.range.bytes)) { /* data: asked for by far the most */
        return &last.bytes[address - last.range.base];
    }
    for (Ram &ram : ram_) {
        if (inside(ram.range.base, ram.range.bytes)) {
            return &ram.bytes[address - ram.range.base];
        }
        if (ram.range.alias != 0 && inside(ram.range.alias, ram.range.bytes)) {
            return &ram.bytes[address - ram.range.alias];
        }
    }
    const AddressRange &flash = description_.flash;
    return inside(flash.base, flash.bytes) ? &flash_->memory()[address - flash.base] : nullptr;
}

std::optional<std::uint32_t> Machine::stack_used() const
{
    if (!stack_limit_ || !stack_top_) {
        return std::nullopt;
    }
    /* Painted by the power-on model or by the firmware's start: the lowest word says with what. */
    Machine &self = const_cast<Machine &>(*this);
    const std::uint8_t *const bottom = self.memory(*stack_limit_, *stack_top_ - *stack_limit_);
    if (bottom == nullptr) {
        return std::nullopt;
    }
    std::uint32_t unused = *stack_limit_;
    while (unused < *stack_top_ &&
           std::equal(bottom, bottom + 4, &bottom[unused - *stack_limit_])) {
        unused += 4;
    }
    return *stack_top_ - unused;
}

void Machine::stall_control_interrupt(std::uint32_t instruction, std::uint64_t cycles)
{
    stall_at_ = instruction;
    stall_cycles_ = cycles;
}

void Machine::run()
{
    stop_wanted_ = false;
    while (!stop_wanted_) {
        if (reset_wanted_) {
            resets_.push_back(reset_cause_);
            start();
            return;
        }
        if (watch_changes_) {
            change_watch();
        }
        lessons_.abandon(); /* whatever has stopped the core */
        calm_until_ = 0;
        if (asleep_) {
            sleep();
        } else {
            act_on(core_.run(core_.get(CoreRegister::pc)));
        }
    }
}

void Machine::act_on(Stopped stopped)
{
    finish_instruction();
    switch (stopped) {
    case Stopped::by_observer:
        if (to_enter_ != 0 && !reset_wanted_) {
            enter(to_enter_);
        }
        return;
    case Stopped::by_itself:
        end_lesson();
        fall_asleep();
        return;
    case Stopped::exception_return:
        end_lesson(); /* the handler's last block */
        leave(core_.get(CoreRegister::pc) | 1);
        return;
    case Stopped::supervisor_call:
        interrupts_.set_pending(exception::supervisor_call);
        if (interrupts_.to_enter(masks()) != exception::supervisor_call) {
            fault("SVC at a priority at which it cannot be taken", 0);
        }
        return;
    case Stopped::breakpoint:
        fail("BKPT without a debugger");
    case Stopped::unmapped_read:
    case Stopped::unmapped_write:
        fault("access to an address where there is nothing",
              fault_bus_precise | fault_bus_address_valid);
        return;
    case Stopped::unmapped_fetch:
        fault("jump to an address where there is nothing", fault_bus_fetch);
        return;
    case Stopped::read_only:
        fault("write into the flash that the program runs from", fault_bus_precise);
        return;
    case Stopped::unaligned:
        fault("unaligned access", fault_unaligned);
        return;
    case Stopped::undefined_instruction:
        fault("undefined instruction", fault_undefined_instruction);
        return;
    }
}

void Machine::halt(Ticks duration)
{
    const Ticks end = now_ + duration;
    while (events_.next() <= end) {
        now_ = std::max(now_, events_.next());
        serve_events();
    }
    now_ = instruction_end_ = end;
}

/* The core has stopped by itself, which is WFI. */
void Machine::fall_asleep()
{
    pc_ = next_address_ - 2; /* of a block the last instruction */
    const std::uint8_t *const code = memory(pc_, 2);
    if (code == nullptr || code[0] != 0x30 || code[1] != 0xbf) {
        fail("the core has stopped without WFI");
    }
    if (system_.deep_sleep()) {
        fail("WFI with SCR.SLEEPDEEP, which is not modelled");
    }
    next_address_ = 0;
    asleep_ = true;
    sleep();
}

/* Time jumps from event to event until something wakes the core, or whoever runs it wants it to
   stop: then it sleeps on when it is run again. */
void Machine::sleep()
{
    const Masks present = masks();
    while (!interrupts_.wakes(present) && !stop_wanted_ && !reset_wanted_) {
        if (events_.next() == Event::never) {
            fail("WFI, and nothing will ever happen");
        }
        now_ = std::max(now_, events_.next());
        serve_events();
    }
    instruction_end_ = now_;
    asleep_ = !interrupts_.wakes(present);
    if (!asleep_ && !reset_wanted_ && interrupts_.to_enter(present) != 0) {
        enter(interrupts_.to_enter(present));
    }
}

} // namespace virtual_board
