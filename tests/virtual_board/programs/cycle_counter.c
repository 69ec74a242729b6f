/* The cycle counter counts what the probe's clock counts, and sleep, too. */
#include "program.h"

void interrupt_0(void)
{
    PROBE->lower[0] = 0;
}

void program(void)
{
    DEMCR |= 1u << 24;
    DWT_CYCCNT = 0;
    DWT_CTRL |= 1;
    const uint32_t before = DWT_CYCCNT;
    PROBE->log = 1;
    NVIC_ISER = 1;
    PROBE->raise[0] = 10000;
    __asm volatile("wfi");
    PROBE->log = 2;
    PROBE->log = DWT_CYCCNT - before;
    PROBE->end = 0;
    for (;;) {
    }
}
