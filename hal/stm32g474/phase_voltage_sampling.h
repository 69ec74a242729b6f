/*
 * Mean voltage of both phases over S(k-1)...S(k). One converter has the legs A+ and
 * A-, another B+ and B-, eight times each in a group, added up by hardware; 17 groups in a period,
 * in step with the PWM timer, are 136 samples of each leg. DMA stores the sums of a period in one
 * half of a buffer while the interrupt reads the other.
 */
#ifndef STEADYSTEP_STM32G474_PHASE_VOLTAGE_SAMPLING_H
#define STEADYSTEP_STM32G474_PHASE_VOLTAGE_SAMPLING_H

#include <stdbool.h>

#include "hal/hal.h"

/* All but the timer's start, which the first peak of the PWM timer brings. */
void phase_voltage_sampling_configure(void);

/* Of the period that ended at the last peak, which was this many core cycles ago; false:
   conversions are out of step or lost. */
bool phase_voltage_sampling_read(struct hal_samples *samples, uint32_t since_peak);

#endif
