/*
 * The STM32G474 as CMSIS-Core wants it described, and with it the registers and instructions of the
 * Cortex-M4F. Interrupt lines: RM0440, table of vectors, as far as used; a test compares them with
 * an independent description.
 */
#ifndef STEADYSTEP_STM32G474_DEVICE_H
#define STEADYSTEP_STM32G474_DEVICE_H

/* Exceptions of the core; behind them the chip's lines. Names as CMSIS-Core's. */
typedef enum {
    NonMaskableInt_IRQn = -14,
    HardFault_IRQn = -13,
    MemoryManagement_IRQn = -12,
    BusFault_IRQn = -11,
    UsageFault_IRQn = -10,
    SVCall_IRQn = -5,
    DebugMonitor_IRQn = -4,
    PendSV_IRQn = -2,
    SysTick_IRQn = -1,
    TIM1_BRK_TIM15_IRQn = 24,
    TIM1_UP_TIM16_IRQn = 25,
    TIM2_IRQn = 28,
    FDCAN3_IT0_IRQn = 88,
    LPUART1_IRQn = 91,
} IRQn_Type;

enum { INTERRUPTS = 102 };

#define __CM4_REV              1
#define __FPU_PRESENT          1
#define __MPU_PRESENT          1
#define __NVIC_PRIO_BITS       4
#define __Vendor_SysTickConfig 0
#include <core_cm4.h>

/* Priorities, 0 the highest; all of them preempt. */
enum {
    PRIORITY_GUARD = 0,   /* opens the bridge: deadline, fault of an integrated bridge */
    PRIORITY_CONTROL = 1, /* the control interrupt */
    PRIORITY_LINE = 8,    /* end of a line on the serial line */
    PRIORITY_CAN = 9,     /* a frame of the CAN bus */
};

/* Code that runs from CCM SRAM: no wait states, whatever the flash is doing. */
#define IN_CCM(name) __attribute__((section(".ccm.text." #name), noinline))
/* What a crash calls: there from reset on, before memory is unpacked. */
#define IN_FAULT_MEMORY(name) __attribute__((section(".ccm.fault." #name), noinline))

#endif
