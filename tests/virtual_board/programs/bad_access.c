/* A read of nothing is a HardFault that knows where it happened. */
#include "program.h"

__attribute__((naked)) void hard_fault(void)
{
    __asm volatile("ldr r0, [sp, #24] \n" /* the program counter that was stacked */
                   "ldr r1, =0x40000004 \n"
                   "str r0, [r1] \n"
                   "ldr r2, =0xe000ed28 \n ldr r0, [r2] \n str r0, [r1] \n"
                   "ldr r0, [r2, #4] \n str r0, [r1] \n"
                   "movs r0, #7 \n str r0, [r1, #-4] \n"
                   "b .");
}

void program(void)
{
    __asm volatile(".global reads_nothing \n"
                   "mov r0, #0x60000000 \n"
                   ".type reads_nothing, STT_FUNC \n"
                   "reads_nothing: ldr r0, [r0]" ::
                       : "r0");
    PROBE->end = 0;
    for (;;) {
    }
}
