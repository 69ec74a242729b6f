/*
 * The Cortex-M0+ core's own registers and instructions, as far as this port uses them; Armv6-M
 * Architecture Reference Manual (DDI 0419), B3.
 */
#ifndef STEADYSTEP_STM32G071_CORE_H
#define STEADYSTEP_STM32G071_CORE_H

#include <stdint.h>

#include "hal/stm32g071/registers.h"

struct scb_registers {
    volatile uint32_t cpuid, icsr, vtor, aircr, scr, ccr, reserved0, shpr2, shpr3;
};
#define SCB ((struct scb_registers *)0xe000ed00u)

#define SCB_ICSR_PENDSVSET    BIT(28)
#define SCB_AIRCR_VECTKEY     (UINT32_C(0x05fa) << 16)
#define SCB_AIRCR_SYSRESETREQ BIT(2)

struct nvic_registers {
    volatile uint32_t iser;
    volatile uint32_t reserved0[31];
    volatile uint32_t icer;
    volatile uint32_t reserved1[31];
    volatile uint32_t ispr;
    volatile uint32_t reserved2[31];
    volatile uint32_t icpr;
    volatile uint32_t reserved3[95];
    volatile uint32_t ipr[8]; /* words only: four lines each */
};
#define NVIC ((struct nvic_registers *)0xe000e100u)

/* Two bits of priority, 0 the highest; all of them preempt. */
enum interrupt_priority {
    PRIORITY_GUARD = 0,      /* opens the bridge: deadline, overcurrent */
    PRIORITY_CONTROL = 1,    /* the control interrupt */
    PRIORITY_LINE = 2,       /* end of a line on the serial line */
    PRIORITY_STATISTICS = 3, /* what the control interrupt took */
};

static inline void wait_for_interrupt(void)
{
    __asm__ volatile("wfi" ::: "memory");
}

static inline void synchronise(void)
{
    __asm__ volatile("dsb\n isb" ::: "memory");
}

/* Orders memory accesses of the compiler only. */
static inline void compiler_barrier(void)
{
    __asm__ volatile("" ::: "memory");
}

static inline void interrupts_disable(void)
{
    __asm__ volatile("cpsid i" ::: "memory");
}

static inline void interrupts_enable(void)
{
    __asm__ volatile("cpsie i" ::: "memory");
}

/* PRIMASK, to be given back to interrupts_restore. */
static inline uint32_t interrupts_save_and_disable(void)
{
    uint32_t primask;

    __asm__ volatile("mrs %0, primask\n cpsid i" : "=r"(primask)::"memory");
    return primask;
}

static inline void interrupts_restore(uint32_t primask)
{
    __asm__ volatile("msr primask, %0" ::"r"(primask) : "memory");
}

/* Start-up: enables an interrupt at a priority; a request pending from before is dropped. */
static inline void interrupt_enable(enum interrupt interrupt, enum interrupt_priority priority)
{
    const unsigned shift = 8u * ((unsigned)interrupt % 4u);
    const uint32_t others = NVIC->ipr[interrupt / 4] & ~(UINT32_C(0xff) << shift);

    NVIC->ipr[interrupt / 4] = others | (uint32_t)priority << (shift + 6u);
    NVIC->icpr = BIT(interrupt);
    NVIC->iser = BIT(interrupt);
}

/* Handlers and what they call are linked into RAM by this name (memory.ld). */
#define IN_RAM(name) __attribute__((section(".ram_code." #name), noinline))

#endif
