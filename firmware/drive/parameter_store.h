/*
 * What a drive learns and keeps across power cycles, as records in the board's parameter store.
 *
 * A record is written behind the last one; when the page is full, the other of two pages is erased
 * and begun. So the last valid record is never erased, whenever the supply fails, and a page of
 * 2 KB is erased once in a hundred savings. The newest record with a right checksum counts.
 *
 *   offset  0  format, 2 bytes     little-endian throughout
 *           2  size, 2 bytes
 *           4  sequence, 4 bytes   one more than that of the record before
 *           8  detent torque a_1, b_1, a_2, b_2, a_4, b_4, 4 bytes each, in 1e-7 N m
 *          32  CRC-32 (IEEE 802.3) of all before, 4 bytes; then 0xff to whole words of the store
 */
#ifndef STEADYSTEP_PARAMETER_STORE_H
#define STEADYSTEP_PARAMETER_STORE_H

#include "firmware/drive/drive_interface.h"
#include "hal/hal.h"

/* Independent of the number format of the drive that writes and the one that reads. */
struct learned_parameters {
    double detent_torque_Nm[DRIVE_DETENT_COEFFICIENTS];
};

/* true: `learned` is the newest record of this board; false: there is none, it is not touched. */
bool parameter_store_read(const struct hal *board, struct learned_parameters *learned);

/* Background. false: the board has no store, or refused to write; the record before remains. */
bool parameter_store_write(const struct hal *board, const struct learned_parameters *learned);

#endif
