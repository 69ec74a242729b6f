/* What of commands, signals and faults no image needs: hosts and pages do. */
#include "firmware/interface/dictionary.h"

#ifndef STEADYSTEP_WITHOUT_SENTENCES

#include <string.h>

/* ---- commands ---- */

#define WITH(member)      (1u << DRIVE_PARAMETER_##member)
#define ANY_STATE         "in any state"
#define OUTSIDE_FAULT     "unless in fault"
#define IN_OPERATION      "when ready"
#define READY_OR_DISABLED "when ready, at rest, or disabled"

#define PARAMETER_ROW(index, member, unit, least, most, sentence)                                  \
    {least, most, #member, unit, sentence, index, offsetof(struct drive_command, member)},
#define COMMAND_ROW(number, constant, name, required, optional, states, planning, sentence)        \
    {name, states, PLANNING_##planning, sentence, required, optional, number},

const struct parameter_row *parameter_at(enum drive_parameter parameter)
{
    static const struct parameter_row parameters[] = {DRIVE_PARAMETERS_TABLE(PARAMETER_ROW)};

    return &parameters[parameter];
}

#define PLANNING_AT_ONCE "in the background, at once"
#define PLANNING_URGENT  "before all that waits"
#define PLANNING_IN_TURN "in its turn"
#define PLANNING_PROFILE "in its turn, once the reference rests"
#define PLANNING_AHEAD   "planned ahead"

const struct command_row *command_at(enum drive_command_kind kind)
{
    static const struct command_row commands[] = {DRIVE_COMMANDS_TABLE(COMMAND_ROW)};

    return &commands[kind];
}

const struct parameter_row *parameter_of(enum drive_command_kind kind, size_t number)
{
    const unsigned all = (unsigned)command_at(kind)->required | command_at(kind)->optional;

    for (int i = 0; i < DRIVE_PARAMETERS; i++) {
        if ((all >> i & 1u) != 0u && number-- == 0u) {
            return parameter_at((enum drive_parameter)i);
        }
    }
    return NULL;
}

double parameter_get(const struct drive_command *command, const struct parameter_row *parameter)
{
    double value;

    memcpy(&value, (const char *)command + parameter->offset, sizeof value);
    return value;
}

void parameter_put(struct drive_command *command, const struct parameter_row *parameter,
                   double value)
{
    memcpy((char *)command + parameter->offset, &value, sizeof value);
}

/* ---- signals ---- */

#define SIGNAL_TEXT(index, member, path, brief, traced, sentence)                                  \
    {"", sentence, SIGNAL_IS_##traced},
#define ANGLE_TEXT(index, member, path, brief, traced, sentence)                                   \
    {"rad", sentence, SIGNAL_IS_##traced},
#define NAMED_TEXT(index, member, path, brief, traced, type, sentence)                             \
    {"", sentence, SIGNAL_IS_##traced},
#define REAL_TEXT(index, member, path, brief, traced, base, unit, sentence)                        \
    {unit, sentence, SIGNAL_IS_##traced},

const struct signal_text *signal_text(enum drive_signal signal)
{
    static const struct signal_text texts[SIGNALS] = {
        DRIVE_SIGNALS_TABLE(SIGNAL_TEXT, SIGNAL_TEXT, ANGLE_TEXT, NAMED_TEXT, REAL_TEXT)};

    return &texts[signal];
}

/* ---- faults ---- */

#define FAULT_REMEDY(constant, code, name, cause, limit, position, remedy) remedy,

const char *fault_remedy(enum drive_fault fault)
{
    static const char *const remedies[DRIVE_FAULTS] = {"", DRIVE_FAULTS_TABLE(FAULT_REMEDY)};

    return remedies[fault];
}

#endif
