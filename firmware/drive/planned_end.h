/*
 * Where the reference will rest when all posted commands have acted, as far as the background can
 * know: what an absolute move starts from. Written and read by the background alone.
 */
#ifndef STEADYSTEP_PLANNED_END_H
#define STEADYSTEP_PLANNED_END_H

#include "firmware/drive/command_queue.h"

/* Whether it is known where the next move starts. */
enum planned_end_known {
    PLANNED_END_KNOWN,
    PLANNED_END_AFTER_STOP,     /* where the reference comes to rest after a stop */
    PLANNED_END_AFTER_MOTION,   /* likewise after sine, set-points, velocity or torque */
    PLANNED_END_AFTER_ENABLING, /* where the rotor is when the drive is ready */
};

/* Positions that a motion may begin and end at, electrical turns either way. */
#define POSITION_TURNS_MAX 1e9

struct planned_end {
    struct position position; /* the last one that was known, the motor's */
    struct position offset;   /* from there to the user's coordinates: drive/axis.h */
    enum planned_end_known known;
};

struct drive;

/* Start-up. */
void planned_end_init(struct drive *drive);

/* With nothing waiting and the reference at rest it is there already, whatever became of the
   commands before. */
void planned_end_update(struct drive *drive);

/* Nothing that moves is taken between a stop and rest, nor before it is known where it starts.
   false: refused, reason in error. */
bool planned_end_require_no_stop(struct drive *drive, char error[DRIVE_ERROR_TEXT]);

/* An absolute move or the first set-point needs to know where it starts. */
bool planned_end_require_known(struct drive *drive, char error[DRIVE_ERROR_TEXT]);

/* An absolute motion from a position that is shown within 10^9 electrical turns: no distance is
   more than half of the range then. */
bool planned_end_require_in_range(struct drive *drive, struct position position,
                                  char error[DRIVE_ERROR_TEXT]);

/* set-position: the reference rests, and nothing waits that could move it. */
bool planned_end_require_rest(struct drive *drive, char error[DRIVE_ERROR_TEXT]);

/* What has been posted changes it: an enable, a stop, any other command. */
void planned_end_note_enable(struct drive *drive);
void planned_end_note_stop(struct drive *drive);
void planned_end_note_command(struct drive *drive, const struct queued_command *queued);

#endif
