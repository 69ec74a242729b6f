/*
 * Hardware overcurrent trip: the pin map's comparators on the low-side shunts open the bridge
 * through the PWM timer's break input, without software and without clock.
 */
#ifndef STEADYSTEP_STM32G474_OVERCURRENT_TRIP_H
#define STEADYSTEP_STM32G474_OVERCURRENT_TRIP_H

/* Before the PWM timer listens to the comparators. */
void overcurrent_trip_configure(void);

#endif
