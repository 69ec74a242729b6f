#include "firmware/link/pdo.h"

#include "firmware/application/application.h"
#include "firmware/link/link.h"

enum { ID_BITS = 0x7ff, NOT_PROCESSED = 0x8210, CONTROLWORD = 0x6040 };

#define NO_REMOTE 0x40000000u
#define EXTENDED  0x20000000u /* of 29 bits */

/* The statusword comes at least so often: python-canopen takes what has come twice for periodic,
   and gives up if it does not come for 0.2 s. */
enum { STATUS_EVENT_ms = 100 };

#define MAPPED(index, bits) ((uint32_t)(index) << 16 | (bits))

void pdo_put_presets(struct pdos *pdos, uint8_t node)
{
    static const uint32_t received[PDOS] = {0, MAPPED(0x6060, 8), MAPPED(0x607a, 32),
                                            MAPPED(0x60ff, 32)};
    static const uint32_t sent[PDOS] = {0, MAPPED(0x6061, 8), MAPPED(0x6064, 32),
                                        MAPPED(0x606c, 32)};

    *pdos = (struct pdos){.received[0].count = 0};
    for (uint32_t i = 0; i < PDOS; i++) {
        struct pdo *in = &pdos->received[i];
        struct pdo *out = &pdos->sent[i];
        const uint32_t validity = i == 0u ? 0u : PDO_INVALID;

        in->cob_id = (0x200u + 0x100u * i + node) | validity;
        out->cob_id = (0x180u + 0x100u * i + node) | NO_REMOTE | validity;
        in->type = out->type = 255;
        in->count = out->count = i == 0u ? 1 : 2;
        in->map[0] = MAPPED(0x6040, 16);
        out->map[0] = MAPPED(0x6041, 16);
        in->map[1] = received[i];
        out->map[1] = sent[i];
    }
    pdos->sent[0].event_ms = STATUS_EVENT_ms;
}

/* ---- parameters ---- */

static bool is_mapping(const struct object *object)
{
    return (object->index & 0x200u) != 0u;
}

static bool is_sent(const struct object *object)
{
    return (object->index & 0x800u) != 0u;
}

static struct pdo *pdo_of(struct pdos *pdos, const struct object *object)
{
    struct pdo *first = is_sent(object) ? pdos->sent : pdos->received;

    return &first[object->index & 3u];
}

/* The value as a number of at most 32 bits. */
static uint32_t parameter_of(const struct pdo *pdo, const struct object *object)
{
    if (is_mapping(object)) {
        return object->sub == 0u ? pdo->count : pdo->map[object->sub - 1u];
    }
    switch (object->sub) {
    case 0:
        return is_sent(object) ? 5 : 2;
    case 1:
        return pdo->cob_id;
    case 2:
        return pdo->type;
    case 3:
        return pdo->inhibit_100us;
    default:
        return pdo->event_ms;
    }
}

void pdo_ask(const struct pdos *pdos, const struct object *object, uint8_t *value)
{
    const struct pdo *pdo = pdo_of((struct pdos *)pdos, object);

    can_put(value, parameter_of(pdo, object), object_bytes(object));
}

static enum object_abort check_entry(uint32_t entry, unsigned access)
{
    struct object mapped;
    const enum object_abort abort =
        objects_find((uint16_t)(entry >> 16), (uint8_t)(entry >> 8), &mapped);

    if (abort != OBJECT_DONE) {
        return abort;
    }
    return (mapped.access & access) != 0u && (entry & 0xffu) == 8u * object_bytes(&mapped)
               ? OBJECT_DONE
               : OBJECT_NOT_MAPPABLE;
}

static enum object_abort put_count(struct pdo *pdo, unsigned access, uint8_t count)
{
    uint32_t bits = 0;

    for (size_t i = 0; count <= PDO_OBJECTS && i < count; i++) {
        const enum object_abort abort = check_entry(pdo->map[i], access);

        if (abort != OBJECT_DONE) {
            return abort;
        }
        bits += pdo->map[i] & 0xffu;
    }
    if (count > PDO_OBJECTS || bits > 64u) {
        return OBJECT_PDO_TOO_LONG;
    }
    pdo->count = count;
    return OBJECT_DONE;
}

static bool exists(const struct pdo *pdo)
{
    return (pdo->cob_id & PDO_INVALID) == 0u;
}

/* Of a PDO that does not exist; entries change while none is in force. */
static enum object_abort put_mapping(struct pdo *pdo, const struct object *object, uint32_t number)
{
    const unsigned access = is_sent(object) ? OBJECT_SENT : OBJECT_RECEIVED;

    if (exists(pdo)) {
        return OBJECT_WRONG_STATE;
    }
    if (object->sub == 0u) {
        return put_count(pdo, access, (uint8_t)number);
    }
    if (pdo->count != 0u) {
        return OBJECT_WRONG_STATE;
    }
    const enum object_abort abort = number == 0u ? OBJECT_DONE : check_entry(number, access);

    if (abort == OBJECT_DONE) {
        pdo->map[object->sub - 1u] = number;
    }
    return abort;
}

bool pdo_may_have(uint32_t id)
{
    return id >= 0x80u && id < 0x6e0u && (id <= 0x100u || id > 0x180u) &&
           (id <= 0x580u || id > 0x5ffu) && (id <= 0x600u || id > 0x67fu);
}

/* Masters that know of no remote frames leave their bit at 0: it means nothing here. */
bool pdo_may_become(uint32_t present, uint32_t cob_id)
{
    const uint32_t id = cob_id & ~NO_REMOTE;

    if ((cob_id & EXTENDED) != 0u) {
        return false;
    }
    return (cob_id & PDO_INVALID) != 0u || id == (present & ~NO_REMOTE) ||
           ((present & PDO_INVALID) != 0u && pdo_may_have(id));
}

/* Of one that is received: the last was shorter than what is mapped. */
static unsigned shortness(const struct link *link, const struct pdo *pdo)
{
    return (unsigned)LINK_ERROR_OF_PDO << (unsigned)(pdo - link->pdos.received);
}

enum object_abort pdo_obey(struct application *application, const struct object *object,
                           const uint8_t *value)
{
    struct link *link = application->link;
    struct pdo *pdo = pdo_of(&link->pdos, object);
    const bool sent = is_sent(object);
    const uint32_t number = can_get(value, object_bytes(object));

    if (is_mapping(object)) {
        return put_mapping(pdo, object, number); /* it does not exist: nothing waits */
    }
    switch (object->sub) {
    case 1:
        if (!pdo_may_become(pdo->cob_id, number)) {
            return OBJECT_OUT_OF_RANGE;
        }
        pdo->cob_id = number;
        if (!sent) {
            link_end_error(application, shortness(link, pdo));
        }
        break;
    case 2:
        if (number > 240u && number < PDO_EVENT) {
            return OBJECT_OUT_OF_RANGE;
        }
        pdo->type = (uint8_t)number;
        break;
    case 3:
        if (exists(pdo)) {
            return OBJECT_OUT_OF_RANGE;
        }
        pdo->inhibit_100us = (uint16_t)number;
        break;
    default:
        pdo->event_ms = (uint16_t)number;
        break;
    }
    pdo->waits = sent;
    pdo->syncs = 0;
    return OBJECT_DONE;
}

/* ---- received ---- */

/* A controlword begins what the other objects say, wherever it is mapped: it acts behind them. */
static void act(struct application *application, const struct pdo *pdo)
{
    const uint8_t *from = pdo->frame.data;
    const uint8_t *controlword = NULL;

    for (size_t i = 0; i < pdo->count; i++) {
        uint8_t value[OBJECT_BYTES_MAX] = {0};
        struct object object;

        if (objects_find((uint16_t)(pdo->map[i] >> 16), (uint8_t)(pdo->map[i] >> 8), &object) ==
            OBJECT_DONE) {
            memcpy(value, from, object_bytes(&object));
            if (object.index == CONTROLWORD) {
                controlword = from;
            } else {
                (void)object_put(application, &object, value);
            }
            from += object_bytes(&object);
        }
    }
    if (controlword != NULL) {
        cia402_control(application, (uint16_t)can_get(controlword, 2));
    }
}

static size_t mapped_bytes(const struct pdo *pdo)
{
    size_t bits = 0;

    for (size_t i = 0; i < pdo->count; i++) {
        bits += pdo->map[i] & 0xffu;
    }
    return bits / 8u;
}

void pdo_receive(struct application *application, const struct can_frame *frame)
{
    struct link *link = application->link;

    for (struct pdo *pdo = link->pdos.received; pdo != &link->pdos.received[PDOS]; pdo++) {
        if (!exists(pdo) || (pdo->cob_id & ID_BITS) != frame->id) {
            continue;
        }
        if (frame->length < mapped_bytes(pdo)) {
            link_begin_error(application, shortness(link, pdo), NOT_PROCESSED);
            continue;
        }
        link_end_error(application, shortness(link, pdo));
        pdo->frame = *frame;
        pdo->waits = pdo->type < PDO_EVENT;
        if (!pdo->waits) {
            act(application, pdo);
        }
    }
}

/* ---- sent ---- */

static void gather(struct application *application, const struct pdo *pdo, struct can_frame *frame)
{
    *frame = (struct can_frame){.id = (uint16_t)(pdo->cob_id & ID_BITS)};
    for (size_t i = 0; i < pdo->count; i++) {
        uint8_t value[OBJECT_BYTES_MAX] = {0};
        struct object object;
        const char *text = NULL;

        if (objects_find((uint16_t)(pdo->map[i] >> 16), (uint8_t)(pdo->map[i] >> 8), &object) ==
                OBJECT_DONE &&
            object_get(application, &object, value, &text) == OBJECT_DONE) {
            memcpy(&frame->data[frame->length], value, object_bytes(&object));
            frame->length = (uint8_t)(frame->length + object_bytes(&object));
        }
    }
}

static void send(struct application *application, struct pdo *pdo, const struct can_frame *frame)
{
    if (link_has_room(application, 1)) {
        pdo->frame = *frame;
        pdo->sent_us = application->link->now_us;
        pdo->syncs = 0;
        pdo->waits = false;
        link_send(application, frame);
    }
}

static bool is_due(const struct link *link, const struct pdo *pdo, const struct can_frame *frame)
{
    const uint32_t since = link_since(link, pdo->sent_us);

    return pdo->waits || (since >= 100u * pdo->inhibit_100us &&
                          ((pdo->event_ms > 0u && since >= 1000u * pdo->event_ms) ||
                           memcmp(frame->data, pdo->frame.data, sizeof frame->data) != 0));
}

void pdo_look(struct application *application)
{
    for (struct pdo *pdo = application->link->pdos.sent; pdo != &application->link->pdos.sent[PDOS];
         pdo++) {
        struct can_frame frame;

        if (!exists(pdo) || pdo->type < PDO_EVENT || pdo->count == 0u) {
            continue;
        }
        gather(application, pdo, &frame);
        if (is_due(application->link, pdo, &frame)) {
            send(application, pdo, &frame);
        }
    }
}

static void sync_sent(struct application *application, struct pdo *pdo)
{
    struct can_frame frame;

    if (!exists(pdo) || pdo->type >= PDO_EVENT || pdo->count == 0u) {
        return;
    }
    pdo->syncs++;
    if (pdo->syncs >= pdo->type) {
        gather(application, pdo, &frame);
        if (pdo->type > 0u || pdo->waits ||
            memcmp(frame.data, pdo->frame.data, sizeof frame.data) != 0) {
            send(application, pdo, &frame);
        }
    }
}

void pdo_sync(struct application *application)
{
    struct pdos *pdos = &application->link->pdos;

    for (size_t i = 0; i < PDOS; i++) {
        if (pdos->received[i].waits) {
            pdos->received[i].waits = false;
            act(application, &pdos->received[i]);
        }
    }
    for (size_t i = 0; i < PDOS; i++) {
        sync_sent(application, &pdos->sent[i]);
    }
}

void pdo_start(struct pdos *pdos)
{
    for (size_t i = 0; i < PDOS; i++) {
        pdos->received[i].waits = false;
        pdos->sent[i].waits = true;
        pdos->sent[i].syncs = 0;
    }
}
