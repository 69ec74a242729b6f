#include "hal/stm32g474/deadline_guard.h"

#include "hal/cortex_m/interrupts.h"
#include "hal/stm32g474/pwm.h"

struct deadline_guard deadline_guard;

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

    deadline_guard.deadline = count - count % PWM_PERIOD + PWM_PERIOD + DEADLINE_CYCLES;
    TIM2->ccr[0] = deadline_guard.deadline;
    TIM2->sr = 0;
    TIM2->dier = TIM_DIER_CC1IE;
    interrupt_enable(TIM2_IRQn, PRIORITY_GUARD);
}

IN_CCM(deadline_guard_interrupt)
void deadline_guard_interrupt(void)
{
    pwm_open_bridge();
    TIM2->sr = ~TIM_SR_CC1IF;
    deadline_guard.missed = true;
    deadline_guard.out_of_step = true;
    __DSB(); /* the flag is down before the interrupt ends */
}

/*
 * Behind an interrupt that ended too late, did not come, or a halt in which TIM2 alone went on. A
 * peak that has come meanwhile has its interrupt still before it, which has to end in time.
 */
IN_CCM(deadline_guard_find_step)
void deadline_guard_find_step(void)
{
    const uint32_t since_peak = pwm_cycles_since_peak();
    const uint32_t peak = TIM2->cnt - since_peak;
    const bool follows = pwm_peak_pending();
    const bool in_time = since_peak < DEADLINE_CYCLES;

    deadline_guard.out_of_step = follows && !in_time;
    deadline_guard.deadline = peak + (follows && in_time ? 0 : PWM_PERIOD) + DEADLINE_CYCLES;
    TIM2->ccr[0] = deadline_guard.deadline;
}
