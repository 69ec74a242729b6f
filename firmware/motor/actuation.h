/*
 * From commanded to real phase voltage: the period of delay and what the bridge takes away.
 *
 * The command of S(k) acts over S(k+1)...S(k+2); its mean is measured at S(k+2). The difference of
 * that measurement and the command that was in force is the bridge's loss: dead time, diodes and
 * switch resistance. It turns slowly against the control period, so the last one measured serves
 * both to know the voltage in force and to compensate the next command.
 */
#ifndef STEADYSTEP_ACTUATION_H
#define STEADYSTEP_ACTUATION_H

#include "firmware/motor/park.h"

/* More than any dead time takes, less than a failed voltage sensor would make of it. */
#define ACTUATION_LOSS_MAX NUM(0.1)

struct actuation {
    struct phases present; /* commanded for S(k)...S(k+1) */
    struct phases past;    /* commanded for S(k-1)...S(k) */
    struct phases loss;    /* measured minus commanded */
};

static inline void actuation_reset(struct actuation *actuation)
{
    const struct phases none = {NUM(0.0), NUM(0.0)};

    actuation->present = none;
    actuation->past = none;
    actuation->loss = none;
}

/* Takes the mean voltage measured over S(k-1)...S(k). */
static inline void actuation_observe(struct actuation *actuation, struct phases measured)
{
    actuation->loss.a = num_limit(measured.a - actuation->past.a, ACTUATION_LOSS_MAX);
    actuation->loss.b = num_limit(measured.b - actuation->past.b, ACTUATION_LOSS_MAX);
}

/* What was measured before counts, where a measurement shows something else. */
static inline void actuation_preset_loss(struct actuation *actuation, struct phases loss)
{
    actuation->loss = loss;
}

/* The voltage in force over S(k)...S(k+1). */
static inline struct phases actuation_in_force(const struct actuation *actuation)
{
    const struct phases voltage = {actuation->present.a + actuation->loss.a,
                                   actuation->present.b + actuation->loss.b};
    return voltage;
}

/* What to command so that the motor gets `wanted`. */
static inline struct phases actuation_compensate(const struct actuation *actuation,
                                                 struct phases wanted)
{
    const struct phases command = {wanted.a - actuation->loss.a, wanted.b - actuation->loss.b};

    return command;
}

/* Without a delay the command committed last is what the next measurement shows. */
static inline void actuation_commit_past(struct actuation *actuation)
{
    actuation->past = actuation->present;
}

/* The command of S(k), as it was modulated. */
static inline void actuation_commit(struct actuation *actuation, struct phases command)
{
    actuation->past = actuation->present;
    actuation->present = command;
}

#endif
