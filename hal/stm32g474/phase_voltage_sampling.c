#include "hal/stm32g474/phase_voltage_sampling.h"

#include "hal/stm32g474/adc.h"
#include "hal/stm32g474/deadline_guard.h"
#include "hal/stm32g474/pwm.h"

/* Cycles from the peak to the first group of a period. A group of 8 takes 2 x 8 x 15 ADC clocks,
   960 cycles, and a few to start: the last of the period ends before the next peak. */
enum { FIRST_GROUP = 8 };

DMA_BUFFER uint32_t leg_sums[2][2 * LEG_GROUPS];
uint32_t leg_transfers_due;

_Static_assert(LEG_OVERSAMPLING * 4095 <= INT16_MAX, "sums are added up as signed half words");

#define OVERSAMPLE (LEG_OVERSAMPLING == 8 ? ADC_OVERSAMPLE_8 : ADC_OVERSAMPLE_4)

#define ADC_A PERIPHERAL(ADC, LEGS_A_CONVERTER)
#define ADC_B PERIPHERAL(ADC, LEGS_B_CONVERTER)

static void start_converter(struct adc_registers *adc, uint32_t plus, uint32_t minus)
{
    adc_power_up(adc);
    adc->smpr = 0; /* ADC_SAMPLE_2_5 of all channels */
    adc->smpr2 = 0;
    adc->sqr1 = ADC_SQR1_L(LEGS_OF_PHASE - 1) | ADC_SQR1_SQ1(plus) | ADC_SQR1_SQ2(minus);
    adc->cfgr2 = ADC_CFGR2_ROVSE | ADC_CFGR2_OVSR(OVERSAMPLE) | ADC_CFGR2_OVSS(0);
    adc->cfgr = ADC_CFGR_DMAEN | ADC_CFGR_DMACFG | ADC_CFGR_EXTSEL(ADC_TRIGGER_TIM3_TRGO) |
                ADC_CFGR_EXTEN(ADC_TRIGGER_RISING) | ADC_CFGR_JQDIS;
    adc->cr = ADC_CR_ADVREGEN | ADC_CR_ADSTART;
}

static void start_transfer(uint32_t channel, uint32_t request, struct adc_registers *adc,
                           uint32_t *sums)
{
    dma_start(channel, request, &adc->dr, sums, 2 * LEG_SUMS,
              DMA_CR_CIRC | DMA_CR_MINC | DMA_CR_PSIZE(DMA_HALF_WORD) |
                  DMA_CR_MSIZE(DMA_HALF_WORD) | DMA_CR_PL(DMA_PRIORITY_VERY_HIGH));
}

/* Waits for the PWM timer's first update, then gives LEG_GROUPS updates in each of its periods. */
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
    start_transfer(DMA_LEGS_A, PERIPHERAL(DMAMUX_ADC, LEGS_A_CONVERTER), ADC_A, leg_sums[0]);
    start_transfer(DMA_LEGS_B, PERIPHERAL(DMAMUX_ADC, LEGS_B_CONVERTER), ADC_B, leg_sums[1]);
    adc_clock(ADC345_COMMON, RCC_AHB2ENR_ADC345EN);
    start_converter(ADC_A, LEG_A_PLUS_CHANNEL, LEG_A_MINUS_CHANNEL);
    start_converter(ADC_B, LEG_B_PLUS_CHANNEL, LEG_B_MINUS_CHANNEL);
}

/*
 * Whether as many sums as belong there at this time, give or take two, lie in the half that is
 * being filled: a lost trigger or transfer shifts all that follow.
 */
static bool in_step(uint32_t left, uint32_t since_peak)
{
    const uint32_t in_half = (2 * LEG_SUMS - left) % LEG_SUMS;
    const uint32_t expected = since_peak / (LEG_GROUP_CYCLES / LEGS_OF_PHASE);

    return in_half + 2u - expected <= 4u;
}

IN_CCM(phase_voltage_sampling_in_step)
bool phase_voltage_sampling_in_step(uint32_t left_a, uint32_t left_b)
{
    const uint32_t since_peak = pwm_cycles_since_peak();
    const bool second_half = left_a > LEG_SUMS;
    const bool first = leg_transfers_due == 0;
    const bool other_half = second_half == (leg_transfers_due > LEG_SUMS);

    return (first || other_half || deadline_guard.missed) && second_half == (left_b > LEG_SUMS) &&
           in_step(left_a, since_peak) && in_step(left_b, since_peak);
}
