/*
 * The SDO server of CiA 301: a client reads and writes objects, in one frame where a value has up
 * to four bytes, else in segments. One transfer at a time; a new one ends what has not ended.
 */
#ifndef STEADYSTEP_SDO_H
#define STEADYSTEP_SDO_H

#include "firmware/link/can_frame.h"
#include "firmware/link/objects.h"

enum sdo_state { SDO_IDLE, SDO_SENDS, SDO_RECEIVES };

struct sdo_server {
    uint8_t state; /* enum sdo_state */
    uint8_t toggle;
    uint8_t length; /* bytes that have come, or that there are to send */
    uint8_t done;   /* that have been sent */
    struct object object;
    const char *text; /* what is sent, unless it is NULL: `value` */
    uint8_t value[OBJECT_BYTES_MAX];
};

struct application;

/* A request. false: it asks for no answer. */
bool sdo_serve(struct application *application, const struct can_frame *request,
               struct can_frame *response);

#endif
