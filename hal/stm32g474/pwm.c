#include "hal/stm32g474/pwm.h"

#include "hal/stm32g474/crash.h"
#include "hal/stm32g474/wait.h"

enum { UPDATE_WAIT = 2 * PWM_PERIOD }; /* passes: more than eight periods */

void pwm_configure(void)
{
    RCC->apb2enr |= RCC_APB2ENR_TIM1EN | RCC_APB2ENR_SYSCFGEN;
    (void)RCC->apb2enr;
    SYSCFG->cfgr2 |= SYSCFG_CFGR2_CLL | SYSCFG_CFGR2_SPL | SYSCFG_CFGR2_ECCL;

    TIM1->cr1 = TIM_CR1_CMS(TIM_CENTRE_ALIGNED_1) | TIM_CR1_ARPE;
    TIM1->psc = 0;
    TIM1->arr = PWM_HALF_PERIOD;

    for (int pair = 0; pair < 2; pair++) {
        TIM1->ccmr_output[pair] = TIM_CCMR_OC1M(TIM_PWM_MODE_1) | TIM_CCMR_OC1PE |
                                  TIM_CCMR_OC2M(TIM_PWM_MODE_1) | TIM_CCMR_OC2PE;
    }
    /* Channel 5 rises in the count before the peak: it starts the injected conversions. */
    TIM1->ccmr3 = TIM_CCMR3_OC5M(TIM_PWM_MODE_2);
    TIM1->ccr5 = PWM_HALF_PERIOD - 1;
    TIM1->cr2 = TIM_CR2_MMS(TIM_TRGO_UPDATE) | TIM_CR2_MMS2(TIM_TRGO2_OC5REF); /* idle: all low */
    TIM1->ccer = TIM_CCER_CC1E | TIM_CCER_CC1NE | TIM_CCER_CC2E | TIM_CCER_CC2NE | TIM_CCER_CC3E |
                 TIM_CCER_CC3NE | TIM_CCER_CC4E | TIM_CCER_CC4NE;

    /* The comparators, not the pin; active high, without filter, so without clock and at once. */
    TIM1->af1 = TIM_AF1_BKCMP1E | TIM_AF1_BKCMP2E | TIM_AF1_BKCMP3E | TIM_AF1_BKCMP4E;
    TIM1->bdtr = PWM_BDTR;

    /*
     * The repetition counter lets every second extreme of the count load the compares. It is filled
     * by an update: with 0 here, so that the first peak is one, and there with 1, so that of the
     * following only the peaks are.
     */
    TIM1->rcr = 0;
    TIM1->egr = TIM_EGR_UG;
    TIM1->rcr = 1;
    TIM1->sr = 0;
}

/* The next update, and that the count was at its peak. */
static void see_update_at_peak(void)
{
    TIM1->sr = ~TIM_SR_UIF;
    if (!wait_until(&TIM1->sr, TIM_SR_UIF, TIM_SR_UIF, UPDATE_WAIT)) {
        board_fault(BOARD_FAULT_PWM_UPDATE);
    }
    if (TIM1->cnt < PWM_HALF_PERIOD / 2) {
        board_fault(BOARD_FAULT_PWM_PHASE);
    }
}

void pwm_start(void)
{
    TIM1->cr1 |= TIM_CR1_CEN;
    see_update_at_peak();
    see_update_at_peak();
}
