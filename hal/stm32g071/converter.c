#include "hal/stm32g071/converter.h"

#include "hal/cortex_m/wait.h"
#include "hal/stm32g071/board.h"
#include "hal/stm32g071/bridge.h"
#include "hal/stm32g071/clock.h"

enum {
    RANKS = 8,
    TRIGGER_COUNTS = 2 * BRIDGE_HALF_PERIOD_COUNTS / LEG_VOLTAGE_SAMPLES,
    /* From the trigger to the middle between the samples of the two currents: 6 counts of
       latency, two and a half conversions of 32, 7 of sampling. */
    TRIGGER_LEAD_COUNTS = 93,
    /* Behind the start of TIM1 the trigger of TIM3 takes two counts through its input. */
    SLAVE_START_COUNTS = 2,
    READY_WAIT = 100000, /* passes, > 6 ms; calibration takes 3 us */
};

struct converter_group converter_groups[LEG_VOLTAGE_SAMPLES];

/* In the order of struct converter_group. */
static const uint8_t channels[RANKS] = {
    LEG_A_PLUS_CHANNEL,  LEG_B_PLUS_CHANNEL,  CURRENT_A_CHANNEL, CURRENT_B_CHANNEL,
    LEG_B_MINUS_CHANNEL, LEG_A_MINUS_CHANNEL, BUS_CHANNEL,       TEMPERATURE_CHANNEL};

static bool adc_start(void)
{
    uint32_t sequence = 0;

    ADC1->cfgr2 = ADC_CFGR2_CKMODE(ADC_CLOCK_PCLK_DIV2);
    ADC1->cr = ADC_CR_ADVREGEN;
    clock_wait_us(20); /* start of the regulator, RM0444 and data sheet: 20 us */
    ADC1->cr = ADC_CR_ADVREGEN | ADC_CR_ADCAL;
    if (!wait_until(&ADC1->cr, ADC_CR_ADCAL, 0, READY_WAIT)) {
        return false;
    }
    clock_wait_us(1); /* the ADC may be enabled two of its cycles after calibration */
    ADC1->isr = ADC_ISR_ADRDY;
    ADC1->cr = ADC_CR_ADVREGEN | ADC_CR_ADEN;
    if (!wait_until(&ADC1->isr, ADC_ISR_ADRDY, ADC_ISR_ADRDY, READY_WAIT)) {
        return false;
    }
    for (unsigned rank = 0; rank < RANKS; rank++) {
        sequence |= (uint32_t)channels[rank] << (4u * rank);
    }
    ADC1->cfgr1 = ADC_CFGR1_CHSELRMOD | ADC_CFGR1_OVRMOD | ADC_CFGR1_DMAEN | ADC_CFGR1_DMACFG |
                  ADC_CFGR1_EXTEN(ADC_RISING_EDGE) | ADC_CFGR1_EXTSEL(ADC_TRIGGER_TIM3_TRGO);
    if (!wait_until(&ADC1->isr, ADC_ISR_CCRDY, ADC_ISR_CCRDY, READY_WAIT)) {
        return false;
    }
    ADC1->isr = ADC_ISR_CCRDY;
    ADC1->smpr = ADC_SMPR_SAMPLE_TIME1(ADC_SAMPLING_3_5_CYCLES);
    ADC1->chselr = sequence;
    return wait_until(&ADC1->isr, ADC_ISR_CCRDY, ADC_ISR_CCRDY, READY_WAIT);
}

static void dma_start(void)
{
    struct dma_channel_registers *dma = &DMA1->channel[0];

    DMAMUX1->ccr[0] = DMAMUX_CCR_DMAREQ_ID(DMA_REQUEST_ADC1);
    dma->par = (uint32_t)(uintptr_t)&ADC1->dr;
    dma->mar = (uint32_t)(uintptr_t)converter_groups;
    dma->ndtr = RANKS * LEG_VOLTAGE_SAMPLES;
    dma->cr = DMA_CR_MINC | DMA_CR_CIRC | DMA_CR_PSIZE(DMA_BYTES_2) | DMA_CR_MSIZE(DMA_BYTES_2) |
              DMA_CR_PL(DMA_PRIORITY_VERY_HIGH) | DMA_CR_TCIE;
    dma->cr |= DMA_CR_EN;
}

/* An update of TIM3 every 800 counts, TRIGGER_LEAD_COUNTS ahead of TIM1's peaks. */
static void trigger_start(void)
{
    TIM3->arr = TRIGGER_COUNTS - 1;
    TIM3->egr = TIM_EGR_UG;
    TIM3->cnt = TRIGGER_LEAD_COUNTS + SLAVE_START_COUNTS;
    TIM3->cr2 = TIM_CR2_MMS(TIM_MASTER_UPDATE);
    TIM3->smcr = TIM_SMCR_TS(TIM3_TRIGGER_TIM1) | TIM_SMCR_SMS(TIM_SLAVE_TRIGGER);
}

bool converter_start(void)
{
    if (!adc_start()) {
        return false;
    }
    dma_start();
    trigger_start();
    return true;
}

/* The next trigger but the one at the peak is 800 counts behind it. */
bool converter_synchronise(void)
{
    for (int tries = 0; tries < 100000; tries++) {
        if ((TIM1->cr1 & TIM_CR1_DIR) != 0) {
            const uint32_t before = TIM1->cnt;

            if (before < BRIDGE_HALF_PERIOD_COUNTS - 100 &&
                before > BRIDGE_HALF_PERIOD_COUNTS - 400) {
                ADC1->cr = ADC_CR_ADVREGEN | ADC_CR_ADEN | ADC_CR_ADSTART;
                return TIM1->cnt > BRIDGE_HALF_PERIOD_COUNTS - 700;
            }
        }
    }
    return false;
}
