/*
 * The PWM timer TIM1: four half-bridges with dead time, centre-aligned, 170 MHz, 10 kHz. Legs are
 * high around the valley; compares load at the peak alone. The peak, S(k), starts the injected
 * conversions (TRGO2, from channel 5), raises the control interrupt (update) and starts, once, the
 * timers that keep step (TRGO, update).
 *
 * The gates follow the compares while MOE is set, and the reset of an integrated bridge is high. It
 * is cleared by software, by a comparator (overcurrent_trip.h) or the fault output of an integrated
 * bridge, by a lockup of the core, a parity error of SRAM (if the option byte
 * SRAM_PE enables the check), a stop of the crystal or a supply of the chip below 2.9 V; set by
 * pwm_close_bridge alone.
 */
#ifndef STEADYSTEP_STM32G474_PWM_H
#define STEADYSTEP_STM32G474_PWM_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/hal.h"
#include "hal/stm32g474/board.h"
#include "hal/stm32g474/registers.h"

/* Everything but the start; gates held low. */
void pwm_configure(void);
/* Starts the counter, and returns at a peak, having seen that compares load there. */
void pwm_start(void);
/* Every peak from the next one on raises the control interrupt. */
void pwm_raise_control(void);
/* Forgets what the break input saw before the pins were connected; from here on the fault of an
   integrated bridge is followed. */
void pwm_watch_fault(void);
/* An integrated bridge says that it has shut down: MOE is clear by then, its reset follows. */
void pwm_fault_interrupt(void);

/* Break flags, latched: a comparator, or the system (lockup, memory error, crystal, supply). */
#define PWM_BREAK_FLAGS (TIM_SR_BIF | TIM_SR_SBIF)

/* Dead time: above 127 cycles it counts in twos, 64 + DTG[5:0] of them, above 254 in eights, 32 +
   DTG[4:0] of them. */
#define PWM_DEAD_TIME_CODE                                                                         \
    (DEAD_TIME_CYCLES < 128   ? DEAD_TIME_CYCLES                                                   \
     : DEAD_TIME_CYCLES < 256 ? 0x80 | (DEAD_TIME_CYCLES / 2 - 64)                                 \
                              : 0xc0 | (DEAD_TIME_CYCLES / 8 - 32))

/* What never changes in the break and dead-time register; MOE comes and goes. */
#define PWM_BDTR                                                                                   \
    (TIM_BDTR_DTG(PWM_DEAD_TIME_CODE) | TIM_BDTR_LOCK(3) | TIM_BDTR_OSSI | TIM_BDTR_OSSR |         \
     TIM_BDTR_BKE | TIM_BDTR_BKP)

/* All gates off; from anywhere. An integrated bridge first: without MOE its inputs are low, which
   alone would close the low sides. */
static inline void pwm_open_bridge(void)
{
#if BRIDGE == BRIDGE_INTEGRATED
    BRIDGE_RESET_PORT->bsrr = BIT(BRIDGE_RESET_PIN + 16);
#endif
    TIM1->bdtr = PWM_BDTR;
}

/* Duties, to load at the next peak. */
static inline void pwm_write(const uint16_t high_counts[HAL_LEGS])
{
    TIM1->ccr[CHANNEL_A_PLUS - 1] = high_counts[HAL_LEG_A_PLUS];
    TIM1->ccr[CHANNEL_A_MINUS - 1] = high_counts[HAL_LEG_A_MINUS];
    TIM1->ccr[CHANNEL_B_PLUS - 1] = high_counts[HAL_LEG_B_PLUS];
    TIM1->ccr[CHANNEL_B_MINUS - 1] = high_counts[HAL_LEG_B_MINUS];
}

/* The control interrupt has begun; whether a break is latched. */
static inline bool pwm_begin_period(void)
{
    const uint32_t flags = TIM1->sr;

    TIM1->sr = ~TIM_SR_UIF;
    return (flags & PWM_BREAK_FLAGS) != 0;
}

/* Whether a control interrupt is to follow, as a peak has come in this one. */
static inline bool pwm_peak_pending(void)
{
    return (TIM1->sr & TIM_SR_UIF) != 0;
}

static inline bool pwm_break_latched(void)
{
    return (TIM1->sr & PWM_BREAK_FLAGS) != 0;
}

/* Gates on, unless a break is latched; with the guard interrupts disabled. A break between the
   question and the write has cleared MOE before it was set: so the question is asked again. */
static inline void pwm_close_bridge(void)
{
    if (!pwm_break_latched()) {
        TIM1->bdtr = PWM_BDTR | TIM_BDTR_MOE;
#if BRIDGE == BRIDGE_INTEGRATED
        BRIDGE_RESET_PORT->bsrr = BIT(BRIDGE_RESET_PIN);
#endif
        if (pwm_break_latched()) {
            pwm_open_bridge();
        }
    }
}

static inline bool pwm_bridge_closed(void)
{
    return (TIM1->bdtr & TIM_BDTR_MOE) != 0;
}

/* A break whose cause lasts is latched again at once. */
static inline void pwm_clear_break(void)
{
    TIM1->sr = ~PWM_BREAK_FLAGS;
#if BRIDGE == BRIDGE_INTEGRATED
    TIM1->dier = TIM_DIER_UIE | TIM_DIER_BIE;
#endif
}

/* Core cycles since S(k), the last peak. */
static inline uint32_t pwm_cycles_since_peak(void)
{
    const bool down = (TIM1->cr1 & TIM_CR1_DIR) != 0;
    const uint32_t count = TIM1->cnt;

    return down ? PWM_HALF_PERIOD - count : PWM_HALF_PERIOD + count;
}

#endif
