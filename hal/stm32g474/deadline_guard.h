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
#include "hal/stm32g474/pwm.h"
#include "hal/stm32g474/registers.h"

/* Before the PWM timer starts. */
void deadline_guard_configure(void);
/* At a peak of the PWM timer: the next control interrupt is the first to be guarded. */
void deadline_guard_start(void);
/* Whether a deadline has passed since the last call. */
bool deadline_guard_take_missed(void);
/* Whether one has, without forgetting it. */
bool deadline_guard_has_missed(void);

/* End of the control interrupt. */
static inline void deadline_guard_met(void)
{
    const uint32_t count = TIM2->cnt;
    uint32_t next = TIM2->ccr[0] + PWM_PERIOD;

    /* After periods without an interrupt, or a halt in which TIM2 alone went on: in step anew. */
    if (next - count > PWM_PERIOD + DEADLINE_CYCLES) {
        next = count - pwm_cycles_since_peak() + PWM_PERIOD + DEADLINE_CYCLES;
    }
    TIM2->ccr[0] = next;
}

void deadline_guard_interrupt(void);

#endif
