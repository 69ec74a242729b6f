/* A word that lies across a boundary of words: what the core makes of it. */
#include "program.h"

__attribute__((used)) static void report(uint32_t *frame)
{
    PROBE->log = frame[6];
    frame[6] += 2u;
}

HARD_FAULT_CALLS(report)

static volatile uint32_t words[2];

void program(void)
{
    register uint32_t value __asm("r0") = 0;
    register volatile uint32_t *address __asm("r1") = words;

    words[0] = 0x33221100u;
    words[1] = 0x77665544u;
    __asm volatile("adds %1, #1 \n"
                   ".global reads_across \n.type reads_across, STT_FUNC \n"
                   "reads_across: ldr %0, [%1]"
                   : "+r"(value), "+r"(address)
                   :
                   : "cc", "memory");
    PROBE->end = value;
    for (;;) {
    }
}
