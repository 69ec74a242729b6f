#include "firmware/drive/planned_end.h"

#include "firmware/design/refusal.h"
#include "firmware/design/text.h"
#include "firmware/drive/interrupt_view.h"

void planned_end_init(struct drive *drive)
{
    drive->planned_end.position = drive->reference.next.position;
    drive->planned_end.offset = drive->axis.offset;
    drive->planned_end.known = PLANNED_END_KNOWN;
}

void planned_end_update(struct drive *drive)
{
    const struct command_queue *queue = &drive->commands;

    if (queue->read == queue->written && !reference_busy(&drive->reference)) {
        drive->planned_end.position = drive->reference.next.position;
        drive->planned_end.offset = drive->axis.offset;
        if (!queue->stop.posted && (drive->planned_end.known != PLANNED_END_AFTER_ENABLING ||
                                    drive->supervision.state == DRIVE_OPERATION_ENABLED)) {
            drive->planned_end.known = PLANNED_END_KNOWN;
        }
    }
}

static bool refuse_before_stop(uint32_t at_period, char error[DRIVE_ERROR_TEXT])
{
    struct text text = text_in(error, DRIVE_ERROR_TEXT);

    text_put(&text, "move refused: a stop waits for period ");
    text_unsigned(&text, at_period);
    text_put(&text, ", and where it ends is not known");
    return false;
}

bool planned_end_require_no_stop(struct drive *drive, char error[DRIVE_ERROR_TEXT])
{
    planned_end_update(drive);
    if (drive->planned_end.known == PLANNED_END_AFTER_ENABLING) {
        return design_refuse(error, "move refused: the drive is not ready and where it starts is "
                                    "known only then");
    }
    if (drive->planned_end.known != PLANNED_END_AFTER_STOP) {
        return true;
    }
    return drive->commands.stop.posted &&
                   (int32_t)(drive->commands.stop.at_period - interrupt_view_period(drive)) > 0
               ? refuse_before_stop(drive->commands.stop.at_period, error)
               : design_refuse(error,
                               "move refused: the reference has not come to rest after the stop");
}

bool planned_end_require_in_range(struct drive *drive, struct position position,
                                  char error[DRIVE_ERROR_TEXT])
{
    const double range = POSITION_TURNS_MAX * drive->base.rad_per_turn;
    const double position_rad = position_to_rad(position_plus(position, drive->planned_end.offset),
                                                drive->settings.motor.rotor_teeth);

    return design_require_within(error, "move refused: the present position", position_rad, -range,
                                 range, "rad", "10^9 electrical turns; set-position takes it back");
}

bool planned_end_require_known(struct drive *drive, char error[DRIVE_ERROR_TEXT])
{
    return planned_end_require_no_stop(drive, error) &&
           (drive->planned_end.known == PLANNED_END_KNOWN ||
            design_refuse(error, "move refused: the reference follows a sine, set-points or a "
                                 "speed: stop it, or retarget")) &&
           planned_end_require_in_range(drive, drive->planned_end.position, error);
}

bool planned_end_require_rest(struct drive *drive, char error[DRIVE_ERROR_TEXT])
{
    planned_end_update(drive);
    return (drive->planned_end.known == PLANNED_END_KNOWN && !interrupt_view_moves(drive) &&
            !command_queue_holds_any(&drive->commands)) ||
           design_refuse(error, "set-position refused: the reference moves, or a command waits; "
                                "stop, and wait for rest");
}

void planned_end_note_enable(struct drive *drive)
{
    drive->planned_end.known = PLANNED_END_AFTER_ENABLING;
}

void planned_end_note_stop(struct drive *drive)
{
    if (drive->planned_end.known != PLANNED_END_AFTER_ENABLING) {
        drive->planned_end.known = PLANNED_END_AFTER_STOP;
    }
}

void planned_end_note_command(struct drive *drive, const struct queued_command *queued)
{
    if (queued_command_is_move(queued)) {
        drive->planned_end.position = queued->profile.target;
    } else if (queued->kind == DRIVE_COMMAND_RETARGET) {
        drive->planned_end.position = queued->request.target;
        drive->planned_end.known = PLANNED_END_KNOWN;
    } else if (queued_command_is_planned(queued) || queued->kind == DRIVE_COMMAND_TORQUE) {
        drive->planned_end.known = PLANNED_END_AFTER_MOTION;
    } else if (queued->kind == DRIVE_COMMAND_SET_POSITION) {
        drive->planned_end.offset = position_minus(queued->position, drive->planned_end.position);
    }
}
