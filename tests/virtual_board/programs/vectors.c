/* Vector table of the test programs. A handler that a program does not have ends it. */
#include "program.h"

static void unexpected(void)
{
    PROBE->end = 0xdead;
    for (;;) {
    }
}

void interrupt_0(void) __attribute__((weak, alias("unexpected")));
void interrupt_1(void) __attribute__((weak, alias("unexpected")));
void interrupt_2(void) __attribute__((weak, alias("unexpected")));
void interrupt_3(void) __attribute__((weak, alias("unexpected")));
void hard_fault(void) __attribute__((weak, alias("unexpected")));
void supervisor_call(void) __attribute__((weak, alias("unexpected")));
void pend_sv(void) __attribute__((weak, alias("unexpected")));

extern uint32_t stack_top;

__attribute__((section(".vectors"), used)) static void *const vectors[] = {
    &stack_top, program,    unexpected,  hard_fault,  unexpected,      unexpected,  unexpected,
    0,          0,          0,           0,           supervisor_call, unexpected,  0,
    pend_sv,    unexpected, interrupt_0, interrupt_1, interrupt_2,     interrupt_3,
};
