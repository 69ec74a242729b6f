#include "hal/stm32g474/encoder.h"

#include "hal/cortex_m/port.h"
#include "hal/stm32g474/control_interrupt.h"
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
#if ENCODER_INDEX_CHANNEL != 0
    ENCODER->ccmr_output[1] = ENCODER_INDEX_CHANNEL == 3
                                  ? TIM_CCMR_CC1S(1) | TIM_CCMR_IC1F(FILTER_8_SAMPLES)
                                  : TIM_CCMR_CC2S(1) | TIM_CCMR_IC2F(FILTER_8_SAMPLES);
#endif
    ENCODER->smcr = TIM_SMCR_SMS(TIM_SLAVE_ENCODER_3);
    ENCODER->cr1 = TIM_CR1_CEN;
}

#else

void encoder_configure(void)
{
}

#endif

#if ENCODER_INDEX_CHANNEL != 0

enum {
    INDEX = ENCODER_INDEX_CHANNEL - 1,
    INDEX_ON = TIM_CCER_CC1E << 4 * INDEX,
    INDEX_FALLING = TIM_CCER_CC1P << 4 * INDEX,
    INDEX_CAPTURED = TIM_SR_CC1IF << INDEX
};

/* The edge is chosen while nothing is captured. The last control interrupt's count is 32,767 counts
   from a passage at most. */
bool port_encoder_index(enum hal_index ask, int32_t *count)
{
    if (ask != HAL_INDEX_PASSED) {
        const uint32_t edge = ask == HAL_INDEX_RISES ? 0u : (uint32_t)INDEX_FALLING;

        ENCODER->ccer = edge;
        ENCODER->sr = ~(uint32_t)INDEX_CAPTURED;
        ENCODER->ccer = edge | INDEX_ON;
        return false;
    }
    if ((ENCODER->sr & INDEX_CAPTURED) == 0u) {
        return false;
    }
    const int32_t near = control_encoder_count();

    *count = near + (int16_t)(ENCODER->ccr[INDEX] - (uint32_t)near); /* forgets that it passed */
    return true;
}

#else

bool port_encoder_index(enum hal_index ask, int32_t *count)
{
    (void)ask;
    *count = 0;
    return false;
}

#endif
