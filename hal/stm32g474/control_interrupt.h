/* The control interrupt: from the converters' results through the application to the timer. */
#ifndef STEADYSTEP_STM32G474_CONTROL_INTERRUPT_H
#define STEADYSTEP_STM32G474_CONTROL_INTERRUPT_H

#include <stdbool.h>

#include "firmware/application/application.h"

/* The one of this image; linked by name, which costs the interrupt no load of a pointer. */
extern struct application application;

/* hal.h's, code of the last S(k). */
uint16_t control_bridge_temperature(void);

/* Of the last S(k), since start-up. */
int32_t control_encoder_count(void);

/* Whether the gates may follow the outputs; hal.h. */
bool control_allow_bridge(void);
void control_forbid_bridge(void);

/* TIM1's update: the peak. */
void control_interrupt(void);

/* The same, and application_follow_control behind it. */
void control_interrupt_followed(void);

#endif
