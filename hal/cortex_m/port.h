/*
 * What a port implements for the files of this module, beside serial_line.h and parameter_flash.h;
 * and its two headers that the build names: STEADYSTEP_DEVICE, the chip as CMSIS-Core wants it
 * described, and STEADYSTEP_FAULTS, what can go wrong at its start.
 */
#ifndef STEADYSTEP_CORTEX_M_PORT_H
#define STEADYSTEP_CORTEX_M_PORT_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/hal.h"

extern const struct hal_facts port_facts;

/* As the functions of hal.h that have these names. */
bool port_bridge_enable(void);
void port_bridge_disable(void);
uint16_t port_bridge_temperature(void);
uint32_t port_inputs_read(void); /* of ports that carry the machine's */
void port_outputs_write(uint32_t levels);
bool port_encoder_index(enum hal_index ask, int32_t *count); /* of ports that carry the link */
uint32_t port_cycle_count(void);
uint64_t port_time_us(void);
void port_watchdog_feed(void);
void port_defer_interrupts(bool defers);
void port_follow_control(bool follows); /* of ports that carry the link */

#define PORT_NOT_STARTED UINT32_MAX

/* Index of the present or last control interrupt; PORT_NOT_STARTED before the first. */
uint32_t port_control_period(void);

/* All gates off, in whatever state chip and program are, without any stack (tools/stack_bound):
   crash_exception begins with it. */
void port_open_bridge(void);

/* What raised a non-maskable interrupt that is not handled: a number of the port's, and its text.
 */
uint32_t port_nmi_cause(void);
const char *port_nmi_text(uint32_t cause);

/* Why the chip was reset; RESET_POWER_ON: memory has lost what it held. */
enum reset_cause { RESET_UNKNOWN, RESET_PIN, RESET_SOFTWARE, RESET_WATCHDOG, RESET_POWER_ON };

/* The cause of this start, which the chip then forgets. */
enum reset_cause port_take_reset_cause(void);

#endif
