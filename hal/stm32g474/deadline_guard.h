/*
 * The control interrupt must have ended when 90 % of the period behind S(k) have passed. TIM2
 * counts from the first peak of the PWM timer on; its compare lies at the present period's deadline
 * until the end of the control interrupt moves it to the next. If it is reached, for whatever
 * reason (too long, not begun, not raised), the bridge opens at once, from the highest priority.
 */
#ifndef STEADYSTEP_STM32G474_DEADLINE_GUARD_H
#define STEADYSTEP_STM32G474_DEADLINE_GUARD_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/stm32g474/board.h"
#include "hal/stm32g474/registers.h"

/* The control interrupt's, but for what the guard raises. */
extern struct deadline_guard {
    uint32_t deadline;         /* of the present period, in counts of TIM2 */
    volatile bool missed;      /* a deadline has passed since the last samples */
    volatile bool out_of_step; /* since one has, `deadline` may be that of another period */
} deadline_guard;

/* Before the PWM timer starts. */
void deadline_guard_configure(void);
/* At a peak of the PWM timer: the next control interrupt is the first to be guarded. */
void deadline_guard_start(void);
/* The end of a control interrupt behind which the next deadline has to be found anew. */
void deadline_guard_find_step(void);

void deadline_guard_interrupt(void);

/* In counts of TIM2, which are core cycles. */
static inline uint32_t deadline_guard_now(void)
{
    return TIM2->cnt;
}

/* S(k) of the present period; behind a missed deadline perhaps one before. */
static inline uint32_t deadline_guard_sampling_instant(void)
{
    return deadline_guard.deadline - DEADLINE_CYCLES;
}

/* Whether a deadline has passed since the last call. */
static inline bool deadline_guard_take_missed(void)
{
    const bool missed = deadline_guard.missed;

    if (missed) {
        deadline_guard.missed = false;
    }
    return missed;
}

/* End of the control interrupt. */
static inline void deadline_guard_met(void)
{
    if (__builtin_expect(deadline_guard.out_of_step, false)) {
        deadline_guard_find_step();
    } else {
        deadline_guard.deadline += PWM_PERIOD;
        TIM2->ccr[0] = deadline_guard.deadline;
    }
}

#endif
