/*
 * The settings of a drive as a record in the parameter store, pages 2 and 3 (drive/record_log.h,
 * format 0x5305). Independent of number format, compiler and layout of structs: entries by the
 * index of their setting (interface/settings_table.h), so that a record survives settings that are
 * added, moved or dropped. What comes back is what went in, bit for bit; what a record does not
 * have, keeps its default, and what the firmware does not know is passed over.
 *
 *   entry   0   key, 2 bytes, little-endian: index, and in the two highest bits the size of the
 *               value: 0, 1 and 2 for 1, 4 and 8 bytes
 *           2   value: a flag or a choice 1 byte, a whole number 4, a real number the 8 bytes of
 *               its IEEE 754 double, which is left out where it is NaN, not given
 *
 * A key of 0 ends them.
 */
#ifndef STEADYSTEP_SETTINGS_RECORD_H
#define STEADYSTEP_SETTINGS_RECORD_H

#include "firmware/interface/drive_interface.h"
#include "firmware/drive/record_log.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    SETTINGS_RECORD_FIRST_PAGE = 2,
    SETTINGS_RECORD_FORMAT = 0x5305,
    SETTINGS_RECORD_PAYLOAD = 772, /* all of them, and room for a dozen more numbers */
    SETTINGS_RECORD_BYTES = RECORD_BYTES(SETTINGS_RECORD_PAYLOAD)
};

/* The whole record, header and checksum included; a store takes it at the begin of page 2. */
void settings_record_encode(const struct drive_settings *settings, uint32_t sequence,
                            uint8_t record[SETTINGS_RECORD_BYTES]);

/* false: no record of this format, harmed, without a whole motor, or with a choice that this
   firmware does not know. */
bool settings_record_decode(struct drive_settings *settings,
                            const uint8_t record[SETTINGS_RECORD_BYTES]);

/* The newest record in the board's store. false: there is none; `settings` is not touched. */
bool settings_record_read(const struct hal *board, struct drive_settings *settings);

/* Background, up to 35 ms, where the store is worn out twice that. */
enum record_writing settings_record_write(const struct hal *board,
                                          const struct drive_settings *settings);

#ifdef __cplusplus
}
#endif

#endif
