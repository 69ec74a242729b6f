/* System clock, flash wait states, clock security. */
#ifndef STEADYSTEP_STM32G474_CLOCK_H
#define STEADYSTEP_STM32G474_CLOCK_H

/* From reset to CORE_Hz, from the crystal or, if there is none or it does not start, from HSI16. */
void clock_start(void);

#endif
