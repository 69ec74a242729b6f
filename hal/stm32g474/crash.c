#include "hal/stm32g474/crash.h"

#include <stdbool.h>

#include "hal/stm32g474/control_interrupt.h"
#include "hal/stm32g474/core.h"
#include "hal/stm32g474/linker.h"
#include "hal/stm32g474/pwm.h"
#include "hal/stm32g474/wait.h"

enum {
    RECORD_VALID = 0x57ec0de5,
    STARTS_IN_A_ROW = 3, /* that may fail at the same place before the board stays off */
};

/* Survives every reset but a loss of power. */
static struct crash_record {
    uint32_t valid;
    uint32_t exception; /* number; 0: a board fault */
    uint32_t fault;     /* enum board_fault */
    uint32_t pc, lr, xpsr, cfsr, hfsr, mmfar, bfar, stack_pointer;
    uint32_t period;   /* of the control interrupt */
    uint32_t failures; /* starts in a row that ended in a board fault before the first period */
} record __attribute__((section(".no_init")));

static char cause[96];

static _Noreturn void reset(void)
{
    data_barrier();
    SCB->aircr = SCB_AIRCR_VECTKEY(SCB_VECTKEY) | SCB_AIRCR_SYSRESETREQ;
    data_barrier();
    for (;;) {
    }
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
        .failures = failures,
    };
}

IN_CCM(board_fault)
_Noreturn void board_fault(enum board_fault fault)
{
    pwm_open_bridge();
    interrupts_disable();
    record_begin(0, fault);
    record.pc = (uint32_t)__builtin_return_address(0);
    record.failures += record.period == CONTROL_NOT_STARTED;
    if (record.failures >= STARTS_IN_A_ROW) {
        for (;;) { /* gates off; a debugger finds the record */
            wait_for_interrupt();
        }
    }
    reset();
}

/* The frame that the core pushed, if the stack pointer is one; see crash_exception. */
__attribute__((used)) static _Noreturn void crash_with_frame(const uint32_t *frame)
{
    uint32_t exception;

    pwm_open_bridge();
    __asm__ volatile("mrs %0, ipsr" : "=r"(exception));
    record_begin(exception, BOARD_FAULT_NONE);
    record.stack_pointer = (uint32_t)frame;
    if (frame >= &stack_bottom && frame + 8 <= &stack_top) {
        record.lr = frame[5];
        record.pc = frame[6];
        record.xpsr = frame[7];
    }
    reset();
}

/* On a stack of its own, as the old one may be why it came. */
__attribute__((naked)) void crash_exception(void)
{
    __asm__ volatile("mov r0, sp\n"
                     "ldr r1, =stack_top\n"
                     "mov sp, r1\n"
                     "b crash_with_frame\n"
                     ".ltorg\n");
}

static char *put_text(char *at, const char *text)
{
    while (*text != '\0' && at < &cause[sizeof cause - 1]) {
        *at++ = *text++;
    }
    return at;
}

static char *put_hexadecimal(char *at, uint32_t value)
{
    at = put_text(at, "0x");
    for (int shift = 28; shift >= 0; shift -= 4) {
        const char digit[2] = {"0123456789abcdef"[(value >> shift) & 15u], '\0'};
        at = put_text(at, digit);
    }
    return at;
}

static char *put_decimal(char *at, uint32_t value)
{
    char digits[11];
    char *digit = &digits[10];

    *digit = '\0';
    do {
        *--digit = (char)('0' + value % 10u);
        value /= 10u;
    } while (value > 0);
    return put_text(at, digit);
}

static const char *exception_name(uint32_t number)
{
    static const char *const names[7] = {
        0, 0, "clock lost (NMI)", "hard fault", "memory fault", "bus fault", "usage fault"};
    return number >= 2 && number < 7 ? names[number] : "unexpected exception ";
}

static char *put_crash(char *at)
{
    static const char *const faults[BOARD_FAULT_COUNT] = {"none",
#define FAULT_TEXT(name, text) text,
                                                          BOARD_FAULTS(FAULT_TEXT)
#undef FAULT_TEXT
    };

    at = put_text(at, "crash: ");
    if (record.exception == 0) {
        return put_text(at, record.fault < BOARD_FAULT_COUNT ? faults[record.fault] : "unknown");
    }
    at = put_text(at, exception_name(record.exception));
    if (record.exception >= 7) {
        at = put_decimal(at, record.exception);
    }
    at = put_hexadecimal(put_text(at, " at "), record.pc);
    at = put_hexadecimal(put_text(at, " lr "), record.lr);
    at = put_hexadecimal(put_text(at, " cfsr "), record.cfsr);
    if (record.period != CONTROL_NOT_STARTED) {
        at = put_decimal(put_text(at, " in period "), record.period);
    }
    return at;
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
    char *at = cause;

    RCC->csr = csr | RCC_CSR_RMVF;
    if (csr & RCC_CSR_BORRSTF) { /* what memory holds after a loss of power is no record */
        record = (struct crash_record){0};
    }
    if (record.valid == RECORD_VALID && (record.exception != 0 || record.fault != 0)) {
        at = put_crash(at);
    } else {
        at = put_text(at, reset_cause(csr));
    }
    *at = '\0';
    record.valid = RECORD_VALID;
    record.exception = 0;
    record.fault = BOARD_FAULT_NONE;
}

const char *crash_start_cause(void)
{
    return cause;
}

void crash_start_done(void)
{
    record.failures = 0;
}
