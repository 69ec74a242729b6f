/*
 * Commands on their way from the background to the control interrupt: one writer, one reader, no
 * lock. Moves and mode changes act in the order they were posted; disable and stop overtake them
 * and flush what was posted before.
 */
#ifndef STEADYSTEP_COMMAND_QUEUE_H
#define STEADYSTEP_COMMAND_QUEUE_H

#include "firmware/drive/drive_interface.h"
#include "firmware/motion/profile.h"

#define COMMAND_QUEUE_LENGTH 16u

struct queued_command {
    enum drive_command_kind kind;
    uint32_t at_period;
    struct profile profile; /* of a move */
};

/* A profile comes with it. */
static inline bool queued_command_is_move(const struct queued_command *command)
{
    return command->kind == DRIVE_COMMAND_MOVE_TRAPEZOID ||
           command->kind == DRIVE_COMMAND_MOVE_SMOOTH || command->kind == DRIVE_COMMAND_STEP;
}

/* A command that waits for nothing but its period; the last one posted counts. */
struct urgent_command {
    volatile bool posted;
    uint32_t at_period;
    uint32_t flush_to; /* queue entries posted before it */
};

struct command_queue {
    struct queued_command entry[COMMAND_QUEUE_LENGTH];
    volatile uint32_t written;
    volatile uint32_t read;
    volatile bool attention; /* something may wait: spares the interrupt to look at all of it */
    struct urgent_command disable;
    struct urgent_command stop;
};

/* Background: false if COMMAND_QUEUE_LENGTH - 1 wait; the last entry may be a profile in use. */
bool command_queue_put(struct command_queue *queue, const struct queued_command *command);

/* Background: `urgent` is one of the queue's own. */
void command_queue_put_urgent(struct command_queue *queue, struct urgent_command *urgent,
                              uint32_t at_period);

/* Interrupt: true once, when the period of `urgent` has come; flushes the queue. */
bool command_queue_take_urgent(struct command_queue *queue, struct urgent_command *urgent,
                               uint32_t period);

/*
 * Interrupt: the oldest command if its period has come, else NULL. It leaves the queue when
 * dropped; its profile keeps until the command after the next one is posted behind a full queue.
 */
struct queued_command *command_queue_due(struct command_queue *queue, uint32_t period);

void command_queue_drop(struct command_queue *queue);

/* Interrupt: lowers `attention` if nothing waits. The background cannot run in between. */
void command_queue_rest(struct command_queue *queue);

#endif
