/*
 * The rows of faults_table.h as data: what every reader and writer of faults goes by.
 */
#ifndef STEADYSTEP_DICTIONARY_H
#define STEADYSTEP_DICTIONARY_H

#include "firmware/interface/settings.h"

#ifdef __cplusplus
extern "C" {
#endif

struct fault_row {
    const char *name;  /* as scenarios and the console spell it */
    const char *cause; /* in words */
    uint16_t limit;    /* offset in struct drive_settings of what stands behind it */
};

enum { FAULT_WITHOUT_LIMIT = UINT16_MAX };

const struct fault_row *fault_row(enum drive_fault fault);

/* The setting that limits, NULL: none. */
const struct setting *fault_limit(enum drive_fault fault);

/* dictionary_text.c: what no image needs to know. */
uint16_t fault_code(enum drive_fault fault); /* of an emergency message */
const char *fault_remedy(enum drive_fault fault);

#ifdef __cplusplus
}
#endif

#endif
