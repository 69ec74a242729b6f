/*
 * What the background reads of what the control interrupt writes, all of it in one place.
 *
 * The interrupt can come between any two instructions of the background, never the other way round,
 * and there is one core. A value of one word is therefore either the old or the new one, as long as
 * the compiler reads it exactly once and where it stands: hence volatile. What is longer is copied
 * and copied again if an interrupt has come in between. The members themselves are not volatile,
 * as that would cost the interrupt, which nothing pre-empts.
 *
 * Not here: the command queue, both sides of which stand in command_queue.c, and what is read of a
 * reference at rest, which the interrupt leaves alone.
 */
#ifndef STEADYSTEP_INTERRUPT_VIEW_H
#define STEADYSTEP_INTERRUPT_VIEW_H

#include <stdatomic.h>

#include "firmware/drive/drive.h"

/* Read once, here. */
#define INTERRUPT_VIEW(type, member) (*(type const volatile *)&(member))

/* Index of the present or last control interrupt. */
static inline uint32_t interrupt_view_period(const struct drive *drive)
{
    return INTERRUPT_VIEW(uint32_t, drive->supervision.period);
}

static inline enum drive_state interrupt_view_state(const struct drive *drive)
{
    return INTERRUPT_VIEW(enum drive_state, drive->supervision.state);
}

/* Period in which the state was entered. */
static inline uint32_t interrupt_view_state_since(const struct drive *drive)
{
    return INTERRUPT_VIEW(uint32_t, drive->supervision.state_since);
}

static inline enum drive_synchronism interrupt_view_synchronism(const struct drive *drive)
{
    return INTERRUPT_VIEW(enum drive_synchronism, drive->synchronism.shown);
}

/* Commands that found another state or place than they had been accepted for. */
static inline uint32_t interrupt_view_commands_dropped(const struct drive *drive)
{
    return INTERRUPT_VIEW(uint32_t, drive->commands.dropped);
}

static inline bool interrupt_view_brake_rests(const struct drive *drive)
{
    return INTERRUPT_VIEW(bool, drive->brake.rests);
}

/* The plan that the reference has begun last. */
static inline const struct motion_plan *interrupt_view_plan(const struct drive *drive)
{
    return INTERRUPT_VIEW(const struct motion_plan *, drive->reference.plan);
}

/* Whether the reference is within a profile or a plan. */
static inline bool interrupt_view_moves(const struct drive *drive)
{
    return INTERRUPT_VIEW(enum reference_phase, drive->reference.phase) != REFERENCE_REST;
}

/* Speed of the reference. */
static inline num_t interrupt_view_speed(const struct drive *drive)
{
    return INTERRUPT_VIEW(num_t, drive->reference.now.speed);
}

/* Whether a torque is commanded, and no position. */
static inline bool interrupt_view_torque(const struct drive *drive)
{
    return INTERRUPT_VIEW(num_t, drive->torque.speed) != NUM(0.0);
}

/* Counts resets of the reference, stops of its plans, and begins of torque mode. */
static inline uint32_t interrupt_view_epoch(const struct drive *drive)
{
    return INTERRUPT_VIEW(uint32_t, drive->reference.epoch);
}

/* Whether the hold has the rotor. */
static inline bool interrupt_view_holds(const struct drive *drive)
{
    return INTERRUPT_VIEW(bool, drive->hold.active);
}

/* For how many periods the reference has been slow. */
static inline uint32_t interrupt_view_slow_periods(const struct drive *drive)
{
    return INTERRUPT_VIEW(uint32_t, drive->reference.slow_periods);
}

/* Whether the hold has the rotor, and its frame rests. */
static inline bool interrupt_view_rests(const struct drive *drive)
{
    return INTERRUPT_VIEW(bool, drive->hold.active) && !INTERRUPT_VIEW(bool, drive->hold.leads);
}

/* Estimated load torque. */
static inline num_t interrupt_view_load(const struct drive *drive)
{
    return INTERRUPT_VIEW(num_t, drive->estimator.estimate.rotor.load_torque);
}

#undef INTERRUPT_VIEW

/* Makes `copy` what `from` is behind one interrupt, whose period is `period`. */
#define INTERRUPT_COPY(drive, period, copy, from)                                                  \
    do {                                                                                           \
        (period) = interrupt_view_period(drive);                                                   \
        atomic_signal_fence(memory_order_seq_cst);                                                 \
        (copy) = (from);                                                                           \
        atomic_signal_fence(memory_order_seq_cst);                                                 \
    } while ((period) != interrupt_view_period(drive))

/* The reference as it is behind one interrupt, whose period is returned. */
static inline uint32_t interrupt_view_reference(const struct drive *drive, struct reference *copy)
{
    uint32_t period;

    INTERRUPT_COPY(drive, period, *copy, drive->reference);
    return period;
}

/* The encoder likewise, of an estimator that has one. */
static inline struct encoder interrupt_view_encoder(const struct drive *drive)
{
    const struct encoder *encoder = estimator_encoder(&drive->estimator, &drive->params.estimator);
    struct encoder copy;
    uint32_t period;

    INTERRUPT_COPY(drive, period, copy, *encoder);
    return copy;
}

#undef INTERRUPT_COPY

#endif
