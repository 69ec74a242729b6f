#include "firmware/interface/dictionary.h"

/* ---- commands ---- */

#define COMMAND_NAME(number, constant, name, required, optional, states, planning, sentence) name,

const char *drive_command_name(enum drive_command_kind kind)
{
    static const char *const names[DRIVE_COMMANDS] = {DRIVE_COMMANDS_TABLE(COMMAND_NAME)};

    return names[kind];
}

/* ---- faults ---- */

#define LIMIT(member) offsetof(struct drive_settings, member)
#define NO_LIMIT      FAULT_WITHOUT_LIMIT

#define FAULT_ROW(constant, code, name, cause, limit, remedy) {name, cause, limit},

static const struct fault_row faults[DRIVE_FAULTS] = {{"none", "", NO_LIMIT},
                                                      DRIVE_FAULTS_TABLE(FAULT_ROW)};

const struct fault_row *fault_at(enum drive_fault fault)
{
    return &faults[fault];
}

const struct setting *fault_limit(enum drive_fault fault)
{
    return setting_at(faults[fault].limit);
}

const char *drive_fault_name(enum drive_fault fault)
{
    return faults[fault].name;
}
