/*
 * From commanded to real phase voltage: the period of delay and what the bridge takes away.
 *
 * The command of S(k) acts over S(k+1)...S(k+2); its mean is measured at S(k+2). The difference of
 * that measurement and the command that was in force is the bridge's loss: dead time, diodes and
 * switch resistance. It turns slowly against the control period, so the last one measured serves
 * both to know the voltage in force and to compensate the next command.
 *
 *   at S(k):  surprise = u - v,   loss += surprise,   v = command + loss
 *
 * with u measured over S(k-1)...S(k), and v the voltage that is expected over a period.
 */
#ifndef STEADYSTEP_ACTUATION_H
#define STEADYSTEP_ACTUATION_H

#include "firmware/motor/park.h"

/* More than any dead time takes, less than a failed voltage sensor would make of it: where it is
   reached, phase_watch.h calls the voltage wrong. */
#define ACTUATION_LOSS_MAX NUM(0.1)

struct actuation {
    struct phases command;  /* for S(k)...S(k+1); once modulated, for the period behind it */
    struct phases in_force; /* what is expected of it, less the loss */
    struct phases loss;     /* measured minus commanded */
};

static inline void actuation_reset(struct actuation *actuation)
{
    const struct phases none = {NUM(0.0), NUM(0.0)};

    actuation->command = none;
    actuation->in_force = none;
    actuation->loss = none;
}

/* Takes the mean voltage measured over S(k-1)...S(k): by how much it is another than expected. */
static inline struct phases actuation_observe(struct actuation *actuation, struct phases measured)
{
    const struct phases surprise = {measured.a - actuation->in_force.a,
                                    measured.b - actuation->in_force.b};

    actuation->loss.a = num_limit(actuation->loss.a + surprise.a, ACTUATION_LOSS_MAX);
    actuation->loss.b = num_limit(actuation->loss.b + surprise.b, ACTUATION_LOSS_MAX);
    return surprise;
}

/* What was measured before counts, where a measurement shows something else. */
static inline void actuation_preset_loss(struct actuation *actuation, struct phases loss)
{
    actuation->loss = loss;
}

/* Behind the loss: the command comes in force. Returns the voltage expected of it. */
static inline struct phases actuation_act(struct actuation *actuation)
{
    const struct phases voltage = {actuation->command.a + actuation->loss.a,
                                   actuation->command.b + actuation->loss.b};

    actuation->in_force = voltage;
    return voltage;
}

/* The command in force. */
static inline struct phases actuation_commanded(const struct actuation *actuation)
{
    const struct phases command = {actuation->in_force.a - actuation->loss.a,
                                   actuation->in_force.b - actuation->loss.b};

    return command;
}

/* What to command so that the motor gets `wanted`. */
static inline struct phases actuation_compensate(const struct actuation *actuation,
                                                 struct phases wanted)
{
    const struct phases command = {wanted.a - actuation->loss.a, wanted.b - actuation->loss.b};

    return command;
}

/* The command of S(k), as it was modulated. */
static inline void actuation_commit(struct actuation *actuation, struct phases command)
{
    actuation->command = command;
}

#endif
