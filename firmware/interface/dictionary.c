#include "firmware/interface/dictionary.h"

#include <string.h>

/* ---- commands ---- */

#define COMMAND_NAME(number, constant, name, required, optional, states, planning, sentence) name,

const char *drive_command_name(enum drive_command_kind kind)
{
    static const char *const names[DRIVE_COMMANDS] = {DRIVE_COMMANDS_TABLE(COMMAND_NAME)};

    return names[kind];
}

/* ---- signals ---- */

#define SIGNAL_ROW(index, member, brief, type)                                                     \
    {#member, brief, index, offsetof(struct drive_signals, member), type},
#define FLAG_SIGNAL(index, member, path, brief, ...)  SIGNAL_ROW(index, member, brief, SIGNAL_FLAG)
#define COUNT_SIGNAL(index, member, path, brief, ...) SIGNAL_ROW(index, member, brief, SIGNAL_COUNT)
#define REAL_SIGNAL(index, member, path, brief, ...)  SIGNAL_ROW(index, member, brief, SIGNAL_REAL)
#define NAMED_SIGNAL(index, member, path, brief, traced, type, sentence)                           \
    SIGNAL_ROW(index, member, brief, SIGNAL_IS_##type)

const struct signal_row *signal_at(enum drive_signal signal)
{
    static const struct signal_row rows[SIGNALS] = {
        DRIVE_SIGNALS_TABLE(FLAG_SIGNAL, COUNT_SIGNAL, REAL_SIGNAL, NAMED_SIGNAL, REAL_SIGNAL)};

    return &rows[signal];
}

double signal_get(const struct drive_signals *signals, const struct signal_row *signal)
{
    const uint8_t *at = (const uint8_t *)signals + signal->offset;
    uint32_t whole;
    double real;

    if (signal->type == SIGNAL_REAL) {
        memcpy(&real, at, sizeof real);
        return real;
    }
    if (signal->type == SIGNAL_FLAG ||
        (signal->type != SIGNAL_COUNT && sizeof(enum drive_state) == 1u)) {
        return *at;
    }
    memcpy(&whole, at, sizeof whole);
    return whole;
}

const char *signal_word(const struct signal_row *signal, double value)
{
    const int place =
        signal->type == SIGNAL_FLAG || signal->type >= SIGNAL_IS_drive_state ? (int)value : 0;

    switch (signal->type) {
    case SIGNAL_FLAG:
        return place != 0 ? "yes" : "no";
    case SIGNAL_IS_drive_state:
        return drive_state_name((enum drive_state)place);
    case SIGNAL_IS_drive_fault:
        return drive_fault_name((enum drive_fault)place);
    case SIGNAL_IS_drive_synchronism:
        return drive_synchronism_name((enum drive_synchronism)place);
    case SIGNAL_IS_drive_position_reference:
        return drive_position_reference_name((enum drive_position_reference)place);
    case SIGNAL_IS_drive_command_kind:
        return drive_command_name((enum drive_command_kind)place);
    default:
        return NULL;
    }
}

/* ---- faults ---- */

#define LIMIT(member) offsetof(struct drive_settings, member)
#define NO_LIMIT      FAULT_WITHOUT_LIMIT

#define FAULT_ROW(constant, code, name, cause, limit, position, remedy) {name, cause, code, limit},

static const struct fault_row faults[DRIVE_FAULTS] = {{"none", "", 0x0000, NO_LIMIT},
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
