/* What of faults only their page says. */
#include "firmware/interface/dictionary.h"

#ifndef STEADYSTEP_WITHOUT_SENTENCES

#define FAULT_CODE(constant, code, name, cause, limit, remedy)   code,
#define FAULT_REMEDY(constant, code, name, cause, limit, remedy) remedy,

uint16_t fault_code(enum drive_fault fault)
{
    static const uint16_t codes[DRIVE_FAULTS] = {0x0000, DRIVE_FAULTS_TABLE(FAULT_CODE)};

    return codes[fault];
}

const char *fault_remedy(enum drive_fault fault)
{
    static const char *const remedies[DRIVE_FAULTS] = {"", DRIVE_FAULTS_TABLE(FAULT_REMEDY)};

    return remedies[fault];
}

#endif
