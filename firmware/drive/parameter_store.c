#include "firmware/drive/parameter_store.h"

enum {
    FORMAT = 1,
    AT_FORMAT = 0,
    AT_SIZE = 2,
    AT_SEQUENCE = 4,
    AT_DETENT = 8,
    AT_CHECK = AT_DETENT + 4 * DRIVE_DETENT_COEFFICIENTS,
    RECORD_BYTES = AT_CHECK + 4,
    SLOT_BYTES_MAX = 64, /* a record in words of up to 16 bytes */
    PAGES = 2
};

/* A coefficient is kept in 32 bits: +-215 N m. */
static const double resolution_Nm = 1e-7;

struct slot {
    uint8_t byte[SLOT_BYTES_MAX];
};

/* Where the newest record is. */
struct newest {
    bool found;
    uint32_t page;
    uint32_t offset; /* within the page */
    uint32_t sequence;
};

static void put(uint8_t *at, uint32_t value, int bytes)
{
    for (int i = 0; i < bytes; i++) {
        at[i] = (uint8_t)(value >> (8 * i));
    }
}

static uint32_t get(const uint8_t *at, int bytes)
{
    uint32_t value = 0;

    for (int i = 0; i < bytes; i++) {
        value |= (uint32_t)at[i] << (8 * i);
    }
    return value;
}

static uint32_t crc32(const uint8_t *bytes, size_t count)
{
    uint32_t crc = UINT32_MAX;

    for (size_t i = 0; i < count; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++) {
            crc = (crc >> 1) ^ ((crc & 1u) != 0u ? 0xedb88320u : 0u);
        }
    }
    return ~crc;
}

/* A record in whole words; 0: the board has no store that could hold one. */
static uint32_t slot_bytes(const struct hal_facts *facts)
{
    const uint32_t word = facts->parameter_word_bytes;

    if (word == 0u || word > SLOT_BYTES_MAX - RECORD_BYTES + 1u) {
        return 0;
    }
    const uint32_t bytes = (RECORD_BYTES + word - 1u) / word * word;

    return facts->parameter_page_bytes < bytes ? 0u : bytes;
}

static bool is_record(const struct slot *slot)
{
    return get(&slot->byte[AT_FORMAT], 2) == FORMAT &&
           get(&slot->byte[AT_SIZE], 2) == RECORD_BYTES &&
           get(&slot->byte[AT_CHECK], 4) == crc32(slot->byte, AT_CHECK);
}

static bool read_slot(const struct hal *board, uint32_t page, uint32_t offset, struct slot *slot)
{
    return board->parameters_read(board->context,
                                  page * board->facts->parameter_page_bytes + offset, slot->byte,
                                  slot_bytes(board->facts));
}

/* Newer by less than half the range: a sequence may wrap. */
static bool newer(uint32_t sequence, uint32_t than)
{
    return sequence - than - 1u < (uint32_t)INT32_MAX;
}

static struct newest find_newest(const struct hal *board)
{
    const uint32_t step = slot_bytes(board->facts);
    struct newest newest = {.page = PAGES - 1};
    struct slot slot;

    for (uint32_t page = 0; page < PAGES; page++) {
        for (uint32_t offset = 0; offset + step <= board->facts->parameter_page_bytes;
             offset += step) {
            if (!read_slot(board, page, offset, &slot) || !is_record(&slot)) {
                continue;
            }
            const uint32_t sequence = get(&slot.byte[AT_SEQUENCE], 4);

            if (!newest.found || newer(sequence, newest.sequence)) {
                newest = (struct newest){true, page, offset, sequence};
            }
        }
    }
    return newest;
}

static bool is_blank(const struct slot *slot, uint32_t bytes)
{
    for (uint32_t i = 0; i < bytes; i++) {
        if (slot->byte[i] != 0xffu) {
            return false;
        }
    }
    return true;
}

/* The first blank slot behind `offset` in a page; parameter_page_bytes: there is none. */
static uint32_t find_blank(const struct hal *board, uint32_t page, uint32_t offset)
{
    const uint32_t step = slot_bytes(board->facts);
    struct slot slot;

    for (; offset + step <= board->facts->parameter_page_bytes; offset += step) {
        if (read_slot(board, page, offset, &slot) && is_blank(&slot, step)) {
            return offset;
        }
    }
    return board->facts->parameter_page_bytes;
}

static int32_t in_steps(double torque_Nm)
{
    const double steps = torque_Nm / resolution_Nm;

    if (!(steps > -2147483647.0)) {
        return -INT32_MAX;
    }
    return steps < 2147483647.0 ? (int32_t)(steps + (steps < 0.0 ? -0.5 : 0.5)) : INT32_MAX;
}

bool parameter_store_read(const struct hal *board, struct learned_parameters *learned)
{
    if (slot_bytes(board->facts) == 0u) {
        return false;
    }
    const struct newest newest = find_newest(board);
    struct slot slot;

    if (!newest.found || !read_slot(board, newest.page, newest.offset, &slot)) {
        return false;
    }
    for (int i = 0; i < DRIVE_DETENT_COEFFICIENTS; i++) {
        learned->detent_torque_Nm[i] =
            (double)(int32_t)get(&slot.byte[AT_DETENT + 4 * i], 4) * resolution_Nm;
    }
    return true;
}

bool parameter_store_write(const struct hal *board, const struct learned_parameters *learned)
{
    const uint32_t bytes = slot_bytes(board->facts);

    if (bytes == 0u) {
        return false;
    }
    const struct newest newest = find_newest(board);
    uint32_t page = newest.page;
    uint32_t offset = newest.found ? find_blank(board, page, newest.offset + bytes)
                                   : board->facts->parameter_page_bytes;
    struct slot slot;

    for (uint32_t i = 0; i < SLOT_BYTES_MAX; i++) {
        slot.byte[i] = 0xffu;
    }
    put(&slot.byte[AT_FORMAT], FORMAT, 2);
    put(&slot.byte[AT_SIZE], RECORD_BYTES, 2);
    put(&slot.byte[AT_SEQUENCE], newest.sequence + 1u, 4);
    for (int i = 0; i < DRIVE_DETENT_COEFFICIENTS; i++) {
        put(&slot.byte[AT_DETENT + 4 * i], (uint32_t)in_steps(learned->detent_torque_Nm[i]), 4);
    }
    put(&slot.byte[AT_CHECK], crc32(slot.byte, AT_CHECK), 4);
    if (offset == board->facts->parameter_page_bytes) {
        page = (page + 1u) % PAGES;
        offset = 0;
        if (!board->parameters_erase(board->context, page)) {
            return false;
        }
    }
    return board->parameters_program(
        board->context, page * board->facts->parameter_page_bytes + offset, slot.byte, bytes);
}
