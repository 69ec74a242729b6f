/*
 * The object dictionary as the slave serves it: what CiA 301 and 402 lay down (objects_table.h),
 * and the drive's settings, commands and signals by the indexes that their tables give them.
 */
#ifndef STEADYSTEP_OBJECTS_H
#define STEADYSTEP_OBJECTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "firmware/interface/settings.h"
#include "firmware/link/objects_table.h"

/* Types, by their codes of CiA 301. */
enum object_type {
    OBJECT_BOOLEAN = 0x01,
    OBJECT_I8 = 0x02,
    OBJECT_I16 = 0x03,
    OBJECT_I32 = 0x04,
    OBJECT_U8 = 0x05,
    OBJECT_U16 = 0x06,
    OBJECT_U32 = 0x07,
    OBJECT_TEXT = 0x09,
    OBJECT_DOMAIN = 0x0f,
    OBJECT_REAL64 = 0x11
};

/* Access, in bits. */
enum {
    OBJECT_READ = 1,
    OBJECT_WRITE = 2,
    OBJECT_SENT = 4,     /* may be mapped into a PDO that is sent */
    OBJECT_RECEIVED = 8, /* that is received */
    OBJECT_OF_NODE = 16, /* the node's number is added to the preset */
    OBJECT_RO = OBJECT_READ,
    OBJECT_RO_T = OBJECT_READ | OBJECT_SENT,
    OBJECT_RO_NODE = OBJECT_READ | OBJECT_OF_NODE,
    OBJECT_RW = OBJECT_READ | OBJECT_WRITE,
    OBJECT_RW_NODE = OBJECT_RW | OBJECT_OF_NODE,
    OBJECT_RW_R = OBJECT_RW | OBJECT_RECEIVED,
    OBJECT_WO = OBJECT_WRITE
};

/* Why an access is aborted, as CiA 301 has it; 0: it is not. */
enum object_abort {
    OBJECT_DONE = 0,
    OBJECT_WRITE_ONLY = 0x06010001,
    OBJECT_READ_ONLY = 0x06010002,
    OBJECT_MISSING = 0x06020000,
    OBJECT_NOT_MAPPABLE = 0x06040041,
    OBJECT_PDO_TOO_LONG = 0x06040042,
    OBJECT_STORE_FAILED = 0x06060000,
    OBJECT_WRONG_LENGTH = 0x06070010,
    OBJECT_SUB_MISSING = 0x06090011,
    OBJECT_OUT_OF_RANGE = 0x06090030,
    OBJECT_NOT_TRANSFERRED = 0x08000020,
    OBJECT_WRONG_STATE = 0x08000022,
    OBJECT_NO_DATA = 0x08000024
};

#define OBJECT_TYPE_U8                                                uint8_t
#define OBJECT_TYPE_U16                                               uint16_t
#define OBJECT_TYPE_U32                                               uint32_t
#define OBJECT_TYPE_I8                                                int8_t
#define OBJECT_TYPE_I16                                               int16_t
#define OBJECT_TYPE_I32                                               int32_t
#define OBJECT_TYPE_REAL64                                            double
#define OBJECT_MEMBER(index, sub, type, access, member, preset, name) OBJECT_TYPE_##type member;
#define OBJECT_NONE(index, sub, type, access, preset, name)
struct link_objects {
    LINK_OBJECTS(OBJECT_MEMBER, OBJECT_NONE)
};
#undef OBJECT_MEMBER

enum object_kind {
    OBJECT_STORED,
    OBJECT_ASKED,
    OBJECT_SETTING,
    OBJECT_SIGNAL,
    OBJECT_COMMAND,
    OBJECT_PARAMETER
};

struct object {
    uint16_t index;
    uint8_t sub;
    uint8_t kind;   /* enum object_kind */
    uint8_t type;   /* enum object_type */
    uint8_t access; /* bits */
    uint16_t at;    /* offset in struct link_objects or struct drive_command, number of the signal,
                       element of the setting */
    const struct setting *setting;
};

enum { OBJECT_BYTES_MAX = 8 }; /* of a value; a text is longer */

struct application;

/* As a node starts: all of them; those of communication, 1000h to 1fffh, of one of this number. */
void objects_put_presets(struct link_objects *objects);
void objects_put_communication(struct link_objects *objects, uint8_t node);

/* OBJECT_DONE, OBJECT_MISSING or OBJECT_SUB_MISSING. */
enum object_abort objects_find(uint16_t index, uint8_t sub, struct object *found);

/* Bytes of a value; of a text or a domain 0. */
size_t object_bytes(const struct object *object);

/* The value, lowest byte first; of a text `text` instead. */
enum object_abort object_get(struct application *application, const struct object *object,
                             uint8_t value[OBJECT_BYTES_MAX], const char **text);

/* Puts a value of object_bytes; what hangs on it happens at once. */
enum object_abort object_put(struct application *application, const struct object *object,
                             const uint8_t value[OBJECT_BYTES_MAX]);

#endif
