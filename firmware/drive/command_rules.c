#include "firmware/drive/command_rules.h"

#include "firmware/design/refusal.h"
#include "firmware/design/text.h"
#include "firmware/drive/fault_reason.h"
#include "firmware/drive/interrupt_view.h"

#define OBEYED_IN(number, constant, name, required, optional, states, planning, sentence) states,

const uint8_t command_rules_states[DRIVE_COMMANDS] = {DRIVE_COMMANDS_TABLE(OBEYED_IN)};

/* Ready only since the command was asked for: it is as if it had been posted before. */
static bool ready_only_since(const struct drive *drive, uint32_t asked_in)
{
    const uint32_t since = interrupt_view_state_since(drive);
    const uint32_t now = interrupt_view_period(drive);

    return now - since < now - asked_in;
}

/* It acts in its turn, behind an enable that waits for a disable; a stop overtakes both. */
static bool acts_behind_enable(const struct drive *drive, enum drive_command_kind kind)
{
    return kind != DRIVE_COMMAND_STOP && drive->commands.disable.posted &&
           command_queue_enable_waits(&drive->commands);
}

/* Of the steps of enabling, any one stands for all. */
static enum drive_state state_found(const struct drive *drive, const struct drive_command *command,
                                    uint32_t asked_in)
{
    const enum drive_state state = drive_state_by(drive, command->at_period);
    const bool on_its_way =
        state == DRIVE_SWITCH_ON_DISABLED
            ? command_queue_enable_waits(&drive->commands)
            : state == DRIVE_OPERATION_ENABLED &&
                  (ready_only_since(drive, asked_in) || acts_behind_enable(drive, command->kind));

    return on_its_way ? DRIVE_CALIBRATING_OFFSETS : state;
}

static void explain(struct text *text, const struct drive *drive, enum drive_command_kind kind,
                    enum drive_state found)
{
    if (found == DRIVE_FAULT && kind == DRIVE_COMMAND_ENABLE) {
        text_put(text, "fault ");
        fault_reason_put(text, drive);
        text_put(text, "; disable clears it");
    } else if (found == DRIVE_FAULT) {
        text_put(text, "the drive is in fault, disable clears it");
    } else if (found != DRIVE_SWITCH_ON_DISABLED) {
        text_put(text, "the drive is being enabled, wait until it is ready");
    } else if (drive->commands.disable.posted) {
        text_put(text, "a disable acts in period ");
        text_unsigned(text, drive->commands.disable.at_period);
        text_put(text, ", enable the drive behind it");
    } else {
        text_put(text, "the drive is switch-on-disabled, enable it first");
    }
}

bool command_rules_check(const struct drive *drive, const struct drive_command *command,
                         uint32_t asked_in, char error[DRIVE_ERROR_TEXT])
{
    const enum drive_state found = state_found(drive, command, asked_in);
    struct text text;

    if (command->kind == DRIVE_COMMAND_STORE && drive->planner.motion != PLANNER_IDLE) {
        return design_refuse(error, "store refused: sine and set-points cannot wait for the "
                                    "writing; stop first");
    }
    if (command_rules_obeyed(command->kind, found)) {
        return true;
    }
    text = text_in(error, DRIVE_ERROR_TEXT);
    text_put(&text, drive_command_is(command->kind, DRIVE_PROFILE)
                        ? "move"
                        : drive_command_name(command->kind));
    text_put(&text, " refused: ");
    explain(&text, drive, command->kind, found);
    return false;
}
