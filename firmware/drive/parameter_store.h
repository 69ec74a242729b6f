/*
 * What a drive learns and keeps across power cycles: records of format 1 in pages 0 and 1 of the
 * board's parameter store (drive/record_log.h). A page of 2 KB is erased once in a hundred savings.
 *
 *   payload 0  detent torque a_1, b_1, a_2, b_2, a_4, b_4, 4 bytes each, in 1e-7 N m
 */
#ifndef STEADYSTEP_PARAMETER_STORE_H
#define STEADYSTEP_PARAMETER_STORE_H

#include "firmware/interface/drive_interface.h"
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
