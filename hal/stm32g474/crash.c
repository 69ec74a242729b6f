#include "hal/stm32g474/crash.h"

#include <stdbool.h>

#include "firmware/design/text.h"
#include "hal/stm32g474/control_interrupt.h"
#include "hal/stm32g474/core.h"
#include "hal/stm32g474/linker.h"
#include "hal/stm32g474/pwm.h"
#include "hal/stm32g474/wait.h"

enum {
    RECORD_VALID = 0x57ec0de5,
    STARTS_IN_A_ROW = 3, /* that may fail before the board stays off */
    FRAME_WORDS = 8,     /* r0...r3, r12, lr, pc, xpsr */
};

/* What raised a non-maskable interrupt. */
enum nmi_cause { NMI_OTHER, NMI_CRYSTAL, NMI_FLASH, NMI_MEMORY };

/* Survives every reset but a loss of power. */
static struct crash_record {
    uint32_t valid;
    uint32_t exception; /* number; 0: a board fault */
    uint32_t fault;     /* enum board_fault */
    uint32_t pc, lr, xpsr, cfsr, hfsr, mmfar, bfar, stack_pointer;
    uint32_t period;   /* of the control interrupt */
    uint32_t nmi;      /* enum nmi_cause */
    uint32_t failures; /* starts in a row that ended in a crash before the start was done */
} record __attribute__((section(".no_init")));

/* What the core pushed, copied before the handler needs a stack; see crash_exception. */
__attribute__((used)) static uint32_t crash_frame[FRAME_WORDS] __attribute__((section(".no_init")));

static char cause[112];

/* Into functions in CCM SRAM. */
#define ALWAYS_INLINE static inline __attribute__((always_inline))

ALWAYS_INLINE _Noreturn void reset(void)
{
    data_barrier();
    SCB->aircr = SCB_AIRCR_VECTKEY(SCB_VECTKEY) | SCB_AIRCR_SYSRESETREQ;
    data_barrier();
    for (;;) {
    }
}

/* TIM1's registers answer only with its clock; without, its outputs are off as after a reset. */
ALWAYS_INLINE void open_bridge(void)
{
    if (RCC->apb2enr & RCC_APB2ENR_TIM1EN) {
        pwm_open_bridge();
    }
}

/* A start that keeps failing ends here: gates off, nothing feeds a watchdog that would restart. */
ALWAYS_INLINE _Noreturn void stay_off(void)
{
    for (;;) {
        wait_for_interrupt();
    }
}

ALWAYS_INLINE uint32_t nmi_cause(void)
{
    if (RCC->cifr & RCC_CIFR_CSSF) {
        return NMI_CRYSTAL;
    }
    if (FLASH->eccr & FLASH_ECCR_ECCD) {
        return NMI_FLASH;
    }
    const bool clocked = (RCC->apb2enr & RCC_APB2ENR_SYSCFGEN) != 0;

    return clocked && (SYSCFG->cfgr2 & SYSCFG_CFGR2_SPF) ? NMI_MEMORY : NMI_OTHER;
}

IN_CCM(record_begin)
static void record_begin(uint32_t exception, uint32_t fault)
{
    const uint32_t failures = record.valid == RECORD_VALID ? record.failures : 0;

    record = (struct crash_record){
        .valid = RECORD_VALID,
        .exception = exception,
        .fault = fault,
        .cfsr = SCB->cfsr,
        .hfsr = SCB->hfsr,
        .mmfar = SCB->mmfar,
        .bfar = SCB->bfar,
        .period = control_period(),
        .nmi = nmi_cause(),
        .failures = failures + 1u,
    };
}

/* The start behind the last that may fail only tells; one that fails even so is not followed. */
ALWAYS_INLINE _Noreturn void end(void)
{
    if (record.failures > STARTS_IN_A_ROW) {
        stay_off();
    }
    reset();
}

IN_CCM(board_fault)
_Noreturn void board_fault(enum board_fault fault)
{
    open_bridge();
    interrupts_disable();
    record_begin(0, fault);
    record.pc = (uint32_t)__builtin_return_address(0);
    end();
}

/* `frame`: the stack pointer behind what the core pushed; crash_exception. */
__attribute__((used)) static _Noreturn void crash_with_frame(const uint32_t *frame)
{
    uint32_t exception;

    open_bridge();
    interrupts_disable();
    __asm__ volatile("mrs %0, ipsr" : "=r"(exception));
    record_begin(exception, BOARD_FAULT_NONE);
    record.stack_pointer = (uint32_t)frame;
    if (frame >= &stack_bottom && frame + FRAME_WORDS <= &stack_top) {
        record.lr = crash_frame[5];
        record.pc = crash_frame[6];
        record.xpsr = crash_frame[7];
    }
    end();
}

/* With the whole stack, as how much of it was used may be why it came; so what the core pushed is
   copied first, if the stack pointer shows it within the stack. */
__attribute__((naked)) void crash_exception(void)
{
    __asm__ volatile("mov r0, sp\n"
                     "ldr r1, =stack_bottom\n"
                     "ldr r2, =stack_top\n"
                     "sub r3, r2, #32\n"
                     "cmp r0, r1\n"
                     "blo 1f\n"
                     "cmp r0, r3\n"
                     "bhi 1f\n"
                     "ldr r1, =crash_frame\n"
                     "ldmia r0, {r4-r11}\n"
                     "stmia r1, {r4-r11}\n"
                     "1:\n"
                     "mov sp, r2\n"
                     "b crash_with_frame\n"
                     ".ltorg\n");
}

/* A double error in the parameter store is what a loss of power leaves; any other NMI is a crash.
 */
__attribute__((naked)) void nmi_exception(void)
{
    __asm__ volatile("push {r4, lr}\n"
                     "bl parameter_flash_take_error\n"
                     "pop {r4, lr}\n"
                     "cmp r0, #0\n"
                     "it ne\n"
                     "bxne lr\n"
                     "b crash_exception\n");
}

__attribute__((naked)) void start_exception(void)
{
    __asm__ volatile("1:\n"
                     "b 1b\n");
}

static void put_address(struct text *text, const char *name, uint32_t value)
{
    text_put(text, name);
    text_put(text, "0x");
    text_hexadecimal(text, value, 8);
}

static const char *exception_name(uint32_t number)
{
    static const char *const nmi[4] = {"non-maskable interrupt", "clock lost (NMI)",
                                       "double error in flash (NMI)", "parity of SRAM (NMI)"};
    static const char *const names[7] = {
        0, 0, 0, "hard fault", "memory fault", "bus fault", "usage fault"};

    if (number == 2) {
        return nmi[record.nmi % 4u];
    }
    return number >= 3 && number < 7 ? names[number] : "unexpected exception ";
}

static void put_crash(struct text *text)
{
    static const char *const faults[BOARD_FAULT_COUNT] = {"none",
#define FAULT_TEXT(name, text) text,
                                                          BOARD_FAULTS(FAULT_TEXT)
#undef FAULT_TEXT
    };

    text_put(text, "crash: ");
    if (record.exception == 0) {
        text_put(text, record.fault < BOARD_FAULT_COUNT ? faults[record.fault] : "unknown");
        return;
    }
    text_put(text, exception_name(record.exception));
    if (record.exception >= 7) {
        text_unsigned(text, record.exception);
    }
    put_address(text, " at ", record.pc);
    put_address(text, " lr ", record.lr);
    put_address(text, " cfsr ", record.cfsr);
    if (record.period != CONTROL_NOT_STARTED) {
        text_put(text, " in period ");
        text_unsigned(text, record.period);
    }
}

static const char *reset_cause(uint32_t csr)
{
    if (csr & RCC_CSR_IWDGRSTF) {
        return "watchdog";
    }
    if (csr & RCC_CSR_BORRSTF) {
        return "power-on";
    }
    if (csr & RCC_CSR_SFTRSTF) {
        return "software reset";
    }
    return csr & RCC_CSR_PINRSTF ? "reset pin" : "unknown reset";
}

void crash_read_cause(void)
{
    const uint32_t csr = RCC->csr;
    struct text text = text_in(cause, sizeof cause);

    RCC->csr = csr | RCC_CSR_RMVF;
    if (csr & RCC_CSR_BORRSTF) { /* what memory holds after a loss of power is no record */
        record = (struct crash_record){0};
    }
    if ((csr & (RCC_CSR_SFTRSTF | RCC_CSR_IWDGRSTF)) == 0) { /* somebody wants another try */
        record.failures = 0;
    }
    if (record.valid == RECORD_VALID && (record.exception != 0 || record.fault != 0)) {
        put_crash(&text);
    } else {
        text_put(&text, reset_cause(csr));
    }
    record.valid = RECORD_VALID;
    record.exception = 0;
    record.fault = BOARD_FAULT_NONE;
}

const char *crash_start_cause(void)
{
    return cause;
}

bool crash_stays_off(void)
{
    return record.failures >= STARTS_IN_A_ROW;
}

void crash_start_done(void)
{
    record.failures = 0;
}
