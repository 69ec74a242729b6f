#include "firmware/link/sdo_block.h"

#include "firmware/application/application.h"
#include "firmware/link/link.h"

/* What the two lowest bits of a request ask for. */
enum { INITIATE = 0, END = 1, ACKNOWLEDGE = 2, START = 3 };

enum { CHECKED = 0x04, SIZED = 0x02, LAST = 0x80, SEQUENCE_MAX = 127, SPARE_FRAMES = 4 };

enum { UPLOAD_BEGINS = 0xc6, UPLOAD_ENDS = 0xc1 };
enum { DOWNLOAD_BEGINS = 0xa4, DOWNLOAD_GOES_ON = 0xa2, DOWNLOAD_ENDS = 0xa1 };

enum {
    ABORT_SPECIFIER = 0x05040001,
    ABORT_BLOCK_SIZE = 0x05040002,
    ABORT_SEQUENCE = 0x05040003,
    ABORT_CHECKSUM = 0x05040004,
    ABORT_TOO_LONG = 0x06070012
};

enum { BLOCK_DOWN = SDO_VALUE_BYTES / SDO_SEGMENT_BYTES }; /* no value is longer */

/* CRC-16 of CCITT, x^16 + x^12 + x^5 + 1, from 0. */
static uint16_t checksum(uint16_t crc, const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        crc ^= (uint16_t)(bytes[i] << 8);
        for (int bit = 0; bit < 8; bit++) {
            crc = (uint16_t)((unsigned)crc << 1 ^ ((crc & 0x8000u) != 0u ? 0x1021u : 0u));
        }
    }
    return crc;
}

/* Of the segment behind `done`. */
static size_t segment_at(struct application *application, uint32_t done, uint8_t *bytes)
{
    const uint32_t left = application->link->sdo.length - done;
    const size_t count = left < SDO_SEGMENT_BYTES ? left : SDO_SEGMENT_BYTES;

    sdo_copy(application, done, bytes, count);
    return count;
}

/* ---- upload ---- */

static uint32_t begin_upload(struct application *application, const struct can_frame *request,
                             struct can_frame *response)
{
    struct sdo_server *sdo = &application->link->sdo;
    const uint32_t abort = sdo_open(application, request);

    if (abort != OBJECT_DONE) {
        return abort;
    }
    if (request->data[4] < 1u || request->data[4] > SEQUENCE_MAX) {
        return ABORT_BLOCK_SIZE;
    }
    sdo->block = request->data[4];
    sdo->checked = (request->data[0] & CHECKED) != 0u;
    sdo->state = SDO_BLOCK_OPEN;
    response->data[0] = UPLOAD_BEGINS;
    memcpy(&response->data[1], &request->data[1], 3);
    can_put(&response->data[4], sdo->length, 4);
    return OBJECT_DONE;
}

/* Of the last block what the client has received goes into the checksum. */
static uint32_t acknowledge(struct application *application, const struct can_frame *request,
                            struct can_frame *response, bool *answers)
{
    struct sdo_server *sdo = &application->link->sdo;
    const uint8_t received = request->data[1];

    if (received > sdo->sequence) {
        return ABORT_SEQUENCE;
    }
    if (request->data[2] < 1u || request->data[2] > SEQUENCE_MAX) {
        return ABORT_BLOCK_SIZE;
    }
    for (uint8_t i = 0; i < received; i++) {
        uint8_t bytes[SDO_SEGMENT_BYTES];
        const size_t count = segment_at(application, sdo->done, bytes);

        sdo->crc = checksum(sdo->crc, bytes, count);
        sdo->done += (uint32_t)count;
    }
    sdo->block = request->data[2];
    sdo->sequence = 0;
    sdo->state = SDO_BLOCK_SENDS;
    if (sdo->done == sdo->length) {
        const uint32_t over = sdo->length % SDO_SEGMENT_BYTES;

        sdo->state = SDO_BLOCK_ENDS;
        response->data[0] = (uint8_t)(UPLOAD_ENDS | (over == 0u ? 0u : 7u - over) << 2);
        can_put(&response->data[1], sdo->checked ? sdo->crc : 0u, 2);
        *answers = true;
    }
    return OBJECT_DONE;
}

uint32_t sdo_block_upload(struct application *application, const struct can_frame *request,
                          struct can_frame *response, bool *answers)
{
    struct sdo_server *sdo = &application->link->sdo;
    const unsigned asks = request->data[0] & 3u;

    *answers = asks == INITIATE;
    if (asks == INITIATE) {
        return begin_upload(application, request, response);
    }
    if (asks == START && sdo->state == SDO_BLOCK_OPEN) {
        sdo->state = SDO_BLOCK_SENDS;
        return OBJECT_DONE;
    }
    if (asks == ACKNOWLEDGE && sdo->state == SDO_BLOCK_SENDS) {
        return acknowledge(application, request, response, answers);
    }
    if (asks == END && sdo->state == SDO_BLOCK_ENDS) {
        sdo->state = SDO_IDLE;
        return OBJECT_DONE;
    }
    return ABORT_SPECIFIER;
}

void sdo_block_send(struct application *application)
{
    struct sdo_server *sdo = &application->link->sdo;
    uint32_t from = sdo->done + (uint32_t)SDO_SEGMENT_BYTES * sdo->sequence;

    while (sdo->state == SDO_BLOCK_SENDS && sdo->sequence < sdo->block && from < sdo->length &&
           link_has_room(application, SPARE_FRAMES)) {
        struct can_frame segment = {.id = (uint16_t)application->link->objects.sdo_response,
                                    .length = 8};

        from += (uint32_t)segment_at(application, from, &segment.data[1]);
        sdo->sequence++;
        segment.data[0] = (uint8_t)(sdo->sequence | (from == sdo->length ? LAST : 0));
        link_send(application, &segment);
    }
}

/* ---- download ---- */

static uint32_t begin_download(struct application *application, const struct can_frame *request,
                               struct can_frame *response)
{
    struct sdo_server *sdo = &application->link->sdo;
    const uint32_t abort = sdo_find(sdo, request);

    if (abort != OBJECT_DONE) {
        return abort;
    }
    if ((sdo->object.access & OBJECT_WRITE) == 0u) {
        return OBJECT_READ_ONLY;
    }
    if ((request->data[0] & SIZED) != 0u &&
        can_get(&request->data[4], 4) != object_bytes(&sdo->object)) {
        return OBJECT_WRONG_LENGTH;
    }
    sdo->checked = (request->data[0] & CHECKED) != 0u;
    sdo->state = SDO_BLOCK_RECEIVES;
    response->data[0] = DOWNLOAD_BEGINS;
    memcpy(&response->data[1], &request->data[1], 3);
    response->data[4] = BLOCK_DOWN;
    return OBJECT_DONE;
}

static uint32_t end_download(struct application *application, const struct can_frame *request,
                             struct can_frame *response)
{
    struct sdo_server *sdo = &application->link->sdo;
    const size_t bytes = object_bytes(&sdo->object);

    if (sdo->state != SDO_BLOCK_RECEIVED) {
        return ABORT_SPECIFIER;
    }
    if (sdo->done - (request->data[0] >> 2 & 7u) != bytes) {
        return OBJECT_WRONG_LENGTH;
    }
    if (sdo->checked && checksum(0, sdo->value, bytes) != can_get(&request->data[1], 2)) {
        return ABORT_CHECKSUM;
    }
    sdo->state = SDO_IDLE;
    response->data[0] = DOWNLOAD_ENDS;
    return object_put(application, &sdo->object, sdo->value);
}

uint32_t sdo_block_download(struct application *application, const struct can_frame *request,
                            struct can_frame *response)
{
    return (request->data[0] & 1u) == INITIATE ? begin_download(application, request, response)
                                               : end_download(application, request, response);
}

bool sdo_block_is_segment(const struct can_frame *request)
{
    return (request->data[0] & SEQUENCE_MAX) <= BLOCK_DOWN;
}

uint32_t sdo_block_take(struct application *application, const struct can_frame *request,
                        struct can_frame *response, bool *answers)
{
    struct sdo_server *sdo = &application->link->sdo;
    const uint8_t sequence = request->data[0] & SEQUENCE_MAX;
    const bool last = (request->data[0] & LAST) != 0u;
    const bool next = sequence == sdo->sequence + 1u;

    if (next && sdo->done + SDO_SEGMENT_BYTES > SDO_VALUE_BYTES) {
        return ABORT_TOO_LONG;
    }
    if (next) {
        memcpy(&sdo->value[sdo->done], &request->data[1], SDO_SEGMENT_BYTES);
        sdo->done += SDO_SEGMENT_BYTES;
        sdo->sequence = sequence;
    }
    if (next && last) {
        sdo->state = SDO_BLOCK_RECEIVED;
    }
    *answers = last || sequence >= BLOCK_DOWN;
    if (*answers) {
        response->data[0] = DOWNLOAD_GOES_ON;
        response->data[1] = sdo->sequence;
        response->data[2] = BLOCK_DOWN;
        sdo->sequence = 0;
    }
    return OBJECT_DONE;
}
