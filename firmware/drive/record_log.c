#include "firmware/drive/record_log.h"

enum { AT_FORMAT = 0, AT_SIZE = 2, AT_SEQUENCE = 4, WORD_BYTES_MAX = 16, PIECE_BYTES = 32 };

/* Slots of a page that a record is offered to before the page passes for worn out. */
enum { ATTEMPTS = 3 };

/* Where the newest record is. */
struct newest {
    bool found;
    uint32_t page; /* 0 or 1 */
    uint32_t offset;
    uint32_t sequence;
};

void record_put(uint8_t *at, uint64_t value, int bytes)
{
    for (int i = 0; i < bytes; i++) {
        at[i] = (uint8_t)(value >> (8 * i));
    }
}

uint64_t record_get(const uint8_t *at, int bytes)
{
    uint64_t value = 0;

    for (int i = 0; i < bytes; i++) {
        value |= (uint64_t)at[i] << (8 * i);
    }
    return value;
}

/* CRC-32 (IEEE 802.3), continued over more bytes; begins and ends inverted. */
static uint32_t crc32(uint32_t crc, const uint8_t *bytes, uint32_t count)
{
    crc = ~crc;
    for (uint32_t i = 0; i < count; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++) {
            crc = (crc >> 1) ^ ((crc & 1u) != 0u ? 0xedb88320u : 0u);
        }
    }
    return ~crc;
}

static uint32_t record_bytes(const struct record_log *log)
{
    return RECORD_BYTES((uint32_t)log->payload_bytes);
}

static uint32_t check_offset(const struct record_log *log)
{
    return record_bytes(log) - RECORD_CHECK_BYTES;
}

void record_seal(const struct record_log *log, uint8_t *record, uint32_t sequence)
{
    const uint32_t check = check_offset(log);

    record_put(&record[AT_FORMAT], log->format, 2);
    record_put(&record[AT_SIZE], record_bytes(log), 2);
    record_put(&record[AT_SEQUENCE], sequence, 4);
    record_put(&record[check], crc32(0, record, check), RECORD_CHECK_BYTES);
}

static bool has_header(const struct record_log *log, const uint8_t *header)
{
    return record_get(&header[AT_FORMAT], 2) == log->format &&
           record_get(&header[AT_SIZE], 2) == record_bytes(log);
}

bool record_is_valid(const struct record_log *log, const uint8_t *record)
{
    const uint32_t check = check_offset(log);

    return has_header(log, record) &&
           record_get(&record[check], RECORD_CHECK_BYTES) == crc32(0, record, check);
}

/* A record in whole words; 0: the board has no store that could hold one. */
static uint32_t slot_bytes(const struct hal_facts *facts, const struct record_log *log)
{
    const uint32_t word = facts->parameter_word_bytes;

    if (word == 0u || word > WORD_BYTES_MAX) {
        return 0;
    }
    const uint32_t bytes = (record_bytes(log) + word - 1u) / word * word;

    return facts->parameter_page_bytes < bytes ||
                   bytes > RECORD_SLOT_BYTES((uint32_t)log->payload_bytes)
               ? 0u
               : bytes;
}

static uint32_t in_store(const struct hal *board, const struct record_log *log, uint32_t page,
                         uint32_t offset)
{
    return (log->first_page + page) * board->facts->parameter_page_bytes + offset;
}

static uint32_t smaller(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static bool read(const struct hal *board, uint32_t at, uint8_t *bytes, uint32_t count)
{
    return board->parameters_read(board->context, at, bytes, count);
}

/* Whether a record lies at `at`, read in small pieces; its sequence. */
static bool find_record(const struct hal *board, const struct record_log *log, uint32_t at,
                        uint32_t *sequence)
{
    const uint32_t check = check_offset(log);
    uint8_t piece[PIECE_BYTES];
    uint32_t crc = 0;

    if (!read(board, at, piece, RECORD_HEADER_BYTES) || !has_header(log, piece)) {
        return false;
    }
    *sequence = (uint32_t)record_get(&piece[AT_SEQUENCE], 4);
    for (uint32_t done = 0; done < check; done += PIECE_BYTES) {
        const uint32_t count = smaller(check - done, PIECE_BYTES);

        if (!read(board, at + done, piece, count)) {
            return false;
        }
        crc = crc32(crc, piece, count);
    }
    return read(board, at + check, piece, RECORD_CHECK_BYTES) &&
           record_get(piece, RECORD_CHECK_BYTES) == crc;
}

/* Newer by less than half the range: a sequence may wrap. */
static bool newer(uint32_t sequence, uint32_t than)
{
    return sequence - than - 1u < (uint32_t)INT32_MAX;
}

static struct newest find_newest(const struct hal *board, const struct record_log *log)
{
    const uint32_t step = slot_bytes(board->facts, log);
    struct newest newest = {.page = RECORD_LOG_PAGES - 1};

    for (uint32_t page = 0; page < RECORD_LOG_PAGES; page++) {
        for (uint32_t offset = 0; offset + step <= board->facts->parameter_page_bytes;
             offset += step) {
            uint32_t sequence;

            if (find_record(board, log, in_store(board, log, page, offset), &sequence) &&
                (!newest.found || newer(sequence, newest.sequence))) {
                newest = (struct newest){true, page, offset, sequence};
            }
        }
    }
    return newest;
}

static bool is_blank(const struct hal *board, uint32_t at, uint32_t bytes)
{
    uint8_t piece[PIECE_BYTES];

    for (uint32_t done = 0; done < bytes; done += PIECE_BYTES) {
        const uint32_t count = smaller(bytes - done, PIECE_BYTES);

        if (!read(board, at + done, piece, count)) {
            return false;
        }
        for (uint32_t i = 0; i < count; i++) {
            if (piece[i] != 0xffu) {
                return false;
            }
        }
    }
    return true;
}

/* The first blank slot behind `offset` in a page; parameter_page_bytes: there is none. */
static uint32_t find_blank(const struct hal *board, const struct record_log *log, uint32_t page,
                           uint32_t offset)
{
    const uint32_t step = slot_bytes(board->facts, log);

    for (; offset + step <= board->facts->parameter_page_bytes; offset += step) {
        if (is_blank(board, in_store(board, log, page, offset), step)) {
            return offset;
        }
    }
    return board->facts->parameter_page_bytes;
}

bool record_log_read(const struct hal *board, const struct record_log *log, uint8_t *slot)
{
    if (slot_bytes(board->facts, log) == 0u) {
        return false;
    }
    const struct newest newest = find_newest(board, log);

    return newest.found &&
           read(board, in_store(board, log, newest.page, newest.offset), slot, record_bytes(log));
}

/* Into the first blank slots behind `offset`, of which a few may be worn out; how many were. */
static bool append(const struct hal *board, const struct record_log *log, const uint8_t *slot,
                   uint32_t page, uint32_t offset, uint32_t *worn)
{
    const uint32_t bytes = slot_bytes(board->facts, log);

    for (int attempt = 0; attempt < ATTEMPTS; attempt++) {
        offset = find_blank(board, log, page, offset);
        if (offset == board->facts->parameter_page_bytes) {
            return false;
        }
        if (board->parameters_program(board->context, in_store(board, log, page, offset), slot,
                                      bytes)) {
            return true;
        }
        (*worn)++;
        offset += bytes;
    }
    return false;
}

static bool begin_page(const struct hal *board, const struct record_log *log, const uint8_t *slot,
                       uint32_t page, uint32_t *worn)
{
    if (!board->parameters_erase(board->context, log->first_page + page)) {
        (*worn)++;
        return false;
    }
    return append(board, log, slot, page, 0u, worn);
}

/* Where the other page takes nothing, the newest record gives way to its successor. */
enum record_writing record_log_write(const struct hal *board, const struct record_log *log,
                                     uint8_t *slot)
{
    const uint32_t bytes = slot_bytes(board->facts, log);
    uint32_t worn = 0;

    if (bytes == 0u) {
        return RECORD_REFUSED;
    }
    const struct newest newest = find_newest(board, log);
    const uint32_t other = (newest.page + 1u) % RECORD_LOG_PAGES;

    record_seal(log, slot, newest.sequence + 1u);
    for (uint32_t i = record_bytes(log); i < bytes; i++) {
        slot[i] = 0xffu;
    }
    if ((newest.found && append(board, log, slot, newest.page, newest.offset + bytes, &worn)) ||
        begin_page(board, log, slot, other, &worn) ||
        begin_page(board, log, slot, newest.page, &worn)) {
        return worn == 0u ? RECORD_WRITTEN : RECORD_WRITTEN_ELSEWHERE;
    }
    return RECORD_REFUSED;
}
