/*
 * What a test's program stands on: a vector table and the probe, a peripheral of the test's own.
 * The programs run on the virtual board's core alone.
 */
#ifndef STEADYSTEP_TESTS_PROGRAM_H
#define STEADYSTEP_TESTS_PROGRAM_H

#include <stdint.h>

/* The probe: probe_device.h. */
struct probe {
    volatile uint32_t end;      /* written: the program ends with this result */
    volatile uint32_t log;      /* written: kept, with the time */
    volatile uint32_t random;   /* read: the next of a fixed sequence, 0...255 */
    volatile uint32_t raise_0;  /* read: interrupt line 0 becomes high at once */
    volatile uint32_t raise[8]; /* written: interrupt line n becomes high after so many cycles */
    volatile uint32_t lower[8]; /* written: line n becomes low */
};

#define PROBE ((struct probe *)0x40000000)

#define REGISTER(address) (*(volatile uint32_t *)(address))
#define NVIC_ISER         REGISTER(0xe000e100)
#define NVIC_ISPR         REGISTER(0xe000e200)
#define NVIC_IPR0         REGISTER(0xe000e400)
#define NVIC_IPR1         REGISTER(0xe000e404)
#define ICSR              REGISTER(0xe000ed04)
#define AIRCR             REGISTER(0xe000ed0c)
#define CCR               REGISTER(0xe000ed14)
#define CFSR              REGISTER(0xe000ed28)
#define HFSR              REGISTER(0xe000ed2c)
#define CPACR             REGISTER(0xe000ed88)
#define DEMCR             REGISTER(0xe000edfc)
#define DWT_CTRL          REGISTER(0xe0001000)
#define DWT_CYCCNT        REGISTER(0xe0001004)
#define FPCCR             REGISTER(0xe000ef34)

/* A HardFault's handler: calls `function` with the frame, in which [5] is LR and [6] the program
   counter, and returns to what that leaves there. */
#define HARD_FAULT_CALLS(function)                                                                 \
    __attribute__((naked)) void hard_fault(void)                                                   \
    {                                                                                              \
        __asm volatile("mov r0, sp \n ldr r1, =" #function " \n bx r1");                           \
    }

void program(void); /* the reset handler */
void interrupt_0(void);
void interrupt_1(void);
void interrupt_2(void);
void interrupt_3(void);
void hard_fault(void);
void supervisor_call(void);
void pend_sv(void);

#endif
