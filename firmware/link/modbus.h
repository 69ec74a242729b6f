/*
 * Modbus RTU on the serial line: a server whose registers are the objects of the dictionary.
 *
 * A register's address is an object's index. From there on lie the values of the object, of an
 * array or a record those of its sub-indexes from 1 on, one behind another: 8 and 16 bits are one
 * register, 32 bits two, a REAL64 four, the highest first; of a text two characters each, zeros
 * behind it. An access begins at an index and ends with a value. Read: functions 3 and 4; written:
 * 6 and 16; function 8 with subfunction 0 echoes. One access writes its values in their order, up
 * to the first that is refused.
 *
 * Source: Modbus application protocol V1.1b3; Modbus over serial line V1.02.
 */
#ifndef STEADYSTEP_MODBUS_H
#define STEADYSTEP_MODBUS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    MODBUS_REQUEST_BYTES = 200, /* longest request that is heard: of 95 registers */
    MODBUS_RESPONSE_BYTES = 256
};

/* Exceptions. */
enum modbus_exception {
    MODBUS_NONE,
    MODBUS_FUNCTION,
    MODBUS_ADDRESS, /* no object, or not for this access */
    MODBUS_VALUE,   /* out of range, or the count does not end with a value */
    MODBUS_FAILURE  /* not in this state of the drive, not stored */
};

struct application;

/* CRC-16 of a frame; of one with its own behind it 0. */
uint16_t modbus_crc(const uint8_t *frame, size_t length);

/* Whether these are all bytes of a request, by its function and its checksum. One of a function
   that is not served is over with the silence behind it. */
bool modbus_is_whole(const uint8_t *frame, size_t length);

/* Obeys what has come: the bytes of the response. 0, there is none: it is no request, one to
   another node, or one to all. */
size_t modbus_serve(struct application *application, uint8_t node, const uint8_t *request,
                    size_t length, uint8_t response[MODBUS_RESPONSE_BYTES]);

#endif
