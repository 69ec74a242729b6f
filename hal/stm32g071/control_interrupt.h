/* The control interrupt: from the converter's results through the application to the timer. */
#ifndef STEADYSTEP_STM32G071_CONTROL_INTERRUPT_H
#define STEADYSTEP_STM32G071_CONTROL_INTERRUPT_H

#include "firmware/application/application.h"

/* The one of this image; linked by name, which costs the interrupt no load of a pointer. */
extern struct application application;

/* DMA1 channel 1: the group at the peak is complete. */
void control_interrupt(void);
/* PendSV, right behind it: what it took. */
void pend_sv_handler(void);

#endif
