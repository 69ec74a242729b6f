/*
 * Clocks: HSI16, PLL to 64 MHz for core, buses and timers; two wait states of flash. HSI16 is
 * trimmed to 1 %, and so are speeds and times of this board.
 */
#ifndef STEADYSTEP_STM32G071_CLOCK_H
#define STEADYSTEP_STM32G071_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

enum { CORE_CLOCK_Hz = 64000000, CORE_CYCLES_PER_us = 64 };

/* Start-up: the clocks of everything that the port uses, and the free-running cycle counter.
   false: an oscillator or the PLL does not start. */
bool clock_start(void);

/* Core cycles since clock_start, wraps at 2^32: TIM2, since this core has no cycle counter. */
uint32_t clock_cycles(void);

void clock_wait_us(uint32_t us);

/* Until these bits of a register are as expected; false: they are not within 12 ms. */
bool clock_wait_for(const volatile uint32_t *status, uint32_t mask, uint32_t expected);

#endif
