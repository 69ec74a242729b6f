#include "hal/stm32g474/pwm.h"

#include "hal/cortex_m/crash.h"
#include "hal/cortex_m/interrupts.h"
#include "hal/cortex_m/wait.h"

enum { UPDATE_WAIT = 2 * PWM_PERIOD }; /* passes: more than eight periods */

#define HIGH_SIDES (TIM_CCER_CC1E | TIM_CCER_CC2E | TIM_CCER_CC3E | TIM_CCER_CC4E)
#define LOW_SIDES  (TIM_CCER_CC1NE | TIM_CCER_CC2NE | TIM_CCER_CC3NE | TIM_CCER_CC4NE)

#define HIGH_SIDES_INVERTED (TIM_CCER_CC1P | TIM_CCER_CC2P | TIM_CCER_CC3P | TIM_CCER_CC4P)
#define LOW_SIDES_INVERTED  (TIM_CCER_CC1NP | TIM_CCER_CC2NP | TIM_CCER_CC3NP | TIM_CCER_CC4NP)
#define POLARITY                                                                                   \
    ((HIGH_GATES_ACTIVE_LOW ? HIGH_SIDES_INVERTED : 0) |                                           \
     (LOW_GATES_ACTIVE_LOW ? LOW_SIDES_INVERTED : 0))

/* Levels of the pins while the bridge is open: every gate off. */
#define HIGH_SIDES_IDLE (TIM_CR2_OIS1 | TIM_CR2_OIS2 | TIM_CR2_OIS3 | TIM_CR2_OIS4)
#define LOW_SIDES_IDLE  (TIM_CR2_OIS1N | TIM_CR2_OIS2N | TIM_CR2_OIS3N | TIM_CR2_OIS4N)
#define IDLE                                                                                       \
    ((HIGH_GATES_ACTIVE_LOW ? HIGH_SIDES_IDLE : 0) | (LOW_GATES_ACTIVE_LOW ? LOW_SIDES_IDLE : 0))

#define BREAK_BY_COMPARATOR(number, input) | TIM_AF1_BKCMP##number##E

void pwm_configure(void)
{
    RCC->apb2enr |= RCC_APB2ENR_TIM1EN | RCC_APB2ENR_SYSCFGEN;
    (void)RCC->apb2enr;
    /* Not ECCL: a double error of the flash is the NMI's, which opens the bridge but for the store.
     */
    SYSCFG->cfgr2 |= SYSCFG_CFGR2_CLL | SYSCFG_CFGR2_SPL | SYSCFG_CFGR2_PVDL;

    TIM1->cr1 = TIM_CR1_CMS(TIM_CENTRE_ALIGNED_1) | TIM_CR1_ARPE;
    TIM1->psc = 0;
    TIM1->arr = PWM_HALF_PERIOD;

    for (int pair = 0; pair < 2; pair++) {
        TIM1->ccmr_output[pair] = TIM_CCMR_OC1M(TIM_PWM_MODE_1) | TIM_CCMR_OC1PE |
                                  TIM_CCMR_OC2M(TIM_PWM_MODE_1) | TIM_CCMR_OC2PE;
    }
    /* Channel 5 rises ahead of the peak: it starts the injected conversions. */
    TIM1->ccmr3 = TIM_CCMR3_OC5M(TIM_PWM_MODE_2);
    TIM1->ccr5 = PWM_HALF_PERIOD - CURRENT_SAMPLING_LEAD;
    TIM1->cr2 = TIM_CR2_MMS(TIM_TRGO_UPDATE) | TIM_CR2_MMS2(TIM_TRGO2_OC5REF) | IDLE;
    TIM1->ccer = HIGH_SIDES | (BRIDGE == BRIDGE_OF_GATES ? LOW_SIDES : 0) | POLARITY;

    /* Active high, without filter, so without clock and at once; the fault output is low. */
    TIM1->af1 = (0 OVERCURRENT_COMPARATORS(BREAK_BY_COMPARATOR)) |
                (BRIDGE == BRIDGE_INTEGRATED ? TIM_AF1_BKINE | TIM_AF1_BKINP : 0);
    pwm_open_bridge();

    /*
     * A halt by the debugger stops the counter and with it, as OSSI is set, holds the gates low
     * (RM0440, TIM1 in debug mode). TIM2 runs on: when the core does again, the deadline is over
     * and opens the bridge. TIM3 keeps step.
     */
    DBGMCU->apb2fzr |= DBGMCU_APB2FZR_TIM1;
    DBGMCU->apb1lfzr |= DBGMCU_APB1LFZR_TIM3;

    TIM1->rcr = 0; /* see pwm_start */
    TIM1->egr = TIM_EGR_UG;
    TIM1->sr = 0;
    TIM1->dier = TIM_DIER_UIE; /* the line is enabled by pwm_raise_control */
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
    const uint32_t primask = interrupts_save_and_disable();

    /*
     * The repetition counter lets every second extreme of the count load the compares. An update
     * fills it from RCR: that of UG with 0, so the first extreme, a peak, is an update, and fills
     * it with 1, so that of the following only the peaks are. RCR is written once the counter runs:
     * whether a write fills the repetition counter while it stands, RM0440 leaves open.
     */
    TIM1->cr1 |= TIM_CR1_CEN;
    TIM1->rcr = 1;
    interrupts_restore(primask);
    see_update_at_peak();
    see_update_at_peak();
}

void pwm_raise_control(void)
{
    TIM1->sr = ~TIM_SR_UIF;
    interrupt_enable(TIM1_UP_TIM16_IRQn, PRIORITY_CONTROL);
}

#if BRIDGE == BRIDGE_INTEGRATED

void pwm_watch_fault(void)
{
    pwm_clear_break(); /* the fault output read low before its pin was connected */
    interrupt_enable(TIM1_BRK_TIM15_IRQn, PRIORITY_GUARD);
}

IN_CCM(pwm_fault_interrupt)
void pwm_fault_interrupt(void)
{
    pwm_open_bridge();
    TIM1->dier = TIM_DIER_UIE;
    __DSB(); /* the request is down before the interrupt ends */
}

#else

void pwm_watch_fault(void)
{
    pwm_clear_break();
}

#endif
