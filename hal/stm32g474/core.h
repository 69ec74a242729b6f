/*
 * The Cortex-M4F core's own registers and instructions, as far as this port uses them; ARMv7-M
 * Architecture Reference Manual, B3 (system control, NVIC) and C1 (debug, DWT).
 */
#ifndef STEADYSTEP_STM32G474_CORE_H
#define STEADYSTEP_STM32G474_CORE_H

#include <stdint.h>

#include "hal/stm32g474/registers.h"

enum { SCB_VECTKEY = 0x05fa };

struct scb_registers {
    volatile uint32_t cpuid, icsr, vtor, aircr, scr, ccr;
    volatile uint8_t shpr[12];
    volatile uint32_t shcsr, cfsr, hfsr, dfsr, mmfar, bfar, afsr;
    volatile uint32_t reserved0[18];
    volatile uint32_t cpacr;
};
#define SCB ((struct scb_registers *)0xe000ed00u)

#define SCB_AIRCR_VECTKEY(value) FIELD(value, 16, 16)
#define SCB_AIRCR_SYSRESETREQ    BIT(2)
#define SCB_CCR_DIV_0_TRP        BIT(4)
#define SCB_SHCSR_MEMFAULTENA    BIT(16)
#define SCB_SHCSR_BUSFAULTENA    BIT(17)
#define SCB_SHCSR_USGFAULTENA    BIT(18)

/* Coprocessor access; full for both is access to the FPU. */
#define SCB_CPACR_CP10(value) FIELD(value, 20, 2)
#define SCB_CPACR_CP11(value) FIELD(value, 22, 2)

struct nvic_registers {
    volatile uint32_t iser[8];
    volatile uint32_t reserved0[24];
    volatile uint32_t icer[8];
    volatile uint32_t reserved1[24];
    volatile uint32_t ispr[8];
    volatile uint32_t reserved2[24];
    volatile uint32_t icpr[8];
    volatile uint32_t reserved3[24];
    volatile uint32_t iabr[8];
    volatile uint32_t reserved4[56];
    volatile uint8_t ipr[240];
};
#define NVIC ((struct nvic_registers *)0xe000e100u)

/* Four bits of priority, 0 the highest; all of them preempt. */
enum interrupt_priority {
    PRIORITY_GUARD = 0,   /* opens the bridge: deadline, overcurrent */
    PRIORITY_CONTROL = 1, /* the control interrupt */
    PRIORITY_LINE = 8,    /* end of a line on the serial line */
};

struct dwt_registers {
    volatile uint32_t ctrl, cyccnt;
};
#define DWT ((struct dwt_registers *)0xe0001000u)

#define DWT_CTRL_CYCCNTENA BIT(0)

struct core_debug_registers {
    volatile uint32_t dhcsr, dcrsr, dcrdr, demcr;
};
#define COREDEBUG ((struct core_debug_registers *)0xe000edf0u)

#define COREDEBUG_DEMCR_TRCENA BIT(24)

static inline void data_barrier(void)
{
    __asm__ volatile("dsb" ::: "memory");
}

static inline void instruction_barrier(void)
{
    __asm__ volatile("isb" ::: "memory");
}

/* Orders memory accesses of the compiler only. */
static inline void compiler_barrier(void)
{
    __asm__ volatile("" ::: "memory");
}

static inline void wait_for_interrupt(void)
{
    __asm__ volatile("wfi" ::: "memory");
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

/* Enables an interrupt at a priority; a request that is pending from before is dropped. */
static inline void interrupt_enable(enum interrupt interrupt, enum interrupt_priority priority)
{
    NVIC->ipr[interrupt] = (uint8_t)(priority << 4);
    NVIC->icpr[interrupt / 32] = BIT(interrupt % 32);
    NVIC->iser[interrupt / 32] = BIT(interrupt % 32);
}

/* Code and constants that run from CCM SRAM: no wait states, whatever the flash is doing. */
#define IN_CCM(name) __attribute__((section(".ccm.text." #name), noinline))

#endif
