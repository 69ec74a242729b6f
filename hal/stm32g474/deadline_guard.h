/*
 * The control interrupt must have ended 90 us after S(k). TIM2 counts from the first peak of the
 * PWM timer on; its compare lies at the present period's deadline until the end of the control
 * interrupt moves it to the next. If it is reached, for whatever reason (too long, not begun, not
 * raised), the bridge opens at once, from the highest priority.
 */
#ifndef STEADYSTEP_STM32G474_DEADLINE_GUARD_H
#define STEADYSTEP_STM32G474_DEADLINE_GUARD_H

#include <stdbool.h>

#include "hal/stm32g474/board.h"
#include "hal/stm32g474/registers.h"

/* Before the PWM timer starts. */
void deadline_guard_configure(void);
/* At a peak of the PWM timer: the next control interrupt is the first to be guarded. */
void deadline_guard_start(void);
/* Whether a deadline has passed since the last call. */
bool deadline_guard_missed(void);
/* Whether one has, without forgetting it. */
bool deadline_guard_tripped(void);

/* End of the control interrupt. */
static inline void deadline_guard_met(void)
{
    do {
        TIM2->ccr[0] += PWM_PERIOD;
    } while ((int32_t)(TIM2->ccr[0] - TIM2->cnt) < 0); /* periods without an interrupt */
}

void deadline_guard_interrupt(void);

#endif
