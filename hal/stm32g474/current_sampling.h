/*
 * Both phase currents at S(k), simultaneous, and behind them bus voltage and temperature: injected
 * sequences of ADC1 and ADC2, started by the PWM timer at the peak. The end of the sequence of ADC1
 * raises the control interrupt.
 */
#ifndef STEADYSTEP_STM32G474_CURRENT_SAMPLING_H
#define STEADYSTEP_STM32G474_CURRENT_SAMPLING_H

#include <stdbool.h>

#include "hal/hal.h"
#include "hal/stm32g474/registers.h"

/* Amplifiers and converters. */
void current_sampling_configure(void);
/* From the next peak on, with the control interrupt. */
void current_sampling_start(void);

/* Results of this S(k); false: one converter has not converted. */
static inline bool current_sampling_read(struct hal_samples *samples)
{
    const uint32_t done = ADC1->isr & ADC2->isr;

    ADC1->isr = ADC_ISR_JEOS | ADC_ISR_JEOC;
    ADC2->isr = ADC_ISR_JEOS | ADC_ISR_JEOC;
    samples->current_a = (uint16_t)ADC1->jdr[0];
    samples->current_b = (uint16_t)ADC2->jdr[0];
    samples->bus_voltage = (uint16_t)ADC1->jdr[1];
    samples->temperature = (uint16_t)ADC2->jdr[1];
    return (done & ADC_ISR_JEOS) != 0;
}

#endif
