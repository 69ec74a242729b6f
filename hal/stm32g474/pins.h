/* Pins as the pin map has them. */
#ifndef STEADYSTEP_STM32G474_PINS_H
#define STEADYSTEP_STM32G474_PINS_H

/* Connects every pin; the gates only after the timer holds them low. */
void pins_connect(void);

/* The diode. */
void pins_led(int on);

#endif
