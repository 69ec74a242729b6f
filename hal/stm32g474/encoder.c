#include "hal/stm32g474/encoder.h"

#include "hal/stm32g474/core.h"

enum { FILTER_8_SAMPLES = 3 }; /* of the timer clock: pulses below 47 ns do not count */

static int32_t count;

void encoder_configure(void)
{
    RCC->apb1enr1 |= RCC_APB1ENR1_TIM4EN;
    (void)RCC->apb1enr1;
    TIM4->psc = 0;
    TIM4->arr = 0xffff;
    TIM4->ccmr_output[0] = TIM_CCMR_CC1S(1) | TIM_CCMR_IC1F(FILTER_8_SAMPLES) | TIM_CCMR_CC2S(1) |
                           TIM_CCMR_IC2F(FILTER_8_SAMPLES);
    TIM4->smcr = TIM_SMCR_SMS(TIM_SLAVE_ENCODER_3);
    TIM4->cr1 = TIM_CR1_CEN;
}

IN_CCM(encoder_count)
int32_t encoder_count(void)
{
    count += (int16_t)(TIM4->cnt - (uint32_t)count); /* the counter is the count's lower half */
    return count;
}
