/* Pins as the pin map has them. */
#ifndef STEADYSTEP_STM32G071_PINS_H
#define STEADYSTEP_STM32G071_PINS_H

/* Connects every pin; after the timer holds the bridge's inputs low. */
void pins_connect(void);

#endif
