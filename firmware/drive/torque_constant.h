/*
 * The torque constant as the rotor shows it in motion, in the background of a sensorless drive.
 *
 * The estimate's speed is what the back-EMF says, Km_true w / Km; its angle is drawn along with the
 * rotor all the same. So over a while
 *
 *   sum of w_hat T / (change of theta_hat) - 1 = Km_true / Km - 1 = c
 *
 * What is left of R and of offsets errs it by so much over the back-EMF: it is learned from a
 * thirty-second of the supply on. Many a motor never turns so fast that it has an eighth of it. c
 * is bounded to +-20 %. What it is off by more than 3 % goes into the base of the speeds and into
 * what the interrupt has by it: the model, the reference's feed-forward, the decoupling: with the
 * interrupt held back meanwhile, so that it has all of the one or all of the other. The gains stay.
 * A speed of the present estimate stays what it is, a back-EMF.
 *
 * The setting initial_torque_constant_change is where it begins; `store` puts there what was
 * learned.
 */
#ifndef STEADYSTEP_TORQUE_CONSTANT_H
#define STEADYSTEP_TORQUE_CONSTANT_H

#include <stdint.h>

#include "firmware/interface/parts_carried.h"
#include "firmware/numeric/angle.h"
#include "firmware/numeric/num.h"

#define TORQUE_CONSTANT_CHANGE_MAX 0.2

struct torque_constant {
    num_t change;         /* c, learned */
    num_t in_force;       /* of it */
    struct position from; /* where the rotor was as it began to look */
    uint32_t begun;       /* period */
    uint32_t looked;
    int64_t travel; /* since, by the speed: 2^-32 turns */
};

struct drive;

/*
 * Background: c is this, and in force if it is far enough off; learning goes on from there. Of
 * another torque constant in the settings 0 is to be put.
 */
void torque_constant_put(struct drive *drive, num_t change);

/* Background: looks at a drive in operation, at each call. */
void torque_constant_background(struct drive *drive);

#endif
