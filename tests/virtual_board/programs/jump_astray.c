/* A jump to what is no memory, and one to a return from an exception while there is none. */
#include "program.h"

__attribute__((used)) static void tell(uint32_t *frame)
{
    PROBE->log = frame[6];
#if __ARM_ARCH == 7
    PROBE->log = CFSR;
    CFSR = ~0u;
#endif
    frame[6] = frame[5] & ~1u; /* behind the call */
}

__attribute__((naked)) void hard_fault(void)
{
    __asm volatile("mov r0, sp \n"
                   "ldr r1, =tell \n"
                   "bx r1");
}

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
