/* What the converters have in common: power-up, calibration, enabling. */
#ifndef STEADYSTEP_STM32G474_ADC_H
#define STEADYSTEP_STM32G474_ADC_H

#include "hal/stm32g474/registers.h"

/* Clock of ADC1 and ADC2, or of ADC3, ADC4 and ADC5: the bus clock over 4, 42.5 MHz, so that
   conversions keep step with the timers. */
void adc_clock(struct adc_common_registers *common, uint32_t enable);

/* From deep power-down to ready, calibrated single-ended. */
void adc_power_up(struct adc_registers *adc);

#endif
