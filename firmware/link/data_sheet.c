#include "firmware/link/data_sheet.h"

#include <stddef.h>

#ifdef STEADYSTEP_DATA_SHEET /* the path of its bytes */

/* It stays in flash, where a core has its other constants copied to RAM. */
#ifdef __arm__
__attribute__((section(".flash.data_sheet")))
#endif
static const char bytes[] = {
#include STEADYSTEP_DATA_SHEET
    '\0'};

const char *const data_sheet = bytes;
const uint32_t data_sheet_bytes = sizeof bytes - 1u;

#else

const char *const data_sheet = NULL;
const uint32_t data_sheet_bytes = 0;

#endif
