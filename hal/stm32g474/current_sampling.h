/*
 * Both phase currents at S(k), simultaneous, and behind them bus voltage and temperature: injected
 * sequences of ADC1 and ADC2. The PWM timer starts them ahead of the peak, so that the currents are
 * held at the peak; as a rule they have ended when the control interrupt, which the peak raises,
 * has formed the voltage means.
 */
#ifndef STEADYSTEP_STM32G474_CURRENT_SAMPLING_H
#define STEADYSTEP_STM32G474_CURRENT_SAMPLING_H

#include <stdbool.h>

#include "hal/hal.h"
#include "hal/stm32g474/registers.h"

/* Amplifiers and converters. */
void current_sampling_configure(void);
/* From the next peak on. */
void current_sampling_start(void);

/* Bits of the converters that have no results of this S(k) yet. */
static inline uint32_t current_sampling_missing(void)
{
    return ~ADC12_COMMON->csr & (ADC_CSR_JEOC_MST | ADC_CSR_JEOC_SLV);
}

/* An interrupt that nothing held up may be here before them. false: a converter has none. */
static inline bool current_sampling_wait(void)
{
    return current_sampling_missing() == 0u || current_sampling_missing() == 0u ||
           current_sampling_missing() == 0u || current_sampling_missing() == 0u;
}

/* Results of this S(k). Reading the last of a converter clears JEOC. */
static inline void current_sampling_read(struct hal_samples *samples,
                                         volatile uint16_t *bridge_temperature)
{
    samples->current_a = (uint16_t)ADC1->jdr[0];
    samples->current_b = (uint16_t)ADC2->jdr[0];
    samples->bus_voltage = (uint16_t)ADC1->jdr[1];
    *bridge_temperature = (uint16_t)ADC2->jdr[1];
}

#endif
