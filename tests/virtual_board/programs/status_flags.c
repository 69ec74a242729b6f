/*
 * What APSR.GE and FPSCR hold survives interrupts: of a handler that spoils GE and does nothing of
 * floating point. The result counts what was lost.
 */
#include "program.h"

enum { ROUNDS = 3000 };

#define FLUSH_TO_ZERO 0x01000000u /* of FPSCR */
#define LESS          0x80000000u /* N, of a comparison */

void interrupt_0(void)
{
    PROBE->lower[0] = 0;
    PROBE->raise[0] = 30 + PROBE->random;
    __asm volatile("movs r0, #0 \n uadd8 r0, r0, r0" ::: "r0");
}

static uint32_t floating_point_lost(void)
{
    uint32_t status;

    __asm volatile("vmov.f32 s0, #1.0 \n vmov.f32 s1, #2.0 \n"
                   "vcmp.f32 s0, s1 \n nop \n nop \n nop \n nop \n vmrs %0, fpscr"
                   : "=r"(status)
                   :
                   : "s0", "s1");
    return (status & (FLUSH_TO_ZERO | LESS)) != (FLUSH_TO_ZERO | LESS);
}

static uint32_t lanes_lost(void)
{
    uint32_t chosen;

    __asm volatile("uadd8 r0, %1, %1 \n nop \n nop \n nop \n nop \n sel %0, %1, %2"
                   : "=r"(chosen)
                   : "r"(0x80018001u), "r"(0)
                   : "r0");
    return chosen != 0x80008000u; /* those that carried */
}

void program(void)
{
    uint32_t lost = 0;

    CPACR |= 0x00f00000;
    __asm volatile("dsb \n isb \n vmsr fpscr, %0" ::"r"(FLUSH_TO_ZERO));
    NVIC_ISER = 1;
    PROBE->raise[0] = 50;
    for (uint32_t i = 0; i < ROUNDS; i++) {
        lost += floating_point_lost() + lanes_lost();
    }
    PROBE->end = lost;
    for (;;) {
    }
}
