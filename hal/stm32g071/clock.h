/*
 * Clocks: HSI16, PLL to 64 MHz for core, buses and timers; two wait states of flash. HSI16 is
 * trimmed to 1 %, and so are speeds and times of this board.
 */
#ifndef STEADYSTEP_STM32G071_CLOCK_H
#define STEADYSTEP_STM32G071_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

enum { CORE_CLOCK_Hz = 64000000, CORE_CYCLES_PER_us = 64, HSI16_Hz = 16000000 };

/* From reset to CORE_CLOCK_Hz; false: the PLL does not start. */
bool clock_start(void);
/* The clocks of everything that the port uses. */
void clock_of_blocks(void);

/* TIM2, free-running, since this core has no cycle counter; with its clock on. */
void cycle_counter_start(void);
/* Core cycles since cycle_counter_start, wraps at 2^32. */
uint32_t clock_cycles(void);

void clock_wait_us(uint32_t us);

#endif
