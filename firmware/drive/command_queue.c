#include "firmware/drive/command_queue.h"

#include <stdatomic.h>
#include <stddef.h>

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
    } else if (queued_command_is_planned(command)) {
        entry->request = command->request;
    } else if (command->kind == DRIVE_COMMAND_SET_POSITION) { /* of a drive at rest */
        entry->position = command->position;
    } else if (command->kind == DRIVE_COMMAND_TORQUE) {
        entry->torque = command->torque;
    }
    atomic_signal_fence(memory_order_release);
    queue->written = queue->written + 1u;
    command_queue_look_next(queue);
    return true;
}

/* The oldest entry that what is urgent will not flush. */
static uint32_t first_to_stay(const struct command_queue *queue)
{
    const struct urgent_command *const urgent[] = {&queue->disable, &queue->stop};
    uint32_t entry = queue->read;

    for (int i = 0; i < 2; i++) {
        if (urgent[i]->posted && (int32_t)(urgent[i]->flush_to - entry) > 0) {
            entry = urgent[i]->flush_to;
        }
    }
    return entry;
}

uint32_t command_queue_earliest(const struct command_queue *queue, uint32_t first)
{
    const uint32_t last = queue->entry[(queue->written - 1u) % COMMAND_QUEUE_LENGTH].at_period;

    return first_to_stay(queue) != queue->written && !has_come(last, first) ? last : first;
}

/* false: none waits, or the interrupt has just taken it, or it would come later than `at_period`.
 */
static bool join_waiting(const struct command_queue *queue, struct urgent_command *urgent,
                         uint32_t at_period)
{
    if (!urgent->posted || !has_come(urgent->at_period, at_period)) {
        return false;
    }
    urgent->flush_to = queue->written;
    return urgent->posted;
}

void command_queue_put_urgent(struct command_queue *queue, struct urgent_command *urgent,
                              uint32_t at_period)
{
    if (join_waiting(queue, urgent, at_period)) {
        return;
    }
    urgent->posted = false;
    urgent->at_period = at_period;
    urgent->flush_to = queue->written;
    atomic_signal_fence(memory_order_release);
    urgent->posted = true;
    command_queue_look_next(queue);
}

/* Whether the period has come; if not, `wait` lasts until then at most. */
static inline bool come_or_wait(uint32_t at_period, uint32_t period, uint32_t *wait)
{
    const int32_t left = (int32_t)(at_period - period);

    if (left > 0 && (uint32_t)left < *wait) {
        *wait = (uint32_t)left;
    }
    return left <= 0;
}

bool command_queue_take_urgent(struct command_queue *queue, struct urgent_command *urgent,
                               uint32_t period, uint32_t *wait)
{
    if (!urgent->posted || !come_or_wait(urgent->at_period, period, wait)) {
        return false;
    }
    urgent->posted = false;
    if ((int32_t)(urgent->flush_to - queue->read) > 0) {
        queue->read = urgent->flush_to;
    }
    return true;
}

bool command_queue_enable_waits(const struct command_queue *queue)
{
    const struct urgent_command *disable = &queue->disable;
    const bool disabled = disable->posted;
    uint32_t entry = queue->read;

    if (disabled && (int32_t)(disable->flush_to - entry) > 0) {
        entry = disable->flush_to;
    }
    for (; entry != queue->written; entry++) {
        const struct queued_command *command = &queue->entry[entry % COMMAND_QUEUE_LENGTH];

        if (command->kind == DRIVE_COMMAND_ENABLE &&
            (!disabled || has_come(disable->at_period, command->at_period))) {
            return true;
        }
    }
    return false;
}

struct queued_command *command_queue_due(struct command_queue *queue, uint32_t coming,
                                         uint32_t *wait)
{
    const uint32_t read = queue->read;
    struct queued_command *oldest = &queue->entry[read % COMMAND_QUEUE_LENGTH];

    if (queue->written == read || !come_or_wait(oldest->at_period, coming, wait)) {
        return NULL;
    }
    return oldest;
}

void command_queue_drop(struct command_queue *queue)
{
    queue->read = queue->read + 1u;
}

void command_queue_put_preemption(struct command_queue *queue, const struct preemption *preemption)
{
    struct preemption *own = &queue->preemption;

    own->posted = false;
    own->at_period = preemption->at_period;
    own->plan = preemption->plan;
    own->of_command = preemption->of_command;
    own->command = preemption->command;
    atomic_signal_fence(memory_order_release);
    own->posted = true;
    command_queue_look_next(queue);
}

void command_queue_withdraw_preemption(struct command_queue *queue)
{
    queue->preemption.posted = false;
}

const struct motion_plan *command_queue_preemption(struct command_queue *queue, uint32_t period,
                                                   uint32_t *wait)
{
    struct preemption *own = &queue->preemption;

    if (!own->posted || !come_or_wait(own->at_period, period, wait)) {
        return NULL;
    }
    own->posted = false;
    return own->of_command && own->command != queue->read ? NULL : own->plan;
}

void command_queue_accept_preemption(struct command_queue *queue)
{
    if (queue->preemption.of_command) {
        command_queue_drop(queue);
    }
}
