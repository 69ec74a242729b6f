/*
 * The electronic data sheet, firmware/interface/steadystep.eds, as a client may read it from the
 * drive (CiA 306; object 1021h of CiA 301). An image carries it where it is built with
 * STEADYSTEP_DATA_SHEET: it takes a third as much flash again as all else.
 */
#ifndef STEADYSTEP_DATA_SHEET_H
#define STEADYSTEP_DATA_SHEET_H

#include <stdint.h>

enum { OBJECT_DATA_SHEET = 0x1021 };

extern const char *const data_sheet; /* NULL: the image is without it */
extern const uint32_t data_sheet_bytes;

#endif
