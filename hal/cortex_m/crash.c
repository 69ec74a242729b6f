#include "hal/cortex_m/crash.h"

#include "firmware/design/text.h"
#include "hal/cortex_m/interrupts.h"
#include "hal/cortex_m/linker.h"
#include "hal/cortex_m/port.h"
#include "hal/cortex_m/serial_line.h"
#include "hal/cortex_m/wait.h"

enum {
    RECORD_VALID = 0x57ec0de5,
    STARTS_IN_A_ROW = 3, /* that may fail before the board stays off */
    FRAME_WORDS = 8,     /* r0...r3, r12, lr, pc, xpsr */
};

/* What the core says of a fault; stays 0 on Armv6-M, which says nothing. */
struct fault_status {
    uint32_t cfsr, hfsr, mmfar, bfar;
};

/* Survives every reset but a loss of power. */
static struct crash_record {
    uint32_t valid;
    uint32_t exception; /* number; 0: a board fault */
    uint32_t fault;     /* enum board_fault */
    uint32_t pc, lr, xpsr, stack_pointer;
    struct fault_status status;
    uint32_t period;   /* of the control interrupt */
    uint32_t nmi;      /* port_nmi_cause */
    uint32_t failures; /* starts in a row that ended in a crash before the start was done */
} record __attribute__((section(".no_init")));

/* What the core pushed, copied before the handler needs a stack; see crash_exception. */
__attribute__((used)) static uint32_t crash_frame[FRAME_WORDS] __attribute__((section(".no_init")));

static char cause[112];

static inline void record_fault_status(void)
{
#if __CORTEX_M >= 3
    record.status = (struct fault_status){SCB->CFSR, SCB->HFSR, SCB->MMFAR, SCB->BFAR};
#endif
}

IN_FAULT_MEMORY(record_begin)
static void record_begin(uint32_t exception, uint32_t fault)
{
    const uint32_t failures = record.valid == RECORD_VALID ? record.failures : 0;

    record = (struct crash_record){
        .valid = RECORD_VALID,
        .exception = exception,
        .fault = fault,
        .period = port_control_period(),
        .nmi = port_nmi_cause(),
        .failures = failures + 1u,
    };
    record_fault_status();
}

/* The start behind the last that may fail only reports; one that fails even so is not followed:
   gates off, nothing feeds a watchdog that would restart. */
IN_FAULT_MEMORY(end)
static _Noreturn void end(void)
{
    while (record.failures > STARTS_IN_A_ROW) {
        __WFI();
    }
    NVIC_SystemReset();
}

IN_FAULT_MEMORY(board_fault)
_Noreturn void board_fault(enum board_fault fault)
{
    port_open_bridge();
    __disable_irq();
    record_begin(0, fault);
    record.pc = (uint32_t)__builtin_return_address(0);
    end();
}

/* `frame`: the stack pointer behind what the core pushed; crash_exception. */
__attribute__((used)) _Noreturn void crash_with_frame(const uint32_t *frame);
_Noreturn void crash_with_frame(const uint32_t *frame)
{
    record_begin(__get_IPSR(), BOARD_FAULT_NONE);
    record.stack_pointer = (uint32_t)frame;
    if (frame >= &stack_bottom && frame + FRAME_WORDS <= &stack_top) {
        record.lr = crash_frame[5];
        record.pc = crash_frame[6];
        record.xpsr = crash_frame[7];
    }
    end();
}

/* Opens the bridge before anything else: port_open_bridge uses no stack, which may be none. Then
   with the whole stack, as how much of it was used may be why it came; so what the core pushed is
   copied before, if the stack pointer shows it within the stack. */
__attribute__((naked)) void crash_exception(void)
{
    __asm__ volatile(".syntax unified\n"
                     "cpsid i\n"
                     "ldr r3, =port_open_bridge\n"
                     "blx r3\n"
                     "mov r0, sp\n"
                     "ldr r1, =stack_bottom\n"
                     "ldr r2, =stack_top\n"
                     "mov r3, r2\n"
                     "subs r3, #32\n"
                     "cmp r0, r1\n"
                     "blo 1f\n"
                     "cmp r0, r3\n"
                     "bhi 1f\n"
                     "ldr r1, =crash_frame\n"
                     "ldmia r0!, {r4-r7}\n"
                     "stmia r1!, {r4-r7}\n"
                     "ldmia r0!, {r4-r7}\n"
                     "stmia r1!, {r4-r7}\n"
                     "subs r0, #32\n"
                     "1:\n"
                     "mov sp, r2\n"
                     "ldr r3, =crash_with_frame\n"
                     "bx r3\n"
                     ".ltorg\n");
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

static void put_exception(struct text *text, uint32_t number)
{
    static const char *const names[7] = {
        0, 0, 0, "hard fault", "memory fault", "bus fault", "usage fault"};

    if (number == 2) {
        text_put(text, port_nmi_text(record.nmi));
    } else if (number >= 3 && number < 7) {
        text_put(text, names[number]);
    } else {
        text_put(text, "unexpected exception ");
        text_unsigned(text, number);
    }
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
    put_exception(text, record.exception);
    put_address(text, " at ", record.pc);
    put_address(text, " lr ", record.lr);
#if __CORTEX_M >= 3
    put_address(text, " cfsr ", record.status.cfsr);
#endif
    if (record.period != PORT_NOT_STARTED) {
        text_put(text, " in period ");
        text_unsigned(text, record.period);
    }
}

void crash_read_cause(void)
{
    static const char *const causes[] = {"unknown reset", "reset pin", "software reset", "watchdog",
                                         "power-on"};
    const enum reset_cause reset = port_take_reset_cause();
    struct text text = text_in(cause, sizeof cause);

    if (reset == RESET_POWER_ON) { /* what memory holds after a loss of power is no record */
        record = (struct crash_record){0};
    }
    if (reset != RESET_SOFTWARE && reset != RESET_WATCHDOG) { /* somebody wants another try */
        record.failures = 0;
    }
    if (record.valid == RECORD_VALID && (record.exception != 0 || record.fault != 0)) {
        put_crash(&text);
    } else {
        text_put(&text, causes[reset]);
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

_Noreturn void crash_report(void)
{
    for (;;) {
        serial_line_report("steadystep stays off, three starts failed: ");
        serial_line_report(cause);
        serial_line_report("\r\n");
        wait_cycles(16000000); /* both ports start at 16 MHz */
    }
}

void crash_watch_start(uint32_t start_periods)
{
    if (port_control_period() - start_periods < PORT_NOT_STARTED / 2) {
        record.failures = 0;
    }
}
