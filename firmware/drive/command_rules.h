/*
 * What is legal when, in one table: the states of the drive in which a command is obeyed.
 * drive_command refuses by it what is posted for a state in which it will not be obeyed; the
 * control interrupt drops by it what has waited in the queue and finds the drive in another state
 * than was foreseen, a fault as a rule.
 */
#ifndef STEADYSTEP_COMMAND_RULES_H
#define STEADYSTEP_COMMAND_RULES_H

#include "firmware/drive/drive.h"

/* As commands_table.h names them. */
enum {
    ANY_STATE = (1 << DRIVE_STATES) - 1,
    OUTSIDE_FAULT = ANY_STATE & ~(1 << DRIVE_FAULT),
    IN_OPERATION = 1 << DRIVE_OPERATION_ENABLED,
    READY_OR_DISABLED = IN_OPERATION | 1 << DRIVE_SWITCH_ON_DISABLED
};

/* The states in which a command of each kind is obeyed, a bit for each state. An enable of a drive
   that is enabled already, or on its way, is obeyed by staying so. */
extern const uint8_t command_rules_states[DRIVE_COMMANDS];

/* Background and interrupt. */
static inline bool command_rules_obeyed(enum drive_command_kind kind, enum drive_state state)
{
    return (command_rules_states[kind] >> state & 1u) != 0u;
}

/*
 * Background: whether the command will be obeyed in the state that it will find, as far as that can
 * be foreseen. One asked for before the drive was ready is judged by the state of that period, be
 * it posted later. false: refused, with the state and what to do in `error`.
 */
bool command_rules_check(const struct drive *drive, const struct drive_command *command,
                         uint32_t asked_in, char error[DRIVE_ERROR_TEXT]);

#endif
