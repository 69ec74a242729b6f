#include "hal/stm32g474/encoder.h"

#include "hal/stm32g474/device.h"

#if ENCODER_TIMER != 0

enum { FILTER_8_SAMPLES = 3 }; /* of the timer clock: pulses below 47 ns do not count */

void encoder_configure(void)
{
#if ENCODER_TIMER == 8
    RCC->apb2enr |= RCC_APB2ENR_TIM8EN;
    (void)RCC->apb2enr;
#else
    RCC->apb1enr1 |= ENCODER_TIMER == 4 ? RCC_APB1ENR1_TIM4EN : RCC_APB1ENR1_TIM5EN;
    (void)RCC->apb1enr1;
#endif
    ENCODER->psc = 0;
    ENCODER->arr = 0xffff;
    ENCODER->ccmr_output[0] = TIM_CCMR_CC1S(1) | TIM_CCMR_IC1F(FILTER_8_SAMPLES) |
                              TIM_CCMR_CC2S(1) | TIM_CCMR_IC2F(FILTER_8_SAMPLES);
    ENCODER->smcr = TIM_SMCR_SMS(TIM_SLAVE_ENCODER_3);
    ENCODER->cr1 = TIM_CR1_CEN;
}

#else

void encoder_configure(void)
{
}

#endif
