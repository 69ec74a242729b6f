#include "firmware/link/sdo.h"

#include "firmware/application/application.h"
#include "firmware/link/data_sheet.h"
#include "firmware/link/link.h"
#include "firmware/link/sdo_block.h"

/* Command specifiers: the three highest bits of the first byte. */
enum {
    CLIENT_SEGMENT_DOWN,
    CLIENT_DOWN,
    CLIENT_UP,
    CLIENT_SEGMENT_UP,
    CLIENT_ABORTS,
    CLIENT_BLOCK_UP,
    CLIENT_BLOCK_DOWN
};

enum { TOGGLE = 0x10, LAST = 0x01, ABORTS = 0x80 };

enum { ABORT_TOGGLE = 0x05030000, ABORT_SPECIFIER = 0x05040001, ABORT_TOO_LONG = 0x06070012 };

static void refuse(struct sdo_server *sdo, struct can_frame *response, uint32_t code)
{
    sdo->state = SDO_IDLE;
    response->data[0] = 0x80;
    can_put(&response->data[1], sdo->object.index, 2);
    response->data[3] = sdo->object.sub;
    can_put(&response->data[4], code, 4);
}

static size_t text_length(const char *text)
{
    size_t length = 0;

    while (length < 255u && text[length] != '\0') {
        length++;
    }
    return length;
}

uint32_t sdo_find(struct sdo_server *sdo, const struct can_frame *request)
{
    const uint16_t index = (uint16_t)can_get(&request->data[1], 2);

    sdo->state = SDO_IDLE;
    sdo->toggle = 0;
    sdo->length = 0;
    sdo->done = 0;
    sdo->sequence = 0;
    sdo->crc = 0;
    sdo->text = NULL;
    return objects_find(index, request->data[3], &sdo->object);
}

uint32_t sdo_open(struct application *application, const struct can_frame *request)
{
    struct sdo_server *sdo = &application->link->sdo;
    uint32_t abort = sdo_find(sdo, request);

    if (abort == OBJECT_DONE) {
        abort = object_get(application, &sdo->object, sdo->value, &sdo->text);
    }
    sdo->length =
        (uint32_t)(sdo->text == NULL ? object_bytes(&sdo->object) : text_length(sdo->text));
    if (abort == OBJECT_DONE && sdo->object.type == OBJECT_DOMAIN) {
        sdo->length = sdo->object.index == OBJECT_DATA_SHEET
                          ? data_sheet_bytes
                          : capture_bytes(&application->link->capture);
        return sdo->length > 0u ? OBJECT_DONE : OBJECT_NO_DATA;
    }
    return abort;
}

void sdo_copy(const struct application *application, uint32_t offset, uint8_t *to, size_t count)
{
    const struct sdo_server *sdo = &application->link->sdo;
    const uint8_t *from = sdo->text == NULL ? sdo->value : (const uint8_t *)sdo->text;

    if (sdo->text == NULL && sdo->object.type == OBJECT_DOMAIN) {
        capture_copy(application, offset, to, count);
    } else {
        memcpy(to, from + offset, count);
    }
}

static uint32_t begin_upload(struct application *application, const struct can_frame *request,
                             struct can_frame *response)
{
    struct sdo_server *sdo = &application->link->sdo;
    const uint32_t abort = sdo_open(application, request);

    if (abort != OBJECT_DONE) {
        return abort;
    }
    memcpy(&response->data[1], &request->data[1], 3);
    if (sdo->text == NULL && sdo->length <= 4u) { /* a domain has more */
        response->data[0] = (uint8_t)(0x43u | (4u - sdo->length) << 2);
        memcpy(&response->data[4], sdo->value, sdo->length);
    } else {
        sdo->state = SDO_SENDS;
        response->data[0] = 0x41;
        can_put(&response->data[4], sdo->length, 4);
    }
    return OBJECT_DONE;
}

static uint32_t send_segment(struct application *application, const struct can_frame *request,
                             struct can_frame *response)
{
    struct sdo_server *sdo = &application->link->sdo;
    const uint32_t left = sdo->length - sdo->done;
    const size_t count = left < SDO_SEGMENT_BYTES ? left : SDO_SEGMENT_BYTES;

    if (sdo->state != SDO_SENDS) {
        return ABORT_SPECIFIER;
    }
    if ((request->data[0] & TOGGLE) != sdo->toggle) {
        return ABORT_TOGGLE;
    }
    response->data[0] = (uint8_t)(sdo->toggle | (SDO_SEGMENT_BYTES - count) << 1);
    sdo_copy(application, sdo->done, &response->data[1], count);
    sdo->done += (uint32_t)count;
    sdo->toggle ^= TOGGLE;
    if (sdo->done == sdo->length) {
        response->data[0] |= LAST;
        sdo->state = SDO_IDLE;
    }
    return OBJECT_DONE;
}

static uint32_t begin_download(struct application *application, const struct can_frame *request,
                               struct can_frame *response)
{
    struct sdo_server *sdo = &application->link->sdo;
    const uint8_t specifier = request->data[0];
    const bool at_once = (specifier & 0x02u) != 0u;
    const bool sized = (specifier & 0x01u) != 0u;
    const uint32_t abort = sdo_find(sdo, request);
    const size_t bytes = object_bytes(&sdo->object);
    const size_t given = at_once ? 4u - (specifier >> 2 & 3u) : can_get(&request->data[4], 4);

    if (abort != OBJECT_DONE) {
        return abort;
    }
    if ((sdo->object.access & OBJECT_WRITE) == 0u) {
        return OBJECT_READ_ONLY;
    }
    if (sized ? given != bytes : at_once && bytes > 4u) {
        return OBJECT_WRONG_LENGTH;
    }
    response->data[0] = 0x60;
    memcpy(&response->data[1], &request->data[1], 3);
    if (at_once) {
        memcpy(sdo->value, &request->data[4], 4);
        return object_put(application, &sdo->object, sdo->value);
    }
    sdo->state = SDO_RECEIVES;
    return OBJECT_DONE;
}

static uint32_t take_segment(struct application *application, const struct can_frame *request,
                             struct can_frame *response)
{
    struct sdo_server *sdo = &application->link->sdo;
    const size_t count = SDO_SEGMENT_BYTES - (request->data[0] >> 1 & 7u);

    if (sdo->state != SDO_RECEIVES) {
        return ABORT_SPECIFIER;
    }
    if ((request->data[0] & TOGGLE) != sdo->toggle) {
        return ABORT_TOGGLE;
    }
    if (sdo->length + count > object_bytes(&sdo->object)) {
        return ABORT_TOO_LONG;
    }
    memcpy(&sdo->value[sdo->length], &request->data[1], count);
    sdo->length += (uint32_t)count;
    response->data[0] = 0x20u | sdo->toggle;
    sdo->toggle ^= TOGGLE;
    if ((request->data[0] & LAST) == 0u) {
        return OBJECT_DONE;
    }
    sdo->state = SDO_IDLE;
    return sdo->length == object_bytes(&sdo->object)
               ? object_put(application, &sdo->object, sdo->value)
               : OBJECT_WRONG_LENGTH;
}

/* Of what is neither an abort nor a segment of a block. */
static uint32_t obey(struct application *application, const struct can_frame *request,
                     struct can_frame *response, bool *answers)
{
    switch (request->data[0] >> 5) {
    case CLIENT_SEGMENT_DOWN:
        return take_segment(application, request, response);
    case CLIENT_DOWN:
        return begin_download(application, request, response);
    case CLIENT_UP:
        return begin_upload(application, request, response);
    case CLIENT_SEGMENT_UP:
        return send_segment(application, request, response);
    case CLIENT_BLOCK_UP:
        return sdo_block_upload(application, request, response, answers);
    case CLIENT_BLOCK_DOWN:
        return sdo_block_download(application, request, response);
    default:
        (void)sdo_find(&application->link->sdo, request);
        return ABORT_SPECIFIER;
    }
}

bool sdo_serve(struct application *application, const struct can_frame *request,
               struct can_frame *response)
{
    struct sdo_server *sdo = &application->link->sdo;
    bool answers = true;

    *response = (struct can_frame){.length = 8};
    if (request->length != 8u) {
        return false;
    }
    const bool segment = sdo->state == SDO_BLOCK_RECEIVES && sdo_block_is_segment(request);

    if (segment ? request->data[0] == ABORTS : request->data[0] >> 5 == CLIENT_ABORTS) {
        sdo->state = SDO_IDLE;
        return false;
    }
    const uint32_t abort = segment ? sdo_block_take(application, request, response, &answers)
                                   : obey(application, request, response, &answers);

    if (abort != OBJECT_DONE) {
        refuse(sdo, response, abort);
        return true;
    }
    return answers;
}
