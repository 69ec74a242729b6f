/*
 * Mean voltage of both phases over S(k-1)...S(k). One converter has the legs A+ and A-, another B+
 * and B-, LEG_OVERSAMPLING times each in a group, added up by hardware; LEG_GROUPS in a period, in
 * step with the PWM timer, are 136 samples of each leg at 10 kHz. DMA stores the sums of a period
 * in one half of a buffer while the interrupt reads the other.
 */
#ifndef STEADYSTEP_STM32G474_PHASE_VOLTAGE_SAMPLING_H
#define STEADYSTEP_STM32G474_PHASE_VOLTAGE_SAMPLING_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/hal.h"
#include "hal/stm32g474/board.h"
#include "hal/stm32g474/dma.h"

enum {
    LEGS_OF_PHASE = 2,
    LEG_SUMS = LEG_GROUPS * LEGS_OF_PHASE, /* of a phase in a period */
    /* What is added up in a period; codes of a phase are twice those of a leg. */
    LEG_DIVISOR = 2 * LEG_GROUPS * LEG_OVERSAMPLING,
    LEG_TWICE_EACH = 0x00020002,
    /* 1 / (2 LEG_DIVISOR), a little less, by 2^39 */
    LEG_RECIPROCAL = ((int64_t)1 << 39) / (2 * LEG_DIVISOR),
};

_Static_assert(LEG_GROUPS % 17 == 0, "groups are added up 17 at a time");

/* Of the phases a and b, each of two periods; DMA stores the sums of the legs + and - in turn: + in
   the lower half word. */
extern uint32_t leg_sums[2][2 * LEG_GROUPS];

/* The control interrupt's: transfers left at the coming peak; none is known at first. */
extern uint32_t leg_transfers_due;

/* All but the timer's start, which the first peak of the PWM timer brings. */
void phase_voltage_sampling_configure(void);

/* Whether sums are in step, of an interrupt that comes late, of the first, or of one behind a
   period without, which is reported as a missed deadline. */
bool phase_voltage_sampling_in_step(uint32_t left_a, uint32_t left_b);

/* Adds twice leg + less leg - of 17 groups, in 37 cycles, with registers that an interrupt need not
   save. */
static inline int32_t add_17_groups(int32_t sum, const uint32_t *groups)
{
#define ADD(group) "smlsd %[sum], " group ", %[twice], %[sum]\n\t"
#define ADD_FIVE   ADD("r0") ADD("r1") ADD("r2") ADD("r3") ADD("r12")
    __asm__ volatile("ldmia %[at]!, {r0-r3, r12, lr}\n\t" ADD_FIVE
                         ADD("lr") "ldmia %[at]!, {r0-r3, r12, lr}\n\t" ADD_FIVE ADD(
                             "lr") "ldmia %[at], {r0-r3, r12}\n\t" ADD_FIVE
                     : [sum] "+r"(sum), [at] "+r"(groups)
                     : [twice] "r"(LEG_TWICE_EACH), "m"(*(const uint32_t(*)[17])groups)
                     : "r0", "r1", "r2", "r3", "r12", "lr");
#undef ADD
#undef ADD_FIVE
    return sum;
}

/* To the nearest code, ties upwards. A sum has 15 bits. The odd 1 is half of the least difference:
   it bears what the reciprocal lacks, on either side of zero. */
static inline int16_t mean_of_groups(const uint32_t *groups)
{
    int32_t twice = LEG_DIVISOR + 1;

#pragma GCC unroll 2
    for (int group = 0; group < LEG_GROUPS; group += 17) {
        twice = add_17_groups(twice, &groups[group]);
    }
    return (int16_t)((int32_t)((int64_t)twice * LEG_RECIPROCAL >> 32) >> 7);
}

/* Of the period that ended at the last peak; false: conversions are out of step or lost. */
static inline bool phase_voltage_sampling_read(struct hal_samples *samples)
{
    const uint32_t left_a = dma_remaining(DMA_LEGS_A);
    const uint32_t left_b = dma_remaining(DMA_LEGS_B);
    const uint32_t due = leg_transfers_due;
    const uint32_t *done = leg_sums[0];

    if (__builtin_expect(((left_a ^ due) | (left_b ^ due)) != 0, false) &&
        !phase_voltage_sampling_in_step(left_a, left_b)) {
        return false;
    }
    /* The half that is not being filled holds until the next peak. */
    done += left_a > LEG_SUMS ? LEG_GROUPS : 0;
    leg_transfers_due = left_a > LEG_SUMS ? LEG_SUMS : 2 * LEG_SUMS;
    samples->phase_voltage_a = mean_of_groups(done);
    samples->phase_voltage_b = mean_of_groups(done + LEG_SUMS);
    return true;
}

#endif
