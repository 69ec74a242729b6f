/*
 * Reset, vectors and semihosting of a target test. Vector table and reset: ARMv7-M Architecture
 * Reference Manual B1.5; semihosting calls: Arm "Semihosting for AArch32 and AArch64", 2.0.
 */
#include <stdint.h>
#include <stdlib.h>

#include "tests/target/semihosting.h"

enum { SYS_WRITE0 = 0x04, SYS_EXIT_EXTENDED = 0x20, APPLICATION_EXIT = 0x20026 };

extern uint32_t stack_top, data_load, data_start, data_end, bss_start, bss_end;

int main(void);
void reset_handler(void);
_Noreturn void _exit(int status);
int _write(int file, const char *text, int count);

static void semihosting_call(int operation, const void *parameter)
{
    register int r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = parameter;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

void semihosting_write(const char *text)
{
    semihosting_call(SYS_WRITE0, text);
}

_Noreturn void semihosting_exit(int status)
{
    uint32_t reason[2] = {APPLICATION_EXIT, (uint32_t)status};
    semihosting_call(SYS_EXIT_EXTENDED, reason);
    for (;;) {
    }
}

/* newlib: what printf and exit end in. */
int _write(int file, const char *text, int count)
{
    char piece[33];
    int length = 0;
    (void)file;
    for (int k = 0; k < count; ++k) {
        piece[length++] = text[k];
        if (length == 32 || k == count - 1) {
            piece[length] = '\0';
            semihosting_write(piece);
            length = 0;
        }
    }
    return count;
}

_Noreturn void _exit(int status)
{
    semihosting_exit(status);
}

static void unexpected_exception(void)
{
    semihosting_write("unexpected exception\n");
    semihosting_exit(99);
}

void reset_handler(void)
{
    const uint32_t *load = &data_load;
    for (uint32_t *word = &data_start; word < &data_end; ++word)
        *word = *load++;
    for (uint32_t *word = &bss_start; word < &bss_end; ++word)
        *word = 0;
#if defined(__ARM_FP)
    *(volatile uint32_t *)0xe000ed88u |= 0xfu << 20; /* CPACR: full access to CP10 and CP11 */
    __asm__ volatile("dsb\n isb");
#endif
    exit(main());
}

typedef void (*vector)(void);

__attribute__((section(".vectors"), used)) static const vector vectors[16] = {
    (vector)&stack_top,
    reset_handler,
    unexpected_exception,
    unexpected_exception,
    unexpected_exception,
    unexpected_exception,
    unexpected_exception,
    0,
    0,
    0,
    0,
    unexpected_exception,
    unexpected_exception,
    0,
    unexpected_exception,
    unexpected_exception,
};
