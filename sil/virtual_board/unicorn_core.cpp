#include "sil/virtual_board/unicorn_core.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>

#include <unicorn/unicorn.h>

namespace virtual_board
{

namespace
{

/* Numbers of libunicorn's hook for what the core itself calls exceptions. */
enum : std::uint32_t {
    core_supervisor_call = 2,
    core_prefetch_abort = 3,
    core_data_abort = 4, /* left for what is not aligned: what is not mapped ends the run itself */
    core_breakpoint = 7,
    core_exception_return = 8
};

/* Of its tables: least work of 1, 2, 4, 8 and 32 KB. Blocks end where a page does. */
constexpr std::uint32_t page_bytes = 4096;
constexpr int pairs = 8; /* of single-precision registers: S0...S15 */

int number_of(CoreRegister name)
{
    switch (name) {
    case CoreRegister::r0:
        return UC_ARM_REG_R0;
    case CoreRegister::r1:
        return UC_ARM_REG_R1;
    case CoreRegister::r2:
        return UC_ARM_REG_R2;
    case CoreRegister::r3:
        return UC_ARM_REG_R3;
    case CoreRegister::r12:
        return UC_ARM_REG_R12;
    case CoreRegister::sp:
        return UC_ARM_REG_SP; /* r13; the alias MSP has its own ideas */
    case CoreRegister::lr:
        return UC_ARM_REG_LR;
    case CoreRegister::pc:
        return UC_ARM_REG_PC;
    case CoreRegister::xpsr:
        return UC_ARM_REG_XPSR;
    case CoreRegister::control:
        return UC_ARM_REG_CONTROL;
    case CoreRegister::primask:
        return UC_ARM_REG_PRIMASK;
    case CoreRegister::base_priority:
        return UC_ARM_REG_BASEPRI;
    case CoreRegister::faultmask:
        return UC_ARM_REG_FAULTMASK;
    case CoreRegister::fpscr:
        return UC_ARM_REG_FPSCR;
    }
    throw std::logic_error("no such register");
}

} // namespace

/* Exceptions must not cross the emulator's own frames: they are kept and thrown on behind it. */
struct UnicornCore::Callbacks {
    template <typename Call> static void guarded(UnicornCore &core, Call call)
    {
        if (core.thrown_) {
            return;
        }
        try {
            call();
        } catch (...) {
            core.thrown_ = std::current_exception();
            core.stop();
        }
    }

    static void instruction(uc_engine *, std::uint64_t address, std::uint32_t bytes, void *user)
    {
        UnicornCore &core = *static_cast<UnicornCore *>(user);
        try {
            if (!core.observer_.before_instruction(static_cast<std::uint32_t>(address), bytes)) {
                core.reason_ = Stopped::by_observer;
                core.stop();
            }
        } catch (...) {
            core.thrown_ = std::current_exception();
            core.stop();
        }
    }

    static void block(uc_engine *, std::uint64_t address, std::uint32_t bytes, void *user)
    {
        UnicornCore &core = *static_cast<UnicornCore *>(user);
        try {
            if (!core.observer_.before_block(static_cast<std::uint32_t>(address), bytes)) {
                core.reason_ = Stopped::by_observer;
                core.stopped_before_ = static_cast<std::uint32_t>(address);
                core.stop();
            }
        } catch (...) {
            core.thrown_ = std::current_exception();
            core.stop();
        }
    }

    static Stopped stopped_by(std::uint32_t exception)
    {
        switch (exception) {
        case core_exception_return:
            return Stopped::exception_return;
        case core_supervisor_call:
            return Stopped::supervisor_call;
        case core_prefetch_abort:
            return Stopped::unmapped_fetch;
        case core_data_abort:
            return Stopped::unaligned;
        case core_breakpoint:
            return Stopped::breakpoint;
        default:
            return Stopped::undefined_instruction;
        }
    }

    static void interrupt(uc_engine *, std::uint32_t number, void *user)
    {
        UnicornCore &core = *static_cast<UnicornCore *>(user);
        core.stop();
        core.reason_ = stopped_by(number);
    }

    static std::uint64_t read(uc_engine *, std::uint64_t offset, unsigned bytes, void *user)
    {
        const Window &window = *static_cast<Window *>(user);
        std::uint32_t value = 0;
        guarded(*window.core, [&] {
            value = window.core->observer_.read(window.base + static_cast<std::uint32_t>(offset),
                                                bytes);
        });
        return value;
    }

    static void write(uc_engine *, std::uint64_t offset, unsigned bytes, std::uint64_t value,
                      void *user)
    {
        const Window &window = *static_cast<Window *>(user);
        guarded(*window.core, [&] {
            window.core->observer_.write(window.base + static_cast<std::uint32_t>(offset), bytes,
                                         static_cast<std::uint32_t>(value));
        });
    }
};

UnicornCore::UnicornCore(const CoreModel &model, CoreObserver &observer) : observer_(observer)
{
    /* Without UC_MODE_MCLASS, which is a Cortex-M33 whatever model is asked for. */
    check(uc_open(UC_ARCH_ARM, UC_MODE_THUMB, &engine_), "open");
    const int cpu =
        model.architecture == Architecture::armv7em ? UC_CPU_ARM_CORTEX_M4 : UC_CPU_ARM_CORTEX_M0;
    check(uc_ctl_set_cpu_model(engine_, cpu), "model of the core");
    set_page_size();
    watch_instructions(1, 0); /* everywhere */
    uc_hook hook = 0;
    check(uc_hook_add(engine_, &hook, UC_HOOK_INTR, reinterpret_cast<void *>(&Callbacks::interrupt),
                      this, 1, 0),
          "hook");
}

/* It takes twice what it is asked for. */
void UnicornCore::set_page_size()
{
    std::uint32_t taken = 0;
    check(uc_ctl_set_page_size(engine_, page_bytes / 2), "page size");
    check(uc_ctl_get_page_size(engine_, &taken), "page size");
    if (taken != page_bytes) {
        throw std::runtime_error("libunicorn: pages of " + std::to_string(taken) + " bytes, not " +
                                 std::to_string(page_bytes));
    }
}

UnicornCore::~UnicornCore()
{
    if (engine_ != nullptr) {
        uc_close(engine_);
    }
}

void UnicornCore::check(int error, const char *what) const
{
    if (error != UC_ERR_OK) {
        throw std::runtime_error(std::string("libunicorn: ") + what + ": " +
                                 uc_strerror(static_cast<uc_err>(error)));
    }
}

void UnicornCore::stop()
{
    uc_emu_stop(engine_);
}

void UnicornCore::map_memory(AddressRange range, std::uint8_t *host, MemoryUse use)
{
    const int write = use == MemoryUse::program ? 0 : UC_PROT_WRITE;
    check(uc_mem_map_ptr(engine_, range.base, range.bytes,
                         static_cast<std::uint32_t>(UC_PROT_READ | UC_PROT_EXEC | write), host),
          "memory");
}

void UnicornCore::watch_instructions(std::uint64_t first, std::uint64_t last)
{
    uc_hook hook = 0;
    check(uc_hook_add(engine_, &hook, UC_HOOK_CODE,
                      reinterpret_cast<void *>(&Callbacks::instruction), this, first, last),
          "hook");
    instruction_hooks_.push_back(hook);
}

/* A hook counts when code is translated: what is translated already is forgotten. Every range is
   looked through before every instruction that is watched by itself: few are quicker. */
void UnicornCore::watch_blocks(const std::vector<AddressRange> &by_instruction)
{
    for (const std::size_t hook : instruction_hooks_) {
        check(uc_hook_del(engine_, hook), "hook");
    }
    instruction_hooks_.clear();
    if (!watches_blocks_) {
        watches_blocks_ = true;
        uc_hook hook = 0;
        check(uc_hook_add(engine_, &hook, UC_HOOK_BLOCK,
                          reinterpret_cast<void *>(&Callbacks::block), this, 1, 0),
              "hook");
    }
    for (const AddressRange &range : by_instruction) {
        watch_instructions(range.base, std::uint64_t{range.base} + range.bytes - 1);
        forget_code(range);
    }
}

void UnicornCore::map_registers(AddressRange range)
{
    windows_.push_back({this, range.base});
    check(uc_mmio_map(engine_, range.base, range.bytes, &Callbacks::read, &windows_.back(),
                      &Callbacks::write, &windows_.back()),
          "registers");
}

void UnicornCore::forget_code(AddressRange range)
{
    check(uc_ctl_remove_cache(engine_, std::uint64_t{range.base},
                              std::uint64_t{range.base} + range.bytes),
          "cache");
}

std::uint32_t UnicornCore::get(CoreRegister name) const
{
    std::uint32_t value = 0;
    check(uc_reg_read(engine_, number_of(name), &value), "register");
    return value;
}

void UnicornCore::set(CoreRegister name, std::uint32_t value)
{
    set(&name, 1, &value);
}

/* The emulator translates code by the mode (thread, handler) that it has noted; the write of xPSR
   does not renew that note, the one of its flags does. */
void UnicornCore::renew_mode(std::uint32_t status)
{
    check(uc_reg_write(engine_, UC_ARM_REG_APSR_NZCV, &status), "flags");
}

void UnicornCore::get(const CoreRegister *names, std::size_t count, std::uint32_t *values) const
{
    int numbers[most];
    std::transform(names, names + count, numbers, number_of);
    get(numbers, count, values);
}

void UnicornCore::set(const CoreRegister *names, std::size_t count, const std::uint32_t *values)
{
    int numbers[most];
    std::transform(names, names + count, numbers, number_of);
    std::replace(numbers, numbers + count, static_cast<int>(UC_ARM_REG_XPSR),
                 static_cast<int>(UC_ARM_REG_XPSR_NZCVQG)); /* the other does not write GE */
    set(numbers, count, values);
    const CoreRegister *const status = std::find(names, names + count, CoreRegister::xpsr);
    if (status != names + count) {
        renew_mode(values[status - names]);
    }
}

/* By pairs, D0...D7, which the emulator finds quicker. */
void UnicornCore::get_floating_point(std::uint32_t s0_to_s15[most]) const
{
    int numbers[pairs];
    std::iota(numbers, numbers + pairs, static_cast<int>(UC_ARM_REG_D0));
    get(numbers, pairs, s0_to_s15, 2);
}

void UnicornCore::set_floating_point(const std::uint32_t s0_to_s15[most])
{
    int numbers[pairs];
    std::iota(numbers, numbers + pairs, static_cast<int>(UC_ARM_REG_D0));
    set(numbers, pairs, s0_to_s15, 2);
}

void UnicornCore::get(int *numbers, std::size_t count, std::uint32_t *values,
                      std::size_t words) const
{
    void *places[most];
    for (std::size_t i = 0; i < count; ++i) {
        places[i] = &values[words * i];
    }
    check(uc_reg_read_batch(engine_, numbers, places, static_cast<int>(count)), "registers");
}

void UnicornCore::set(int *numbers, std::size_t count, const std::uint32_t *values,
                      std::size_t words)
{
    void *places[most] = {}; /* only read */
    for (std::size_t i = 0; i < count; ++i) {
        places[i] = const_cast<std::uint32_t *>(&values[words * i]);
    }
    check(uc_reg_write_batch(engine_, numbers, places, static_cast<int>(count)), "registers");
}

Stopped UnicornCore::run(std::uint32_t address)
{
    reason_ = Stopped::by_itself;
    thrown_ = nullptr;
    stopped_before_ = 0;
    const uc_err error = uc_emu_start(engine_, address | 1u, 0, 0, 0);
    if (thrown_) {
        std::rethrow_exception(thrown_);
    }
    if (stopped_before_ != 0) {
        set(CoreRegister::pc, stopped_before_ | 1u);
    }
    switch (error) {
    case UC_ERR_OK:
        return reason_;
    case UC_ERR_READ_UNMAPPED:
        return Stopped::unmapped_read;
    case UC_ERR_WRITE_UNMAPPED:
        return Stopped::unmapped_write;
    case UC_ERR_FETCH_UNMAPPED:
    case UC_ERR_FETCH_PROT:
        return Stopped::unmapped_fetch;
    case UC_ERR_WRITE_PROT:
        return Stopped::read_only;
    case UC_ERR_INSN_INVALID:
    case UC_ERR_EXCEPTION:
        return Stopped::undefined_instruction;
    default:
        check(error, "run");
        return Stopped::by_itself;
    }
}

} // namespace virtual_board
