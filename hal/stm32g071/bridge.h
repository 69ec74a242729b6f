/*
 * The bridge: TIM1 with one channel per half-bridge, the bridge's RESET and FAULT, and the guard of
 * the deadline.
 *
 * TIM1 counts up and down between 0 and BRIDGE_HALF_PERIOD_COUNTS; a leg is high around the valley,
 * while the counter is below its compare value. Compares act from the next peak on.
 *
 * The bridge is on while TIM1's main output is enabled and RESET is high. It is opened through
 * both: without the main output the legs' inputs are low, which alone would close the low sides.
 *
 * The guard: a compare of the cycle counter TIM2 lies 90 us behind the next peak, and the end of
 * each control interrupt moves it on by a period. If it is reached, because the interrupt takes too
 * long or does not come, the bridge opens.
 */
#ifndef STEADYSTEP_STM32G071_BRIDGE_H
#define STEADYSTEP_STM32G071_BRIDGE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/hal.h"
#include "hal/stm32g071/board.h"
#include "hal/stm32g071/registers.h"

enum {
    BRIDGE_HALF_PERIOD_COUNTS = 3200,
    BRIDGE_PERIOD_COUNTS = 2 * BRIDGE_HALF_PERIOD_COUNTS,
    BRIDGE_DEADLINE_COUNTS = 5760 /* behind the peak: 90 us */
};

/* Compare of a channel 1...4: TIM1->ccr1... */
#define TIM1_COMPARE(channel)  TIM1_COMPARE_(channel)
#define TIM1_COMPARE_(channel) (TIM1->ccr##channel)

/* Dead time is the bridge's own, so DTG is 0. Break: FAULT, low, no filter, without the clock. */
#define BRIDGE_OFF (TIM_BDTR_OSSI | TIM_BDTR_OSSR | TIM_BDTR_BKE)
#define BRIDGE_ON  (BRIDGE_OFF | TIM_BDTR_MOE)

/* Start-up: bridge off, timers stopped. */
void bridge_start(void);
/* Starts TIM1 and, with it, TIM3. false: compares do not load at the peak. */
bool bridge_run(void);

/* In the half period behind a peak: the control interrupt of the next is the first to be guarded.
 */
void bridge_guard_start(void);

/* As hal.h says. */
bool bridge_enable(void);
void bridge_disable(void);

/* The background: keeps the bridge open until bridge_release; false: it is on, or about to be. */
bool bridge_hold_open(void);
void bridge_release(void);

/* All gates off; nothing else changes. From anywhere, faults included. */
static inline void bridge_open(void)
{
    BRIDGE_RESET_PORT->brr = BIT(BRIDGE_RESET_PIN);
    TIM1->bdtr = BRIDGE_OFF;
}

/*
 * The control interrupt. bridge_begin_period returns the flags of the sample set. bridge_end_period
 * writes duties that act from the next peak on; it opens the bridge at once and closes it a period
 * after that was asked for, when the duties computed with the demand act. bridge_deadline_met moves
 * the guard on; `now` is the cycle count.
 */
uint32_t bridge_begin_period(void);
void bridge_end_period(const struct hal_outputs *outputs);
void bridge_deadline_met(uint32_t now);

#endif
