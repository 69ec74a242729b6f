/*
 * The one ADC: a sequence of eight conversions (0.5 us each), triggered LEG_VOLTAGE_SAMPLES times a
 * period by TIM3, which runs in step with TIM1. DMA puts the eight groups of a period one behind
 * the other; the last one is taken at the peak S(k), and its end raises the control interrupt.
 *
 *   valley                     peak S(k)
 *      |     .     .     .     .|. A+ B+ a b B- A- bus temperature
 *      4     5     6     7     8  -> DMA complete -> control interrupt, 3 us after the peak
 *
 * Phase a is sampled 0.25 us before the peak, phase b 0.25 us after it: where a current falls by
 * 9 A/ms that is an error of 2.2 mA, less than a code (2.9 mA).
 */
#ifndef STEADYSTEP_STM32G071_CONVERTER_H
#define STEADYSTEP_STM32G071_CONVERTER_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/stm32g071/leg_voltage.h"

/* In the order of the sequence. */
struct converter_group {
    union {
        uint32_t words[4];
        struct {
            uint16_t a_plus, b_plus;
            uint16_t current_a, current_b;
            uint16_t b_minus, a_minus;
            uint16_t bus, temperature;
        };
    };
};

extern struct converter_group converter_groups[LEG_VOLTAGE_SAMPLES]; /* written by DMA */

/* Before the timers run. false: the ADC does not become ready. */
bool converter_start(void);

/*
 * While the timers run: takes the first trigger behind a peak as the first group of a period.
 * false: the moment could not be met.
 */
bool converter_synchronise(void);

/* The control interrupt: the sums over the groups of the period that ends at S(k). */
static inline struct leg_voltages converter_leg_voltages(void)
{
    struct leg_voltages legs = {0, 0, 0, 0};

#pragma GCC unroll 8
    for (int i = 0; i < LEG_VOLTAGE_SAMPLES; i++) {
        legs.plus_last = converter_groups[i].words[0];
        legs.minus_last = converter_groups[i].words[2];
        legs.plus_sum += legs.plus_last;
        legs.minus_sum += legs.minus_last;
    }
    return legs;
}

#endif
