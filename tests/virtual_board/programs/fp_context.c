/* Patterns in s0...s15, r0...r3, r12 and the flags hold over thousands of interrupts that spoil
   them. */
#include "program.h"

enum { INTERRUPTS = 5000 };

static volatile uint32_t count;

void interrupt_0(void)
{
    PROBE->lower[0] = 0;
    if (++count < INTERRUPTS) {
        PROBE->raise[0] = 40 + PROBE->random;
    }
    __asm volatile("vmov.f32 s0, #3.0 \n vmov.f32 s1, s0 \n vmov.f32 s7, s0 \n vmov.f32 s8, s0 \n"
                   "vmov.f32 s15, s0 \n vcmp.f32 s0, #0 \n vmrs apsr_nzcv, fpscr \n"
                   "mov r0, #1 \n mov r1, #1 \n mov r2, #1 \n mov r3, #1 \n mov r12, #1 \n"
                   "adds r0, r0, r0 \n" ::
                       : "s0", "s1", "s7", "s8", "s15", "r0", "r1", "r2", "r3", "r12", "cc");
}

/* The loop keeps patterns everywhere and compares them all; 0: all held. */
static uint32_t hold_patterns(void)
{
    uint32_t spoilt;

    __asm volatile("vmov s0, %[a] \n vmov s1, %[a] \n vmov s7, %[a] \n vmov s8, %[a] \n"
                   "vmov s15, %[a] \n"
                   "movs r0, #10 \n mov r1, #11 \n mov r2, #12 \n mov r3, #13 \n mov r12, #14 \n"
                   "movs r4, #60 \n"
                   "1: \n"
                   "cmp r4, #0 \n" /* the flags live over the next few instructions */
                   "nop \n nop \n nop \n nop \n"
                   "beq 2f \n"
                   "sub r4, r4, #1 \n"
                   "b 1b \n"
                   "2: \n"
                   "mov %[bad], #0 \n"
                   "cmp r0, #10 \n it ne \n movne %[bad], #1 \n"
                   "cmp r1, #11 \n it ne \n movne %[bad], #2 \n"
                   "cmp r2, #12 \n it ne \n movne %[bad], #3 \n"
                   "cmp r3, #13 \n it ne \n movne %[bad], #4 \n"
                   "cmp r12, #14 \n it ne \n movne %[bad], #5 \n"
                   "vmov r0, s0 \n cmp r0, %[a] \n it ne \n movne %[bad], #6 \n"
                   "vmov r0, s1 \n cmp r0, %[a] \n it ne \n movne %[bad], #7 \n"
                   "vmov r0, s7 \n cmp r0, %[a] \n it ne \n movne %[bad], #8 \n"
                   "vmov r0, s8 \n cmp r0, %[a] \n it ne \n movne %[bad], #9 \n"
                   "vmov r0, s15 \n cmp r0, %[a] \n it ne \n movne %[bad], #10 \n"
                   : [bad] "=&r"(spoilt)
                   : [a] "r"(0x40490fdb)
                   : "s0", "s1", "s7", "s8", "s15", "r0", "r1", "r2", "r3", "r4", "r12", "cc");
    return spoilt;
}

void program(void)
{
    CPACR |= 0x00f00000;
    __asm volatile("dsb \n isb");
#ifdef WITHOUT_FP_CONTEXT
    FPCCR = 0; /* the mistake that this program is there to show */
#endif
    count = 0;
    NVIC_ISER = 1;
    PROBE->raise[0] = 100;
    uint32_t spoilt = 0;
    while (count < INTERRUPTS && spoilt == 0) {
        spoilt = hold_patterns();
    }
    PROBE->end = spoilt;
    for (;;) {
    }
}
