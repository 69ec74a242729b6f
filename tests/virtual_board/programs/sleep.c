/* WFI ends with the interrupt, at its time, also while PRIMASK holds the handler back. */
#include "program.h"

void interrupt_0(void)
{
    PROBE->lower[0] = 0;
    PROBE->log = 0x100;
}

void program(void)
{
    NVIC_ISER = 1;
    PROBE->log = 1;
    PROBE->raise[0] = 100000;
    __asm volatile("wfi");
    PROBE->log = 2;
    __asm volatile("cpsid i");
    PROBE->raise[0] = 5000;
    PROBE->log = 3;
    __asm volatile("wfi");
    PROBE->log = 4; /* awake, and the handler has not run */
    __asm volatile("cpsie i \n nop");
    PROBE->log = 5;
    PROBE->end = 0;
    for (;;) {
    }
}
