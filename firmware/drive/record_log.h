/*
 * A log of records in two pages of the board's parameter store: what is to survive a power cycle.
 *
 * A record is written behind the last one; when the page is full, the other of the two is erased
 * and begun. So the last valid record is never erased, whenever the supply fails; unless the other
 * page is worn out, and the one page serves alone. The newest record with a right checksum counts.
 *
 *   offset  0  format, 2 bytes     little-endian throughout
 *           2  size of the record, 2 bytes
 *           4  sequence, 4 bytes   one more than that of the record before; may wrap
 *           8  payload
 *   size - 4   CRC-32 (IEEE 802.3) of all before, 4 bytes; then 0xff to whole words of the store
 */
#ifndef STEADYSTEP_RECORD_LOG_H
#define STEADYSTEP_RECORD_LOG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { RECORD_HEADER_BYTES = 8, RECORD_CHECK_BYTES = 4, RECORD_LOG_PAGES = 2 };

/* Bytes of a record around its payload. */
#define RECORD_BYTES(payload) (RECORD_HEADER_BYTES + (payload) + RECORD_CHECK_BYTES)

/* Room for a record in whole words of up to 16 bytes. */
#define RECORD_SLOT_BYTES(payload) ((RECORD_BYTES(payload) + 15) / 16 * 16)

/* Where a log lies and what its records are. */
struct record_log {
    uint32_t first_page;
    uint16_t format;
    uint16_t payload_bytes;
};

/* Numbers of up to 8 bytes, little-endian. */
void record_put(uint8_t *at, uint64_t value, int bytes);
uint64_t record_get(const uint8_t *at, int bytes);

/* Header and checksum around a payload that lies at record + RECORD_HEADER_BYTES already. */
void record_seal(const struct record_log *log, uint8_t *record, uint32_t sequence);

/* Whether it is a record of this log, unharmed. */
bool record_is_valid(const struct record_log *log, const uint8_t *record);

/*
 * The newest record, into `slot` of RECORD_SLOT_BYTES(payload). false: there is none, or the board
 * has no store that could hold one.
 */
bool record_log_read(const struct hal *board, const struct record_log *log, uint8_t *slot);

enum record_writing {
    /* The board has no store that could hold it, or refuses to write. The record before remains,
       but where one page alone serves and is now worn out, too. */
    RECORD_REFUSED,
    RECORD_WRITTEN,
    RECORD_WRITTEN_ELSEWHERE /* where it was to go the store is worn out */
};

/* Background. Seals the payload at slot + RECORD_HEADER_BYTES and appends it. */
enum record_writing record_log_write(const struct hal *board, const struct record_log *log,
                                     uint8_t *slot);

#ifdef __cplusplus
}
#endif

#endif
