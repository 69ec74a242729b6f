/*
 * Waiting for hardware, never for ever. Limits count passes of the loop, of which the core makes at
 * most one in four cycles: `limit` passes last at least 4 x limit cycles.
 */
#ifndef STEADYSTEP_CORTEX_M_WAIT_H
#define STEADYSTEP_CORTEX_M_WAIT_H

#include <stdbool.h>
#include <stdint.h>

/* Whether (*reg & mask) became `value` within the limit. */
static inline bool wait_until(const volatile uint32_t *reg, uint32_t mask, uint32_t value,
                              uint32_t limit)
{
    for (; limit > 0; limit--) {
        if ((*reg & mask) == value) {
            return true;
        }
    }
    return (*reg & mask) == value;
}

/* At least so many core cycles. */
static inline void wait_cycles(uint32_t cycles)
{
    for (uint32_t passes = cycles / 3u + 1u; passes > 0; passes--) {
        __asm__ volatile("nop");
    }
}

#endif
