#include "hal/stm32g071/bridge.h"

#include "hal/cortex_m/interrupts.h"
#include "hal/stm32g071/handlers.h"

static struct {
    volatile uint32_t flags; /* HAL_FLAG_...: a trip until bridge_disable, a missed deadline until
                                the next sample set */
    volatile bool allowed;   /* between bridge_enable and bridge_disable, no trip */
    volatile enum {
        DEMAND_NONE,
        DEMAND_ASKED,
        DEMAND_CLOSED
    } demand;  /* for the bridge, with the duties now in force */
    bool held; /* `allowed` before bridge_hold_open */
} bridge;

void bridge_start(void)
{
    bridge_open();
    TIM1->arr = BRIDGE_HALF_PERIOD_COUNTS;
    TIM1->ccmr1 =
        TIM_CCMR_OC1M(TIM_PWM_1) | TIM_CCMR_OC1PE | TIM_CCMR_OC2M(TIM_PWM_1) | TIM_CCMR_OC2PE;
    TIM1->ccmr2 = TIM1->ccmr1;
    TIM1->ccer = TIM_CCER_CC1E | TIM_CCER_CC2E | TIM_CCER_CC3E | TIM_CCER_CC4E;
    TIM1->af1 = TIM_AF1_BKINE;
    TIM1->cr2 = TIM_CR2_MMS(TIM_MASTER_ENABLE);
    TIM1->cr1 = TIM_CR1_CMS(TIM_CENTRE_ALIGNED_1) | TIM_CR1_ARPE | TIM_CR1_URS;

    /* A halt by the debugger stops the counter and with it holds the outputs low (RM0444, TIM1 in
       debug mode). TIM2 runs on: when the core does again, the deadline is over and opens the
       bridge. TIM3 keeps step. */
    DBG->apbfz2 |= DBG_APBFZ2_TIM1;
    DBG->apbfz1 |= DBG_APBFZ1_TIM3;
}

/*
 * Compares are to load at every second event of the counter, at its peaks. With an odd repetition
 * count that is a matter of the beginning: launched with count 0, the first event, a peak, loads
 * them and takes over count 1. Whether it is so is measured, with the bridge off.
 */
bool bridge_run(void)
{
    TIM1->rcr = 0;
    TIM1->egr = TIM_EGR_UG;
    TIM1->sr = 0;
    TIM1->cr1 |= TIM_CR1_CEN;
    TIM1->rcr = 1;
    for (int event = 0; event < 3; event++) {
        for (int tries = 0; (TIM1->sr & TIM_SR_UIF) == 0; tries++) {
            if (tries > 100000) {
                return false;
            }
        }
        if ((TIM1->cr1 & TIM_CR1_DIR) == 0) {
            return false;
        }
        TIM1->sr = ~TIM_SR_UIF;
    }
    TIM1->sr = 0; /* FAULT read low before its pin was connected */
    TIM1->dier = TIM_DIER_BIE;
    interrupt_enable(TIM1_BRK_UP_TRG_COM_IRQn, PRIORITY_GUARD);
    return true;
}

/* Both timers count core cycles. */
static inline uint32_t deadline_of_next_peak(void)
{
    const uint32_t now = TIM2->cnt;
    const bool down = (TIM1->cr1 & TIM_CR1_DIR) != 0;
    const uint32_t count = TIM1->cnt;
    const uint32_t since_peak =
        down ? BRIDGE_HALF_PERIOD_COUNTS - count : BRIDGE_HALF_PERIOD_COUNTS + count;

    return now - since_peak + BRIDGE_PERIOD_COUNTS + BRIDGE_DEADLINE_COUNTS;
}

void bridge_guard_start(void)
{
    TIM2->ccr1 = deadline_of_next_peak();
    TIM2->sr = 0;
    TIM2->dier = TIM_DIER_CC1IE;
    interrupt_enable(TIM2_IRQn, PRIORITY_GUARD);
}

bool bridge_enable(void)
{
    if ((bridge.flags & HAL_FLAG_OVERCURRENT_TRIP) != 0 || (TIM1->sr & TIM_SR_BIF) != 0) {
        return false;
    }
    bridge.allowed = true;
    if ((bridge.flags & HAL_FLAG_OVERCURRENT_TRIP) != 0) { /* in between */
        bridge.allowed = false;
    }
    return bridge.allowed;
}

void bridge_disable(void)
{
    bridge.allowed = false;
    bridge_open();
    bridge.demand = DEMAND_NONE;
    if ((bridge.flags & HAL_FLAG_OVERCURRENT_TRIP) != 0) {
        TIM1->sr = ~TIM_SR_BIF; /* RESET is low now, which ends the bridge's own fault */
        if ((TIM1->sr & TIM_SR_BIF) == 0) {
            bridge.flags = 0; /* no interrupt writes them: its request is not enabled */
            TIM1->dier = TIM_DIER_BIE;
        }
    }
}

static bool on_or_asked(void)
{
    return bridge.demand != DEMAND_NONE || (TIM1->bdtr & TIM_BDTR_MOE) != 0;
}

bool bridge_hold_open(void)
{
    if (on_or_asked()) {
        return false;
    }
    bridge.held = bridge.allowed;
    bridge.allowed = false;
    if (on_or_asked()) { /* in between */
        bridge.allowed = bridge.held;
        return false;
    }
    return true;
}

/* Deadlines that passed meanwhile are reported with the samples, a trip still forbids. */
void bridge_release(void)
{
    bridge.allowed = bridge.held;
    if ((bridge.flags & HAL_FLAG_OVERCURRENT_TRIP) != 0) {
        bridge.allowed = false;
    }
}

uint32_t bridge_begin_period(void)
{
    const uint32_t flags = bridge.flags;

    if (flags != 0) {
        __disable_irq(); /* FAULT may come in between */
        bridge.flags &= HAL_FLAG_OVERCURRENT_TRIP;
        __enable_irq();
    }
    return flags;
}

void bridge_end_period(const struct hal_outputs *outputs)
{
    TIM1_COMPARE(CHANNEL_A_PLUS) = outputs->high_counts[HAL_LEG_A_PLUS];
    TIM1_COMPARE(CHANNEL_A_MINUS) = outputs->high_counts[HAL_LEG_A_MINUS];
    TIM1_COMPARE(CHANNEL_B_PLUS) = outputs->high_counts[HAL_LEG_B_PLUS];
    TIM1_COMPARE(CHANNEL_B_MINUS) = outputs->high_counts[HAL_LEG_B_MINUS];
    if (!outputs->bridge_on || !bridge.allowed) {
        bridge_open();
        bridge.demand = DEMAND_NONE;
    } else if (bridge.demand == DEMAND_NONE) {
        bridge.demand = DEMAND_ASKED;
    } else if (bridge.demand == DEMAND_ASKED) {
        bridge.demand = DEMAND_CLOSED;
        TIM1->bdtr = BRIDGE_ON;
        BRIDGE_RESET_PORT->bsrr = BIT(BRIDGE_RESET_PIN);
        if (!bridge.allowed) { /* FAULT or the deadline came in between */
            bridge_open();
        }
    }
}

void bridge_deadline_met(uint32_t now)
{
    const uint32_t deadline = TIM2->ccr1 + BRIDGE_PERIOD_COUNTS;

    /* Behind periods without an interrupt it is found anew. */
    TIM2->ccr1 = (int32_t)(deadline - now) > 0 ? deadline : deadline_of_next_peak();
}

/* FAULT: the hardware has taken away the main output already. Its level keeps the request up. */
IN_RAM(break_interrupt) void tim1_brk_up_trg_com_handler(void)
{
    bridge_open();
    bridge.allowed = false;
    bridge.demand = DEMAND_NONE;
    bridge.flags |= HAL_FLAG_OVERCURRENT_TRIP;
    TIM1->dier = 0;
}

/* The control interrupt has not ended in time, or has not come. */
IN_RAM(deadline_interrupt) void tim2_handler(void)
{
    bridge_open();
    bridge.allowed = false;
    bridge.demand = DEMAND_NONE;
    bridge.flags |= HAL_FLAG_DEADLINE_MISSED;
    TIM2->sr = ~TIM_SR_CC1IF;
}
