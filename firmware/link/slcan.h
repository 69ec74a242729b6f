/*
 * CAN frames as text on a serial line, in the manner of Lawicel's CAN232 (slcan): "t1232AABB" and a
 * carriage return is a frame of identifier 0x123 with two bytes. What python-can, slcand of
 * SocketCAN and their like speak, so that no adapter is needed.
 */
#ifndef STEADYSTEP_SLCAN_H
#define STEADYSTEP_SLCAN_H

#include <stdbool.h>
#include <stddef.h>

#include "firmware/link/can_frame.h"

enum {
    SLCAN_LINE_BYTES = 30, /* the longest line that can mean something, its end not counted */
    SLCAN_FRAME_BYTES = 22 /* the longest frame, its end counted */
};

enum slcan_meaning {
    SLCAN_UNKNOWN, /* no line of slcan */
    SLCAN_REFUSED, /* one that means nothing here */
    SLCAN_SETS,    /* a rate, a filter: accepted, and nothing to do */
    SLCAN_OPENS,
    SLCAN_LISTENS, /* opens, and sends nothing */
    SLCAN_CLOSES,
    SLCAN_SENDS, /* a frame to the bus, in `frame`; extended and remote ones are refused */
    SLCAN_ASKS_VERSION,
    SLCAN_ASKS_SERIAL,
    SLCAN_ASKS_FLAGS
};

/* What a line without its end means. */
enum slcan_meaning slcan_read(const char *line, size_t length, struct can_frame *frame);

/* The answer to it, an empty string of none but "\r" or "\a" included. `open`: the channel is. */
const char *slcan_answer(enum slcan_meaning meaning, bool open);

/* Writes a frame and its '\r'; its length, at most SLCAN_FRAME_BYTES. */
size_t slcan_write(const struct can_frame *frame, char *text);

#endif
