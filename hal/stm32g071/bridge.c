#include "hal/stm32g071/bridge.h"

#include "hal/stm32g071/core.h"

static struct {
    volatile uint32_t flags; /* HAL_FLAG_...: a trip until bridge_disable, a missed deadline until
                                the next sample set */
    volatile bool allowed;   /* between bridge_enable and bridge_disable, no trip */
    bool asked;              /* for the bridge, with the duties now in force */
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

    TIM14->arr = BRIDGE_GUARD_COUNTS - 1;
    TIM14->cr1 = TIM_CR1_URS | TIM_CR1_OPM;
    TIM14->egr = TIM_EGR_UG;
    TIM14->dier = TIM_DIER_UIE;
    interrupt_enable(INTERRUPT_TIM14, PRIORITY_GUARD);
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
    interrupt_enable(INTERRUPT_TIM1_BRK_UP_TRG_COM, PRIORITY_GUARD);
    return true;
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
    if ((bridge.flags & HAL_FLAG_OVERCURRENT_TRIP) != 0) {
        TIM1->sr = ~TIM_SR_BIF; /* RESET is low now, which ends the bridge's own fault */
        if ((TIM1->sr & TIM_SR_BIF) == 0) {
            bridge.flags = 0; /* no interrupt writes them: its request is not enabled */
            TIM1->dier = TIM_DIER_BIE;
        }
    }
}

bool bridge_is_on(void)
{
    return (TIM1->bdtr & TIM_BDTR_MOE) != 0;
}

uint32_t bridge_begin_period(void)
{
    const uint32_t flags = bridge.flags;

    TIM14->cnt = 0;
    TIM14->cr1 = TIM_CR1_URS | TIM_CR1_OPM | TIM_CR1_CEN;
    if (flags != 0) {
        interrupts_disable(); /* FAULT may come in between */
        bridge.flags &= HAL_FLAG_OVERCURRENT_TRIP;
        interrupts_enable();
    }
    return flags;
}

void bridge_end_period(const struct hal_outputs *outputs)
{
    TIM1->ccr1 = outputs->high_counts[HAL_LEG_A_PLUS];
    TIM1->ccr2 = outputs->high_counts[HAL_LEG_A_MINUS];
    TIM1->ccr3 = outputs->high_counts[HAL_LEG_B_PLUS];
    TIM1->ccr4 = outputs->high_counts[HAL_LEG_B_MINUS];
    TIM14->cr1 = TIM_CR1_URS | TIM_CR1_OPM;
    if (!outputs->bridge_on || !bridge.allowed) {
        bridge_open();
        bridge.asked = false;
    } else if (!bridge.asked) {
        bridge.asked = true;
    } else {
        TIM1->bdtr = BRIDGE_ON;
        BRIDGE_RESET_PORT->bsrr = BIT(BRIDGE_RESET_PIN);
        if (!bridge.allowed) { /* FAULT came in between */
            bridge_open();
        }
    }
}

/* FAULT: the hardware has taken away the main output already. Its level keeps the request up. */
IN_RAM(break_interrupt) void tim1_brk_up_trg_com_handler(void)
{
    bridge_open();
    bridge.allowed = false;
    bridge.flags |= HAL_FLAG_OVERCURRENT_TRIP;
    TIM1->dier = 0;
}

/* The control interrupt has not ended in time. */
IN_RAM(deadline_interrupt) void tim14_handler(void)
{
    bridge_open();
    bridge.allowed = false;
    bridge.flags |= HAL_FLAG_DEADLINE_MISSED;
    TIM14->sr = 0;
}
