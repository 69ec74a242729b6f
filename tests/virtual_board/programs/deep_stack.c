/* Uses more stack than there is, in the thread and by an interrupt on top of it. */
#include "program.h"

static volatile uint32_t sum;

void interrupt_0(void)
{
    sum = sum + 1;
}

__attribute__((noinline)) static void descend(uint32_t levels)
{
    volatile uint32_t room[16];

    room[levels % 16] = levels;
    if (levels > 0) {
        descend(levels - 1);
    }
    sum = sum + room[levels % 16];
    NVIC_ISPR = 1;
}

void program(void)
{
    NVIC_ISER = 1;
    descend(11);
    PROBE->log = sum;
    descend(14);
    PROBE->end = 0;
    for (;;) {
    }
}
