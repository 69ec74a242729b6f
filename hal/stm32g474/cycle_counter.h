/* The core's cycle counter, DWT. */
#ifndef STEADYSTEP_STM32G474_CYCLE_COUNTER_H
#define STEADYSTEP_STM32G474_CYCLE_COUNTER_H

#include <stdint.h>

#include "hal/stm32g474/device.h"

static inline void cycle_counter_start(void)
{
    CoreDebug->DEMCR |= CoreDebug_DEMCR_TRCENA_Msk;
    DWT->CYCCNT = 0;
    DWT->CTRL |= DWT_CTRL_CYCCNTENA_Msk;
}

static inline uint32_t cycle_counter_read(void)
{
    return DWT->CYCCNT;
}

#endif
