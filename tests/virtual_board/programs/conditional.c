/* A loop of conditional instructions and branches, as in the compiler's division: 8 steps in
   each of 1000 rounds, under interrupts. */
#include "program.h"

void interrupt_0(void)
{
    PROBE->lower[0] = 0;
    PROBE->raise[0] = 30 + PROBE->random;
}

void program(void)
{
    uint32_t steps = 0;

    NVIC_ISER = 1;
    PROBE->raise[0] = 50;

    for (uint32_t i = 0; i < 1000; i++) {
        __asm volatile("movs r2, #1 \n"
                       "1: \n"
                       "lsls r2, r2, #1 \n"
                       "tst r2, #0x100 \n"
                       "it eq \n addeq %0, #1 \n"
                       "beq 1b \n"
                       "add %0, #1 \n"
                       : "+r"(steps)
                       :
                       : "r2", "cc");
    }
    PROBE->end = steps;
    for (;;) {
    }
}
