/* The core's cycle counter, DWT. */
#ifndef STEADYSTEP_STM32G474_CYCLE_COUNTER_H
#define STEADYSTEP_STM32G474_CYCLE_COUNTER_H

#include "hal/stm32g474/core.h"

static inline void cycle_counter_start(void)
{
    COREDEBUG->demcr |= COREDEBUG_DEMCR_TRCENA;
    DWT->cyccnt = 0;
    DWT->ctrl |= DWT_CTRL_CYCCNTENA;
}

static inline uint32_t cycle_counter_read(void)
{
    return DWT->cyccnt;
}

#endif
