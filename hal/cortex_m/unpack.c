#include "hal/cortex_m/unpack.h"

enum {
    PROBABILITY_BITS = 12,
    ADAPTATION = 4,
    TOP = 1 << 24,
    CALL = 0x1e,     /* of a BL the first bits; of its second half these and one more */
    GAMMA_BITS = 16, /* of a number, the first left out: at most one less */
    GAMMA_MODELS = GAMMA_BITS * (GAMMA_BITS + 1) / 2,
    WIDE = 0xe8,     /* an instruction of two halves begins with a byte from here on */
    EVEN_PLACE = 12, /* of the contexts of a literal, behind those of odd places */
    CONTEXTS = 14,
};

/* Where the models of each kind begin. */
enum model {
    MATCH = 0,                            /* by place, even or odd, and whether a match was last */
    AGAIN = MATCH + 4,                    /* by the latter */
    LITERAL = AGAIN + 2,                  /* by literal_context, and the bits so far behind a 1 */
    LENGTH = LITERAL + CONTEXTS * 256,    /* by whether it is again */
    DISTANCE = LENGTH + 2 * GAMMA_MODELS, /* by whether the length is above 2 */
    MODELS = DISTANCE + 2 * GAMMA_MODELS,
};

struct unpacker {
    const uint8_t *packed;
    uint32_t code; /* within the range: above the begin of it */
    uint32_t range;
    uint16_t probability[MODELS]; /* of a 0 */
};

static void take_byte(struct unpacker *unpacker)
{
    unpacker->range <<= 8;
    unpacker->code = unpacker->code << 8 | *unpacker->packed++;
}

static unsigned take_bit(struct unpacker *unpacker, unsigned model)
{
    uint16_t *const probability = &unpacker->probability[model];
    const uint32_t bound = (unpacker->range >> PROBABILITY_BITS) * *probability;
    const unsigned bit = unpacker->code >= bound;

    if (bit) {
        unpacker->code -= bound;
        unpacker->range -= bound;
        *probability = (uint16_t)(*probability - (*probability >> ADAPTATION));
    } else {
        unpacker->range = bound;
        *probability =
            (uint16_t)(*probability + (((1 << PROBABILITY_BITS) - *probability) >> ADAPTATION));
    }
    while (unpacker->range < TOP) {
        take_byte(unpacker);
    }
    return bit;
}

static uint8_t take_literal(struct unpacker *unpacker, unsigned models)
{
    unsigned bits = 1;

    while (bits < 256u) {
        bits = 2u * bits + take_bit(unpacker, models + bits);
    }
    return (uint8_t)bits;
}

/* By the byte that says what the instruction before does; an odd place says what its own does. */
static unsigned literal_context(const uint8_t *begin, const uint8_t *to)
{
    const unsigned odd = (unsigned)(to - begin) & 1u;
    const unsigned before = to - begin > (int)odd ? *(to - 1 - odd) : 0u;

    if (odd == 0u) {
        return EVEN_PLACE + (before >= WIDE);
    }
    return before < WIDE ? before >> 2 & 7u : 8u + (before >> 2 & 3u);
}

static unsigned take_number(struct unpacker *unpacker, unsigned models)
{
    unsigned bits = 0, number = 1;

    while (take_bit(unpacker, models + bits)) {
        bits++;
    }
    models += GAMMA_BITS + bits * (bits - 1u) / 2u;
    while (bits-- > 0u) {
        number = 2u * number + take_bit(unpacker, models + bits);
    }
    return number;
}

static void unpack_region(struct unpacker *unpacker, uint8_t *to, const uint8_t *end)
{
    const uint8_t *const begin = to;
    unsigned distance = 0, matched = 0;

    while (to < end) {
        const unsigned odd = (unsigned)(to - begin) & 1u;
        if (!take_bit(unpacker, MATCH + 2u * odd + matched)) {
            *to = take_literal(unpacker, LITERAL + 256u * literal_context(begin, to));
            to++;
            matched = 0;
            continue;
        }
        const unsigned again = take_bit(unpacker, AGAIN + matched);
        unsigned length = take_number(unpacker, LENGTH + GAMMA_MODELS * again) + 1u - again;
        if (!again) {
            distance = take_number(unpacker, DISTANCE + GAMMA_MODELS * (length > 2u));
        }
        for (; length > 0u; length--, to++) {
            *to = *(to - distance);
        }
        matched = 1;
    }
}

/* A call goes to a place that other calls go to, too, so that packed it has that instead of how far
   away it is: in halfwords from the region's begin. */
static void place_calls(uint16_t *const begin, const uint16_t *end)
{
    for (uint16_t *at = begin; at + 2 <= end; at++) {
        if (at[0] >> 11 == CALL && at[1] >> 11 == (CALL | 1)) {
            const uint32_t away =
                ((at[0] & 0x7ffu) << 11 | (at[1] & 0x7ffu)) - (uint32_t)(at - begin);

            at[0] = (uint16_t)(CALL << 11 | (away >> 11 & 0x7ffu));
            at[1] = (uint16_t)((CALL | 1) << 11 | (away & 0x7ffu));
            at++;
        }
    }
}

void unpack(const uint8_t *packed, const struct unpacked_region *regions, unsigned count)
{
    struct unpacker unpacker;

    unpacker.packed = packed;
    for (unsigned model = 0; model < MODELS; model++) {
        unpacker.probability[model] = 1u << (PROBABILITY_BITS - 1);
    }
    unpacker.code = 0;
    for (unsigned byte = 0; byte < sizeof unpacker.code; byte++) {
        take_byte(&unpacker);
    }
    unpacker.range = UINT32_MAX;
    for (unsigned region = 0; region < count; region++) {
        unpack_region(&unpacker, regions[region].begin, regions[region].end);
        place_calls(regions[region].begin, regions[region].end);
    }
}
