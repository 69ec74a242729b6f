/*
 * The STM32G071 as CMSIS-Core wants it described, and with it the registers and instructions of the
 * Cortex-M0+. Interrupt lines: RM0444, table of vectors, as far as used; a test compares them with
 * an independent description.
 */
#ifndef STEADYSTEP_STM32G071_DEVICE_H
#define STEADYSTEP_STM32G071_DEVICE_H

/* Exceptions of the core; behind them the chip's lines. Names as CMSIS-Core's. */
typedef enum {
    NonMaskableInt_IRQn = -14,
    HardFault_IRQn = -13,
    SVCall_IRQn = -5,
    PendSV_IRQn = -2,
    SysTick_IRQn = -1,
    DMA1_CHANNEL1_IRQn = 9,
    DMA1_CHANNEL2_3_IRQn = 10,
    TIM1_BRK_UP_TRG_COM_IRQn = 13,
    TIM2_IRQn = 15,
    USART3_4_LPUART1_IRQn = 29,
} IRQn_Type;

enum { INTERRUPTS = 31 };

#define __CM0PLUS_REV          0
#define __MPU_PRESENT          1
#define __VTOR_PRESENT         1
#define __NVIC_PRIO_BITS       2
#define __Vendor_SysTickConfig 0
#include <core_cm0plus.h>

/* Priorities, 0 the highest; all of them preempt. */
enum {
    PRIORITY_GUARD = 0,      /* opens the bridge: deadline, overcurrent */
    PRIORITY_CONTROL = 1,    /* the control interrupt */
    PRIORITY_LINE = 2,       /* end of a line on the serial line */
    PRIORITY_STATISTICS = 3, /* what the control interrupt took */
};

/* Handlers and what they call are linked into RAM by this name (memory.ld). */
#define IN_RAM(name) __attribute__((section(".ram_code." #name), noinline))
/* No control interrupt ends in a fault of the board; it may lie in flash. */
#define IN_FAULT_MEMORY(name)

#endif
