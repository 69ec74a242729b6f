/* Quadrature encoder on the timer of the pin map, every edge counted; without one it counts none.
 */
#ifndef STEADYSTEP_STM32G474_ENCODER_H
#define STEADYSTEP_STM32G474_ENCODER_H

#include <stdint.h>

void encoder_configure(void);

/* Count since start-up. To be called at least once in 32,767 counts; the control interrupt does. */
int32_t encoder_count(void);

#endif
