#include "hal/stm32g071/crash.h"

#include "firmware/design/text.h"
#include "hal/stm32g071/board.h"
#include "hal/stm32g071/bridge.h"
#include "hal/stm32g071/core.h"
#include "hal/stm32g071/linker.h"

enum {
    RECORD_VALID = 0x57ec0de5,
    STARTS_IN_A_ROW = 3 /* that may fail at the same place before the board stays off */
};

/* Survives every reset but a loss of power. */
static struct crash_record {
    uint32_t valid;
    uint32_t exception; /* number; 0: a board fault */
    uint32_t fault;     /* enum board_fault */
    uint32_t pc, lr;
    uint32_t period;   /* of the control interrupt */
    uint32_t failures; /* starts in a row that ended in a board fault before the first period */
} record __attribute__((section(".no_init")));

static char cause[96];

static _Noreturn void reset(void)
{
    synchronise();
    SCB->aircr = SCB_AIRCR_VECTKEY | SCB_AIRCR_SYSRESETREQ;
    synchronise();
    for (;;) {
    }
}

static void record_begin(uint32_t exception, uint32_t fault)
{
    record.exception = exception;
    record.fault = fault;
    record.pc = 0;
    record.lr = 0;
    record.period = board_period();
}

_Noreturn void board_fault(enum board_fault fault)
{
    bridge_open();
    interrupts_disable();
    record_begin(0, fault);
    record.failures = record.period == UINT32_MAX ? record.failures + 1 : 0;
    if (record.failures >= STARTS_IN_A_ROW) {
        for (;;) { /* gates off; a debugger finds the record */
            wait_for_interrupt();
        }
    }
    reset();
}

/* The frame that the core pushed, if the stack pointer is one; see crash_exception. */
__attribute__((used)) _Noreturn void crash_with_frame(const uint32_t *frame);
_Noreturn void crash_with_frame(const uint32_t *frame)
{
    uint32_t exception;

    bridge_open();
    __asm__ volatile("mrs %0, ipsr" : "=r"(exception));
    record_begin(exception, BOARD_FAULT_NONE);
    if (frame >= &stack_bottom && frame + 8 <= &stack_top) {
        record.lr = frame[5];
        record.pc = frame[6];
    }
    reset();
}

/* With the stack begun anew, as the old one may be why it came. */
__attribute__((naked)) void crash_exception(void)
{
    __asm__ volatile("mov r0, sp\n"
                     "ldr r1, =stack_top\n"
                     "mov sp, r1\n"
                     "ldr r1, =crash_with_frame\n"
                     "bx r1\n"
                     ".ltorg\n");
}

static void put_address(struct text *text, const char *name, uint32_t address)
{
    text_put(text, name);
    text_hexadecimal(text, address, 8);
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
    if (record.exception == 3) {
        text_put(text, "hard fault");
    } else {
        text_put(text, "unexpected exception ");
        text_unsigned(text, record.exception);
    }
    put_address(text, " at 0x", record.pc);
    put_address(text, " lr 0x", record.lr);
    if (record.period != UINT32_MAX) {
        text_put(text, " in period ");
        text_unsigned(text, record.period);
    }
}

static const char *reset_cause(uint32_t csr)
{
    if (csr & RCC_CSR_IWDGRSTF) {
        return "watchdog";
    }
    if (csr & RCC_CSR_PWRRSTF) {
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
    if ((csr & RCC_CSR_PWRRSTF) != 0 || record.valid != RECORD_VALID) {
        record = (struct crash_record){.valid = RECORD_VALID};
    }
    if (record.exception != 0 || record.fault != BOARD_FAULT_NONE) {
        put_crash(&text);
    } else {
        text_put(&text, reset_cause(csr));
    }
    record.exception = 0;
    record.fault = BOARD_FAULT_NONE;
}

const char *crash_start_cause(void)
{
    return cause;
}
