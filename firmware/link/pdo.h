/*
 * Process data: four frames that are received and four that are sent, each with up to eight objects
 * that the client maps at run time. Received ones act at once (transmission type 254, 255) or with
 * the next SYNC (0...240); sent ones go when a mapped value has changed or the event timer is over
 * (254, 255; looked at once in a millisecond), or with every n-th SYNC (1...240; 0: if changed).
 */
#ifndef STEADYSTEP_PDO_H
#define STEADYSTEP_PDO_H

#include "firmware/link/can_frame.h"
#include "firmware/link/objects.h"

enum { PDOS = 4, PDO_OBJECTS = LINK_PDO_OBJECTS, PDO_EVENT = 254 };

#define PDO_INVALID 0x80000000u /* in a COB-ID */

struct pdo {
    uint32_t cob_id;
    uint32_t map[PDO_OBJECTS]; /* index << 16 | sub-index << 8 | bits */
    uint32_t sent_us;
    uint16_t inhibit_100us;
    uint16_t event_ms;
    uint8_t count; /* objects in force */
    uint8_t type;  /* of transmission */
    uint8_t syncs; /* since it was sent */
    bool waits;    /* received: for SYNC; sent: goes whether changed or not */
    struct can_frame frame;
};

struct pdos {
    struct pdo received[PDOS], sent[PDOS];
};

struct application;

void pdo_put_presets(struct pdos *pdos, uint8_t node);

/* 1400h...1403h, 1600h... and 1800h..., 1a00h...: of the object's value. */
void pdo_ask(const struct pdos *pdos, const struct object *object, uint8_t *value);
enum object_abort pdo_obey(struct application *application, const struct object *object,
                           const uint8_t *value);

/* Whether a client may give a COB-ID this identifier: CiA 301 keeps those of NMT, the default SDO
   and the heartbeat from it. */
bool pdo_may_have(uint32_t id);

/* Whether a COB-ID may become another one: its identifier changes only while it is invalid. */
bool pdo_may_become(uint32_t present, uint32_t cob_id);

/* In NMT state operational: a frame; one that SYNC waited for; the look of each millisecond. */
void pdo_receive(struct application *application, const struct can_frame *frame);
void pdo_sync(struct application *application);
void pdo_look(struct application *application);

/* The node becomes operational: what is sent on change is sent once. */
void pdo_start(struct pdos *pdos);

#endif
