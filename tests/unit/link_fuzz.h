/*
 * Inputs of any content for the node of link_bench.h. Most are about objects that the dictionary
 * has, of every index area and every sub-index, with values that it may accept: what is refused at
 * the first look reaches nothing.
 */
#ifndef STEADYSTEP_LINK_FUZZ_H
#define STEADYSTEP_LINK_FUZZ_H

#include <math.h>

#include "firmware/interface/dictionary.h"
#include "tests/unit/link_bench.h"

enum { FUZZ_OBJECTS = 600, FUZZ_QUEUE = 96, FUZZ_WORDS = 600, FUZZ_BETWEEN_STARTS = 2000 };

static struct {
    uint64_t state; /* of what is drawn */
    struct object objects[FUZZ_OBJECTS];
    size_t object_count;
    struct can_frame queue[FUZZ_QUEUE]; /* the rest of a transfer */
    size_t queued, taken;
    uint32_t memory[FUZZ_WORDS + 1]; /* of the capture, and behind it what must stay */
    long captures, enabled;          /* inputs that found the drive so */
} fuzz = {.state = 1};

static inline uint32_t fuzz_draw(uint32_t below)
{
    fuzz.state = fuzz.state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)((fuzz.state >> 33) * below >> 31);
}

static inline bool fuzz_once_in(uint32_t draws)
{
    return fuzz_draw(draws) == 0u;
}

/* All that the dictionary has. */
static inline void fuzz_find_objects(void)
{
    fuzz.object_count = 0;
    for (uint32_t index = 0; index < 0x10000u; index++) {
        struct object found;

        if (objects_find((uint16_t)index, 0, &found) == OBJECT_MISSING) {
            continue;
        }
        for (uint32_t sub = 0; sub < 256u; sub++) {
            if (objects_find((uint16_t)index, (uint8_t)sub, &found) == OBJECT_DONE) {
                TEST_ASSERT_TRUE(fuzz.object_count < FUZZ_OBJECTS);
                fuzz.objects[fuzz.object_count++] = found;
            }
        }
    }
}

/* A drive anew, with memory for its capture. */
static inline void fuzz_start(void)
{
    link_bench_start();
    fuzz.memory[FUZZ_WORDS] = 0xdeadbeef;
    link_put_memory(&bench_link, fuzz.memory, FUZZ_WORDS);
    fuzz.queued = fuzz.taken = 0;
}

static inline void fuzz_look(void)
{
    TEST_ASSERT_EQUAL_HEX32(0xdeadbeef, fuzz.memory[FUZZ_WORDS]);
    fuzz.captures += capture_state_of(&bench_link.capture) == CAPTURE_DONE;
    fuzz.enabled += bench.application.drive.supervision.state == DRIVE_OPERATION_ENABLED;
}

/* ---- values ---- */

static inline struct object fuzz_object(void)
{
    struct object any = fuzz.objects[fuzz_draw((uint32_t)fuzz.object_count)];

    if (fuzz_once_in(16)) {
        any.sub = (uint8_t)fuzz_draw(256);
    } else if (fuzz_once_in(32)) {
        any.index = (uint16_t)fuzz_draw(0x10000);
    }
    return any;
}

static inline uint32_t fuzz_whole(void)
{
    switch (fuzz_draw(4)) {
    case 0:
        return fuzz_draw(4);
    case 1:
        return fuzz_draw(256);
    case 2:
        return 0u - fuzz_draw(256);
    default:
        return fuzz_draw(0x10000) << 16 | fuzz_draw(0x10000);
    }
}

static inline double fuzz_real(void)
{
    static const double ends[] = {0.0, -0.0, 1e-300, 1e300, -1e300, 4294967296.0, 1e10, -1e10};
    const double any = (double)fuzz_draw(2000001) * 1e-6 - 1.0;

    switch (fuzz_draw(8)) {
    case 0:
        return fuzz_once_in(2) ? (double)NAN : (double)INFINITY;
    case 1:
        return ends[fuzz_draw(8)];
    case 2:
        return 1000.0 * any;
    case 3:
        return (double)fuzz_draw(8);
    default:
        return 10.0 * any;
    }
}

static inline uint32_t fuzz_controlword(void)
{
    static const uint16_t words[] = {0x06, 0x07, 0x0f, 0x0f, 0x1f, 0x3f, 0x5f,
                                     0x7f, 0x02, 0x0b, 0x00, 0x80, 0x10f};

    return fuzz_once_in(8) ? fuzz_whole() : words[fuzz_draw(13)];
}

static inline uint32_t fuzz_signal_index(void)
{
    return fuzz_once_in(8) ? fuzz_whole() : signal_at((enum drive_signal)fuzz_draw(SIGNALS))->index;
}

/* An entry of a mapping: an object with its length in bits. */
static inline uint32_t fuzz_entry(void)
{
    struct object mapped = fuzz_object();

    for (int i = 0; i < 100 && (mapped.access & (OBJECT_SENT | OBJECT_RECEIVED)) == 0u; i++) {
        mapped = fuzz_object();
    }
    return (uint32_t)mapped.index << 16 | (uint32_t)mapped.sub << 8 |
           (uint32_t)(8u * object_bytes(&mapped));
}

static inline uint32_t fuzz_number_for(const struct object *object)
{
    static const uint8_t modes[] = {1, 3, 6, 8, 10};
    const uint32_t of_pdos = object->index & 0xff00u;

    if (object->index == 0x6040u) {
        return fuzz_controlword();
    }
    if (object->index == 0x6060u && !fuzz_once_in(8)) {
        return modes[fuzz_draw(5)];
    }
    if (object->index == 0x2401u || (object->index == 0x2400u && object->sub == 3u)) {
        return fuzz_signal_index();
    }
    if ((of_pdos == 0x1600u || of_pdos == 0x1a00u) && object->sub > 0u) {
        return fuzz_entry();
    }
    if ((of_pdos == 0x1400u || of_pdos == 0x1800u) && object->sub == 1u) {
        return (fuzz_once_in(2) ? 0x80000000u : 0u) | (fuzz_once_in(8) ? 0u : 0x40000000u) |
               fuzz_draw(0x800);
    }
    if (object->index == 0x1010u && fuzz_once_in(2)) {
        return 0x65766173;
    }
    return object->index == 0x1011u && fuzz_once_in(2) ? 0x64616f6c : fuzz_whole();
}

/* The bytes of a value of an object, the lowest first; how many. */
static inline size_t fuzz_value(const struct object *object, uint8_t value[OBJECT_BYTES_MAX])
{
    const size_t bytes = object_bytes(object);

    memset(value, 0, OBJECT_BYTES_MAX);
    if (object->type == OBJECT_REAL64) {
        const double real = fuzz_real();

        memcpy(value, &real, sizeof real);
    } else {
        can_put(value, fuzz_number_for(object), 4);
    }
    return bytes == 0u || fuzz_once_in(32) ? 1u + fuzz_draw(8) : bytes;
}

/* ---- frames ---- */

static inline struct can_frame *fuzz_queue(uint8_t specifier)
{
    struct can_frame *frame = &fuzz.queue[fuzz.queued];

    TEST_ASSERT_TRUE(fuzz.queued < FUZZ_QUEUE);
    fuzz.queued++;
    *frame = (struct can_frame){
        .id = (uint16_t)bench_link.objects.sdo_request, .length = 8, .data = {specifier}};
    return frame;
}

/* A request that begins a transfer of an object. */
static inline struct can_frame *fuzz_begin(uint8_t specifier, uint16_t index, uint8_t sub)
{
    struct can_frame *frame = fuzz_queue(specifier);

    can_put(&frame->data[1], index, 2);
    frame->data[3] = sub;
    return frame;
}

static inline uint16_t fuzz_checksum(const uint8_t *bytes, size_t count)
{
    uint32_t crc = 0;

    for (size_t i = 0; i < count; i++) {
        crc ^= (uint32_t)bytes[i] << 8;
        for (int bit = 0; bit < 8; bit++) {
            crc = (crc << 1 ^ ((crc & 0x8000u) != 0u ? 0x1021u : 0u)) & 0xffffu;
        }
    }
    return (uint16_t)crc;
}

static inline void fuzz_write_block(uint16_t index, uint8_t sub, const uint8_t *value, size_t bytes)
{
    const size_t last = bytes > 7u ? bytes - 7u : bytes;
    struct can_frame *frame = fuzz_begin(fuzz_once_in(2) ? 0xc6 : 0xc2, index, sub);
    uint8_t sequence = 0;

    frame->data[4] = (uint8_t)bytes;
    if (bytes > 7u) {
        memcpy(&fuzz_queue(++sequence)->data[1], value, 7);
    }
    memcpy(&fuzz_queue((uint8_t)(0x80u | ++sequence))->data[1], &value[bytes - last], last);
    frame = fuzz_queue((uint8_t)(0xc1u | (7u - last) << 2));
    can_put(&frame->data[1], fuzz_checksum(value, bytes), 2);
}

static inline void fuzz_write_segments(uint16_t index, uint8_t sub, const uint8_t *value,
                                       size_t bytes)
{
    const size_t last = bytes > 7u ? bytes - 7u : bytes;
    uint8_t toggle = 0;

    fuzz_begin(fuzz_once_in(4) ? 0x20 : 0x21, index, sub)->data[4] = (uint8_t)bytes;
    if (bytes > 7u) {
        memcpy(&fuzz_queue(0)->data[1], value, 7);
        toggle = 0x10;
    }
    memcpy(&fuzz_queue((uint8_t)(toggle | (7u - last) << 1 | 1u))->data[1], &value[bytes - last],
           last);
}

static inline void fuzz_write(uint16_t index, uint8_t sub, const uint8_t *value, size_t bytes)
{
    if (fuzz_once_in(4)) {
        fuzz_write_block(index, sub, value, bytes);
    } else if (bytes > 4u || fuzz_once_in(4)) {
        fuzz_write_segments(index, sub, value, bytes);
    } else {
        memcpy(&fuzz_begin((uint8_t)(0x23u | (4u - bytes) << 2), index, sub)->data[4], value, 4);
    }
}

static inline void fuzz_put(uint16_t index, uint8_t sub, uint32_t number, size_t bytes)
{
    uint8_t value[OBJECT_BYTES_MAX] = {0};

    can_put(value, number, 4);
    fuzz_write(index, sub, value, bytes);
}

static inline void fuzz_read(uint16_t index, uint8_t sub)
{
    const uint32_t more = fuzz_draw(12);

    if (fuzz_once_in(2)) {
        (void)fuzz_begin(0x40, index, sub);
        for (uint32_t i = 0; i < more; i++) {
            (void)fuzz_queue((uint8_t)(0x60u | (i & 1u) << 4));
        }
        return;
    }
    const uint8_t segments = (uint8_t)(fuzz_once_in(8) ? fuzz_draw(256) : 1u + fuzz_draw(9));

    fuzz_begin(0xa4, index, sub)->data[4] = segments;
    (void)fuzz_queue(0xa3);
    for (uint32_t i = 0; i < more; i++) {
        struct can_frame *frame = fuzz_queue(0xa2);

        frame->data[1] = (uint8_t)(fuzz_once_in(8) ? fuzz_draw(256) : segments);
        frame->data[2] = segments;
    }
    (void)fuzz_queue(0xa1);
}

static inline void fuzz_enable(void)
{
    fuzz_put(0x6040, 0, 6, 2);
    fuzz_put(0x6040, 0, 7, 2);
    fuzz_put(0x6040, 0, 15, 2);
}

/* Some signals, a trigger or none, armed, and read. */
static inline void fuzz_capture(void)
{
    const uint32_t signals = fuzz_draw(9);

    for (uint32_t i = 0; i < 8u; i++) {
        fuzz_put(0x2401, (uint8_t)(i + 1u), i < signals ? fuzz_signal_index() : 0u, 2);
    }
    fuzz_put(0x2400, 2, 1u + fuzz_draw(3), 2);
    fuzz_put(0x2400, 3, fuzz_once_in(2) ? fuzz_signal_index() : 0u, 2);
    fuzz_put(0x2400, 6, fuzz_draw(4), 4);
    fuzz_put(0x2400, 7, fuzz_draw(fuzz_once_in(4) ? 2 * FUZZ_WORDS : 40), 4);
    fuzz_put(0x2400, 1, 1, 1);
    fuzz_read(0x2400, 1);
    fuzz_read(0x2402, 0);
}

static inline void fuzz_transfer(void)
{
    const struct object object = fuzz_object();
    uint8_t value[OBJECT_BYTES_MAX];

    fuzz.queued = fuzz.taken = 0;
    switch (fuzz_draw(32)) {
    case 0:
    case 1:
        fuzz_enable();
        break;
    case 2:
        fuzz_capture();
        break;
    case 3:
    case 4:
    case 5:
    case 6:
    case 7:
    case 8:
        fuzz_read(object.index, object.sub);
        break;
    default: {
        const size_t bytes = fuzz_value(&object, value);

        fuzz_write(object.index, object.sub, value, bytes);
        break;
    }
    }
}

static inline struct can_frame fuzz_nmt(void)
{
    static const uint8_t commands[] = {0x01, 0x01, 0x01, 0x02, 0x80, 0x81, 0x82};
    struct can_frame frame = {.length = 2};

    frame.data[0] = (uint8_t)(fuzz_once_in(16) ? fuzz_draw(256) : commands[fuzz_draw(7)]);
    frame.data[1] = fuzz_once_in(4) ? (uint8_t)fuzz_draw(3) : bench_link.node;
    return frame;
}

/* To one of the PDOs that are received, where it is just now. */
static inline struct can_frame fuzz_rpdo(void)
{
    struct can_frame frame = {
        .id = (uint16_t)(bench_link.pdos.received[fuzz_draw(PDOS)].cob_id & 0x7ffu),
        .length = (uint8_t)(fuzz_once_in(4) ? fuzz_draw(9) : 8u)};

    can_put(frame.data, fuzz_controlword(), 4);
    can_put(&frame.data[2], fuzz_whole(), 4);
    can_put(&frame.data[6], fuzz_whole(), 2);
    return frame;
}

static inline struct can_frame fuzz_rubbish(uint32_t id, uint8_t length)
{
    struct can_frame frame = {.id = (uint16_t)id, .length = length};

    for (size_t i = 0; i < length; i++) {
        frame.data[i] = (uint8_t)fuzz_draw(256);
    }
    return frame;
}

/* The next frame: most are of transfers that are carried through. */
static inline struct can_frame fuzz_frame(void)
{
    switch (fuzz_draw(32)) {
    case 0:
        return fuzz_rubbish(fuzz_draw(0x800), (uint8_t)fuzz_draw(9));
    case 1:
        return fuzz_rubbish(bench_link.objects.sdo_request, 8);
    case 2:
        return fuzz_nmt();
    case 3:
    case 4:
        return (struct can_frame){.id = (uint16_t)(bench_link.objects.sync_cob_id & 0x7ffu)};
    case 5:
        return fuzz_rubbish(0x700u + fuzz_draw(128), (uint8_t)fuzz_draw(3));
    case 6:
    case 7:
    case 8:
    case 9:
        return fuzz_rpdo();
    default:
        break;
    }
    if (fuzz.taken == fuzz.queued || fuzz_once_in(256)) {
        fuzz_transfer();
    }
    struct can_frame frame = fuzz.queue[fuzz.taken++];

    if (fuzz_once_in(64)) {
        frame.data[fuzz_draw(8)] = (uint8_t)fuzz_draw(256);
    }
    return frame;
}

#endif
