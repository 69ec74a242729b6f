/*
 * The SDO server of CiA 301: a client reads and writes objects, in one frame where a value has up
 * to four bytes, else in segments or in blocks (sdo_block.h). One transfer at a time; a new one
 * ends what has not ended.
 */
#ifndef STEADYSTEP_SDO_H
#define STEADYSTEP_SDO_H

#include "firmware/link/can_frame.h"
#include "firmware/link/objects.h"

enum sdo_state {
    SDO_IDLE,
    SDO_SENDS,
    SDO_RECEIVES,
    SDO_BLOCK_OPEN,     /* to be uploaded, as soon as the client starts it */
    SDO_BLOCK_SENDS,    /* segments, until they are acknowledged */
    SDO_BLOCK_ENDS,     /* all of them are */
    SDO_BLOCK_RECEIVES, /* segments */
    SDO_BLOCK_RECEIVED
};

enum {
    SDO_SEGMENT_BYTES = 7,
    SDO_VALUE_BYTES = 2 * SDO_SEGMENT_BYTES /* of a download, whole segments */
};

struct sdo_server {
    uint8_t state; /* enum sdo_state */
    uint8_t toggle;
    uint8_t block;    /* segments of one */
    uint8_t sequence; /* of the last segment of this block */
    bool checked;     /* the client sends a checksum, or asks for one */
    uint16_t crc;     /* of what has been sent */
    uint32_t length;  /* bytes that have come, or that there are to send */
    uint32_t done;    /* that have been sent; of blocks, that are acknowledged, or have come */
    struct object object;
    const char *text; /* what is sent, unless it is NULL: `value` */
    uint8_t value[SDO_VALUE_BYTES];
};

struct application;

/* A request. false: it asks for no answer. */
bool sdo_serve(struct application *application, const struct can_frame *request,
               struct can_frame *response);

/* The object of a request that begins a transfer; with its value or text, to be sent. Why not: an
   abort code. */
uint32_t sdo_find(struct sdo_server *sdo, const struct can_frame *request);
uint32_t sdo_open(struct application *application, const struct can_frame *request);

/* Of what is sent. */
void sdo_copy(const struct application *application, uint32_t offset, uint8_t *to, size_t count);

#endif
