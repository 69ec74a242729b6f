/*
 * The node on a board's CAN bus (hal.h, struct hal_can): from power-up on, beside the console, but
 * while the serial line has the channel. A frame is taken in a pass. What the node would not look
 * at the board does not receive.
 *
 * Emergencies of CiA 301: 8110h frames were lost, once in a second; 8120h error passive; 8140h back
 * from bus-off, during which the drive stops as if its master were lost; 0000h when it is over.
 */
#ifndef STEADYSTEP_CAN_BUS_H
#define STEADYSTEP_CAN_BUS_H

#include <stddef.h>

#include "firmware/link/can_frame.h"

struct application;
struct link;

/* The node begins to live there: boot-up. What moves goes on; a drive that is enabled stays the
   console's until a master switches it on, or resets communication. */
void can_bus_join(struct application *application);

/* The line takes the channel: the drive stops as if its master were lost. */
void can_bus_leave(struct application *application);

/* Background, all the time; once in a millisecond. */
void can_bus_background(struct application *application);
void can_bus_watch(struct application *application);

size_t can_bus_room(const struct link *link);
void can_bus_send(const struct link *link, const struct can_frame *frame);

#endif
