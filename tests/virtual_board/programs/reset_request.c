/* Asks for a reset once; memory keeps its contents, the core starts anew. */
#include "program.h"

enum { MARK = 0x600d };

static uint32_t mark; /* not cleared at start-up: there is none */

void program(void)
{
    if (mark == MARK) {
        PROBE->end = AIRCR >> 16;
        for (;;) {
        }
    }
    mark = MARK;
    NVIC_ISER = 1;
    AIRCR = 0x05fa0004;
    for (;;) {
    }
}
