/*
 * Interrupts of a Cortex-M core, on top of CMSIS-Core, which comes with the port's device.h: lines
 * and priorities are the port's.
 */
#ifndef STEADYSTEP_CORTEX_M_INTERRUPTS_H
#define STEADYSTEP_CORTEX_M_INTERRUPTS_H

#include <stdint.h>

#include STEADYSTEP_DEVICE

/* Start-up: enables a line at a priority; a request that is pending from before is dropped. */
static inline void interrupt_enable(IRQn_Type line, uint32_t priority)
{
    NVIC_SetPriority(line, priority);
    NVIC_ClearPendingIRQ(line);
    NVIC_EnableIRQ(line);
}

/* PRIMASK, to be given back to interrupts_restore. */
static inline uint32_t interrupts_save_and_disable(void)
{
    const uint32_t primask = __get_PRIMASK();

    __disable_irq();
    return primask;
}

static inline void interrupts_restore(uint32_t primask)
{
    __set_PRIMASK(primask);
}

#endif
