#include "hal/stm32g474/phase_voltage_sampling.h"

#include "hal/stm32g474/adc.h"
#include "hal/stm32g474/board.h"
#include "hal/stm32g474/deadline_guard.h"
#include "hal/stm32g474/dma.h"

enum {
    LEGS_OF_PHASE = 2,
    HALF = LEG_GROUPS * LEGS_OF_PHASE, /* sums in a period */
    /* Cycles from the peak to the first group of a period. A group takes 2 x 8 x 15 ADC clocks, 960
       cycles, and a few to start: the last of the period ends before the next peak. */
    FIRST_GROUP = 8,
    /* What is added up in a period: 17 groups x 8 conversions; codes of a phase are twice those of
       a leg. */
    DIVISOR = 2 * LEG_GROUPS * LEG_OVERSAMPLING,
    OFFSET_CODES = 4096, /* keeps the division away from negative numbers */
};

/* Of two periods; DMA stores the sums of the legs + and - in turn. */
struct phase {
    uint32_t groups[2 * LEG_GROUPS]; /* leg + in the lower half word, - in the upper */
};

_Static_assert(LEG_OVERSAMPLING * 4095 <= INT16_MAX, "sums are added up as signed half words");

#define ADC_A PERIPHERAL(ADC, LEGS_A_CONVERTER)
#define ADC_B PERIPHERAL(ADC, LEGS_B_CONVERTER)

DMA_BUFFER static struct phase phase_a, phase_b;
static uint32_t last_done = UINT32_MAX; /* half of the period before; none at first */

static void start_converter(struct adc_registers *adc, uint32_t plus, uint32_t minus)
{
    adc_power_up(adc);
    adc->smpr = 0; /* ADC_SAMPLE_2_5 of all channels */
    adc->smpr2 = 0;
    adc->sqr1 = ADC_SQR1_L(LEGS_OF_PHASE - 1) | ADC_SQR1_SQ1(plus) | ADC_SQR1_SQ2(minus);
    adc->cfgr2 = ADC_CFGR2_ROVSE | ADC_CFGR2_OVSR(ADC_OVERSAMPLE_8) | ADC_CFGR2_OVSS(0);
    adc->cfgr = ADC_CFGR_DMAEN | ADC_CFGR_DMACFG | ADC_CFGR_EXTSEL(ADC_TRIGGER_TIM3_TRGO) |
                ADC_CFGR_EXTEN(ADC_TRIGGER_RISING) | ADC_CFGR_JQDIS;
    adc->cr = ADC_CR_ADVREGEN | ADC_CR_ADSTART;
}

static void start_transfer(uint32_t channel, uint32_t request, struct adc_registers *adc,
                           struct phase *phase)
{
    dma_start(channel, request, &adc->dr, phase->groups, 2 * HALF,
              DMA_CR_CIRC | DMA_CR_MINC | DMA_CR_PSIZE(DMA_HALF_WORD) |
                  DMA_CR_MSIZE(DMA_HALF_WORD) | DMA_CR_PL(DMA_PRIORITY_VERY_HIGH));
}

/* Waits for the PWM timer's first update, then gives 17 updates in each of its periods. */
static void prepare_trigger(void)
{
    RCC->apb1enr1 |= RCC_APB1ENR1_TIM3EN;
    (void)RCC->apb1enr1;
    TIM3->psc = 0;
    TIM3->arr = LEG_GROUP_CYCLES - 1;
    TIM3->egr = TIM_EGR_UG;
    TIM3->cnt = LEG_GROUP_CYCLES - FIRST_GROUP;
    TIM3->sr = 0;
    TIM3->cr2 = TIM_CR2_MMS(TIM_TRGO_UPDATE);
    TIM3->smcr = TIM_SMCR_TS(TIM_TRIGGER_TIM1_TRGO) | TIM_SMCR_SMS(TIM_SLAVE_TRIGGER);
}

void phase_voltage_sampling_configure(void)
{
    prepare_trigger();
    start_transfer(DMA_LEGS_A, PERIPHERAL(DMAMUX_ADC, LEGS_A_CONVERTER), ADC_A, &phase_a);
    start_transfer(DMA_LEGS_B, PERIPHERAL(DMAMUX_ADC, LEGS_B_CONVERTER), ADC_B, &phase_b);
    adc_clock(ADC345_COMMON, RCC_AHB2ENR_ADC345EN);
    start_converter(ADC_A, LEG_A_PLUS_CHANNEL, LEG_A_MINUS_CHANNEL);
    start_converter(ADC_B, LEG_B_PLUS_CHANNEL, LEG_B_MINUS_CHANNEL);
}

/* To the nearest code, ties upwards. A sum has 15 bits. */
static inline int16_t mean(const uint32_t *groups)
{
    const uint32_t once_each = 0x00010001;
    uint32_t difference = DIVISOR * OFFSET_CODES + DIVISOR / 2;

#pragma GCC unroll LEG_GROUPS
    for (int group = 0; group < LEG_GROUPS; group++) {
        difference = __SMLSD(groups[group], once_each, difference);
    }
    return (int16_t)((int32_t)(difference / DIVISOR) - OFFSET_CODES);
}

/*
 * Whether as many sums as belong there at this time, give or take two, lie in the half that is
 * being filled: a lost trigger or transfer shifts all that follow.
 */
static inline bool in_step(uint32_t stored, uint32_t done, uint32_t since_peak)
{
    const uint32_t in_half = stored - (HALF - done);
    const uint32_t expected = since_peak / (LEG_GROUP_CYCLES / LEGS_OF_PHASE);

    return in_half + 2u - expected <= 4u;
}

IN_CCM(phase_voltage_sampling_read)
bool phase_voltage_sampling_read(struct hal_samples *samples, uint32_t since_peak)
{
    const uint32_t stored_a = 2 * HALF - dma_remaining(DMA_LEGS_A);
    const uint32_t stored_b = 2 * HALF - dma_remaining(DMA_LEGS_B);
    /* The half that is being filled, and with it the other, holds until the next peak. */
    const uint32_t done = stored_a < HALF ? HALF : 0;
    /* A period without a control interrupt is told as a missed deadline. */
    const bool other_half = done != last_done || deadline_guard_has_missed();

    last_done = done;
    samples->phase_voltage_a = mean(&phase_a.groups[done / LEGS_OF_PHASE]);
    samples->phase_voltage_b = mean(&phase_b.groups[done / LEGS_OF_PHASE]);
    return other_half && (stored_a < HALF) == (stored_b < HALF) &&
           in_step(stored_a, done, since_peak) && in_step(stored_b, done, since_peak) &&
           ((ADC_A->isr | ADC_B->isr) & ADC_ISR_OVR) == 0;
}
