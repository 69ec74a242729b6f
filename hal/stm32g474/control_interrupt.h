/* The control interrupt: from the converters' results through the application to the timer. */
#ifndef STEADYSTEP_STM32G474_CONTROL_INTERRUPT_H
#define STEADYSTEP_STM32G474_CONTROL_INTERRUPT_H

#include <stdbool.h>

#include "firmware/application/application.h"

/* Whose interrupt it is; before it is raised. */
void control_set_application(struct application *application);

/* Whether the gates may follow the outputs; hal.h. */
bool control_allow_bridge(void);
void control_forbid_bridge(void);

void control_interrupt(void);

#endif
