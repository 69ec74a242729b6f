#include "hal/stm32g474/deadline_guard.h"

#include "hal/cortex_m/interrupts.h"
#include "hal/stm32g474/pwm.h"

static volatile bool missed;

void deadline_guard_configure(void)
{
    RCC->apb1enr1 |= RCC_APB1ENR1_TIM2EN;
    (void)RCC->apb1enr1;
    TIM2->psc = 0;
    TIM2->arr = 0xffffffffu;
    TIM2->egr = TIM_EGR_UG;
    TIM2->sr = 0;
    TIM2->smcr = TIM_SMCR_TS(TIM_TRIGGER_TIM1_TRGO) | TIM_SMCR_SMS(TIM_SLAVE_TRIGGER);
}

void deadline_guard_start(void)
{
    const uint32_t count = TIM2->cnt;

    TIM2->ccr[0] = count - count % PWM_PERIOD + PWM_PERIOD + DEADLINE_CYCLES;
    TIM2->sr = 0;
    TIM2->dier = TIM_DIER_CC1IE;
    interrupt_enable(TIM2_IRQn, PRIORITY_GUARD);
}

IN_CCM(deadline_guard_interrupt)
void deadline_guard_interrupt(void)
{
    pwm_open_bridge();
    TIM2->sr = ~TIM_SR_CC1IF;
    missed = true;
    __DSB(); /* the flag is down before the interrupt ends */
}

IN_CCM(deadline_guard_take_missed)
bool deadline_guard_take_missed(void)
{
    if (!missed) {
        return false;
    }
    missed = false;
    return true;
}

IN_CCM(deadline_guard_has_missed)
bool deadline_guard_has_missed(void)
{
    return missed;
}
