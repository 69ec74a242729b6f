/*
 * Quadrature encoder on the timer of the pin map, every edge counted; without one it counts none.
 * Its index, if the pin map has one, captures the count by another channel of the timer. It is
 * filtered as A and B are, so that all three are late alike.
 */
#ifndef STEADYSTEP_STM32G474_ENCODER_H
#define STEADYSTEP_STM32G474_ENCODER_H

#include <stdint.h>

#include "hal/stm32g474/board.h"
#include "hal/stm32g474/registers.h"

#define ENCODER PERIPHERAL(TIM, ENCODER_TIMER)

void encoder_configure(void);

/* Count since start-up, from that of the last control interrupt, 32,767 counts ago at most. Its
   lower half is the timer's. */
static inline int32_t encoder_count(int32_t before)
{
#if ENCODER_TIMER != 0
    return before + (int16_t)(ENCODER->cnt - (uint32_t)before);
#else
    return before;
#endif
}

#endif
