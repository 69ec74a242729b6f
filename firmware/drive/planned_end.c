#include "firmware/drive/planned_end.h"

#include "firmware/design/refusal.h"
#include "firmware/drive/drive.h"

void planned_end_init(struct drive *drive)
{
    drive->planned_end.position = drive->params.enabling.initial_position;
    drive->planned_end.known = PLANNED_END_KNOWN;
}

void planned_end_update(struct drive *drive)
{
    const struct command_queue *queue = &drive->commands;

    if (queue->read == queue->written && !reference_busy(&drive->reference)) {
        drive->planned_end.position = drive->reference.next.position;
        if (!queue->stop.posted && (drive->planned_end.known != PLANNED_END_AFTER_ENABLING ||
                                    drive->supervision.state == DRIVE_OPERATION_ENABLED)) {
            drive->planned_end.known = PLANNED_END_KNOWN;
        }
    }
}

bool planned_end_require_no_stop(struct drive *drive, char error[DRIVE_ERROR_TEXT])
{
    planned_end_update(drive);
    if (drive->planned_end.known == PLANNED_END_AFTER_ENABLING) {
        return design_refuse(error, "move refused: the drive is not ready and where it starts is "
                                    "known only then");
    }
    return drive->planned_end.known != PLANNED_END_AFTER_STOP ||
           design_refuse(error, "move refused: the reference has not come to rest after the stop");
}

bool planned_end_require_known(struct drive *drive, char error[DRIVE_ERROR_TEXT])
{
    return planned_end_require_no_stop(drive, error) &&
           (drive->planned_end.known == PLANNED_END_KNOWN ||
            design_refuse(error, "move refused: the reference follows a sine, set-points or a "
                                 "speed: stop it, or retarget"));
}

void planned_end_note_enable(struct drive *drive)
{
    planned_end_init(drive);
    if (drive->params.enabling.encoder_zero_known || drive->params.enabling.detects_position) {
        drive->planned_end.known = PLANNED_END_AFTER_ENABLING;
    }
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
    } else if (queued_command_is_planned(queued)) {
        drive->planned_end.known = PLANNED_END_AFTER_MOTION;
    }
}
