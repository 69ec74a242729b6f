#include "hal/stm32g474/encoder.h"

#include "hal/stm32g474/board.h"
#include "hal/stm32g474/device.h"
#include "hal/stm32g474/registers.h"

#if ENCODER_TIMER != 0

#define TIMER PERIPHERAL(TIM, ENCODER_TIMER)

enum { FILTER_8_SAMPLES = 3 }; /* of the timer clock: pulses below 47 ns do not count */

static int32_t count;

void encoder_configure(void)
{
#if ENCODER_TIMER == 8
    RCC->apb2enr |= RCC_APB2ENR_TIM8EN;
    (void)RCC->apb2enr;
#else
    RCC->apb1enr1 |= ENCODER_TIMER == 4 ? RCC_APB1ENR1_TIM4EN : RCC_APB1ENR1_TIM5EN;
    (void)RCC->apb1enr1;
#endif
    TIMER->psc = 0;
    TIMER->arr = 0xffff;
    TIMER->ccmr_output[0] = TIM_CCMR_CC1S(1) | TIM_CCMR_IC1F(FILTER_8_SAMPLES) | TIM_CCMR_CC2S(1) |
                            TIM_CCMR_IC2F(FILTER_8_SAMPLES);
    TIMER->smcr = TIM_SMCR_SMS(TIM_SLAVE_ENCODER_3);
    TIMER->cr1 = TIM_CR1_CEN;
}

IN_CCM(encoder_count)
int32_t encoder_count(void)
{
    count += (int16_t)(TIMER->cnt - (uint32_t)count); /* the counter is the count's lower half */
    return count;
}

#else

void encoder_configure(void)
{
}

IN_CCM(encoder_count)
int32_t encoder_count(void)
{
    return 0;
}

#endif
