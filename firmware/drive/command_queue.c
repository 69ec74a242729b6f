#include "firmware/drive/command_queue.h"

static bool has_come(uint32_t at_period, uint32_t period)
{
    return (int32_t)(period - at_period) >= 0;
}

bool command_queue_put(struct command_queue *queue, const struct queued_command *command)
{
    struct queued_command *entry = &queue->entry[queue->written % COMMAND_QUEUE_LENGTH];

    if (queue->written - queue->read == COMMAND_QUEUE_LENGTH - 1u) {
        return false;
    }
    entry->kind = command->kind;
    entry->at_period = command->at_period;
    if (queued_command_is_move(command)) { /* else the profile here may still be moved along */
        entry->profile = command->profile;
    }
    queue->written = queue->written + 1u;
    queue->attention = true;
    return true;
}

void command_queue_put_urgent(struct command_queue *queue, struct urgent_command *urgent,
                              uint32_t at_period)
{
    urgent->posted = false;
    urgent->at_period = at_period;
    urgent->flush_to = queue->written;
    urgent->posted = true;
    queue->attention = true;
}

bool command_queue_take_urgent(struct command_queue *queue, struct urgent_command *urgent,
                               uint32_t period)
{
    if (!urgent->posted || !has_come(urgent->at_period, period)) {
        return false;
    }
    urgent->posted = false;
    if ((int32_t)(urgent->flush_to - queue->read) > 0) {
        queue->read = urgent->flush_to;
    }
    return true;
}

struct queued_command *command_queue_due(struct command_queue *queue, uint32_t period)
{
    struct queued_command *oldest = &queue->entry[queue->read % COMMAND_QUEUE_LENGTH];

    return queue->written != queue->read && has_come(oldest->at_period, period) ? oldest : NULL;
}

void command_queue_drop(struct command_queue *queue)
{
    queue->read = queue->read + 1u;
}

void command_queue_rest(struct command_queue *queue)
{
    queue->attention = queue->stop.posted || queue->disable.posted || queue->written != queue->read;
}
