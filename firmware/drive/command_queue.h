/*
 * Commands on their way from the background to the control interrupt: one writer, one reader, no
 * lock. Moves and mode changes act in the order they were posted; disable and stop overtake them
 * and flush what was posted before.
 *
 * The interrupt can pre-empt the background between any two instructions, never the other way
 * round, and there is one core: the order in which the background writes is all that counts. What
 * an entry holds is written before the flag or counter that shows it; a signal fence keeps the
 * compiler to that order. Whoever posts makes the queue due at once, by a period that has passed;
 * the interrupt then looks at all that waits and puts off what is not to act yet.
 */
#ifndef STEADYSTEP_COMMAND_QUEUE_H
#define STEADYSTEP_COMMAND_QUEUE_H

#include "firmware/drive/torque_mode.h"
#include "firmware/interface/drive_interface.h"
#include "firmware/motion/profile.h"
#include "firmware/motion/sine.h"

#define COMMAND_QUEUE_LENGTH 16u

/* What a planned command asks for, in the units of the reference; no profile comes with it. */
struct motion_request {
    struct motion_limits limits; /* turns per period^n; of a sine its peaks */
    struct position target;      /* of a retarget */
    double speed;                /* of a velocity */
    uint32_t interval_periods;   /* of set-points */
    struct sine sine;
};

struct queued_command {
    enum drive_command_kind kind;
    uint32_t at_period;
    union {
        struct profile profile;        /* of a move */
        struct motion_request request; /* of a command the background plans */
        struct position position;      /* of set-position, the user's */
        struct torque_mode torque;
    };
};

/* A profile comes with it. */
static inline bool queued_command_is_move(const struct queued_command *command)
{
    return drive_command_is(command->kind, DRIVE_PROFILE);
}

/* Planned by the background, which takes it out of the queue with the plan (planner.h). */
static inline bool queued_command_is_planned(const struct queued_command *command)
{
    return drive_command_is(command->kind, DRIVE_AHEAD);
}

/* A command that waits for nothing but its period. One of a kind waits at a time: of two, the
   earlier period counts, and what was posted before either is flushed. */
struct urgent_command {
    volatile bool posted;
    uint32_t at_period;
    volatile uint32_t flush_to; /* queue entries posted before it */
};

/* A plan that preempts what the reference does, in its period. */
struct preemption {
    volatile bool posted;
    uint32_t at_period;
    const struct motion_plan *plan;
    bool of_command;  /* false: of a stop */
    uint32_t command; /* queue entry that it obeys; leaves the queue with it */
};

struct command_queue {
    struct queued_command entry[COMMAND_QUEUE_LENGTH];
    volatile uint32_t written;
    volatile uint32_t read;
    volatile uint32_t due;    /* first period in which there may be something to do: all that the
                                 interrupt asks */
    volatile uint32_t looked; /* period in which all that waits was last looked at */
    struct urgent_command disable;
    struct urgent_command stop;
    uint32_t stop_acted_in; /* period of the last stop; the interrupt's */
    struct preemption preemption;
    uint32_t dropped; /* commands that found the drive in a state in which they are not obeyed
                         (command_rules.h), or a move another start; the interrupt's */
    enum drive_command_kind dropped_kind; /* of the last of them */
};

/* Background: false if COMMAND_QUEUE_LENGTH - 1 wait; the last entry may be a profile in use. */
bool command_queue_put(struct command_queue *queue, const struct queued_command *command);

/* Background: `urgent` is one of the queue's own; if it waits already, its at_period is the earlier
   of both periods afterwards. */
void command_queue_put_urgent(struct command_queue *queue, struct urgent_command *urgent,
                              uint32_t at_period);

/*
 * Interrupt, of the functions below with `wait`: it begins as COMMAND_QUEUE_NEVER and is lowered to
 * the periods until what they look at is to be looked at again.
 */
#define COMMAND_QUEUE_NEVER (UINT32_C(1) << 30)

/* Interrupt: true once, when the period of `urgent` has come; flushes the queue. */
bool command_queue_take_urgent(struct command_queue *queue, struct urgent_command *urgent,
                               uint32_t period, uint32_t *wait);

/* Background: a command that is put now waits for all that wait before it: the first period from
   `first` on in which it can act. */
uint32_t command_queue_earliest(const struct command_queue *queue, uint32_t first);

/* Background: an enable waits, for the disable's period or later if one waits, too. */
bool command_queue_enable_waits(const struct command_queue *queue);

/*
 * Interrupt: the oldest command if its period is `coming` or has come, else NULL: it is looked at a
 * period ahead, and in its period. It leaves the queue when dropped; its profile keeps until the
 * command after the next one is posted behind a full queue.
 */
struct queued_command *command_queue_due(struct command_queue *queue, uint32_t coming,
                                         uint32_t *wait);

/* Interrupt, of that command, if any, when it does not act: `wait`, or less if its period is
 * `coming`. */
static inline uint32_t command_queue_wait_of(const struct queued_command *command, uint32_t coming,
                                             uint32_t wait)
{
    return command != NULL && command->at_period == coming ? 1u : wait;
}

void command_queue_drop(struct command_queue *queue);

/* Interrupt: a command had been accepted, but what it was accepted for has not come. Counted, so
   that somebody hears. */
static inline void command_queue_count_dropped(struct command_queue *queue,
                                               const struct queued_command *command)
{
    queue->dropped++;
    queue->dropped_kind = command->kind;
}

/* Interrupt: whether there may be something to do in this period. */
static inline bool command_queue_is_due(const struct command_queue *queue, uint32_t period)
{
    return (int32_t)(period - queue->due) >= 0;
}

/* Interrupt: all that waits is looked at in this period, and in the next if something acts. */
static inline void command_queue_look(struct command_queue *queue, uint32_t period)
{
    queue->looked = period;
    queue->due = period;
}

/* Interrupt and background: all that waits is to be looked at in the next period; the oldest
   command may wait for the reference to rest. */
static inline void command_queue_look_next(struct command_queue *queue)
{
    queue->due = queue->looked;
}

/* Interrupt: the reference has taken a stop. */
static inline void command_queue_stop_acted(struct command_queue *queue, uint32_t period)
{
    queue->stop_acted_in = period;
}

/* Background: `plan` must live until the reference has done with it, or it is withdrawn. */
void command_queue_put_preemption(struct command_queue *queue, const struct preemption *preemption);

/* Background: the preemption that has not acted, if any, never will. */
void command_queue_withdraw_preemption(struct command_queue *queue);

/*
 * Interrupt: the plan whose period has come and whose command has not been flushed, once; else
 * NULL.
 */
const struct motion_plan *command_queue_preemption(struct command_queue *queue, uint32_t period,
                                                   uint32_t *wait);

/* Interrupt: the reference has accepted it; its command leaves the queue. */
void command_queue_accept_preemption(struct command_queue *queue);

/* Whether a disable or a stop waits. */
static inline bool command_queue_holds_urgent(const struct command_queue *queue)
{
    return queue->disable.posted || queue->stop.posted;
}

/* Whether commands wait in the queue; those that are urgent do not count. */
static inline bool command_queue_holds_any(const struct command_queue *queue)
{
    return queue->written != queue->read;
}

/* Interrupt, when nothing has acted: passes the queue by until something is posted, `wait` periods
   have passed, or the reference has come to rest. The background cannot run in between. */
static inline void command_queue_rest(struct command_queue *queue, uint32_t period, uint32_t wait)
{
    queue->due = period + wait;
}

/* Interrupt, when something has acted: passes the queue by if nothing else waits but what is
   urgent, for `wait` periods. */
static inline void command_queue_rest_if_empty(struct command_queue *queue, uint32_t period,
                                               uint32_t wait)
{
    if (queue->written == queue->read && !queue->preemption.posted) {
        command_queue_rest(queue, period, wait);
    }
}

#endif
