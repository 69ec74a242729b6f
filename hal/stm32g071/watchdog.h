/* Independent watchdog: resets the chip if it is not fed for WATCHDOG_ms (LSI, +-5 % and more). */
#ifndef STEADYSTEP_STM32G071_WATCHDOG_H
#define STEADYSTEP_STM32G071_WATCHDOG_H

#include "hal/stm32g071/registers.h"

/* From here on it cannot be stopped. */
void watchdog_start(void);

static inline void watchdog_feed(void)
{
    IWDG->kr = IWDG_FEED;
}

#endif
