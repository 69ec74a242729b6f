/* A jump to what is no memory, and one to a return from an exception while there is none. */
#include "program.h"

__attribute__((used)) static void report(uint32_t *frame)
{
    PROBE->log = frame[6];
    PROBE->log = CFSR;
    CFSR = ~0u;
    frame[6] = frame[5] & ~1u; /* behind the call */
}

HARD_FAULT_CALLS(report)

static void jump(uint32_t address)
{
    __asm volatile("blx %0" ::"r"(address) : "lr", "r0", "r1", "r2", "r3", "r12", "memory");
}

void program(void)
{
    jump(0x60000001u);
    jump(0xfffffff9u);
    PROBE->end = 1;
    for (;;) {
    }
}
