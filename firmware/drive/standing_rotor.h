/*
 * A rotor that stands off its reference, in the background of a sensorless drive.
 *
 * A position law that is weak for its rotor may leave it where the hold does not begin, between two
 * detents or behind a load, and unseen at rest its estimate drifts. So a rotor for which the hold
 * waits, that stands within a quarter of an electrical turn of its reference, is to be held where
 * it is taken to be, and the hold's frame leads it back at the speed at which it creeps. It stands
 * if it has been within a thirty-second of a turn for four times the hold's delay: what swings by
 * more than four times as far is away again in less.
 */
#ifndef STEADYSTEP_STANDING_ROTOR_H
#define STEADYSTEP_STANDING_ROTOR_H

#include <stdint.h>

struct standing_rotor {
    int32_t place;   /* of the rotor, off its reference, 2^-32 electrical turn */
    uint32_t period; /* in which it came there, or its frame was led last */
};

/* A look at a rotor for which the hold waits, whose place off its reference is in 2^-32 turn: the
   place at which it stands; 0: it does not stand, or too far off. */
int32_t standing_rotor_look(struct standing_rotor *standing, int64_t place, uint32_t period,
                            uint32_t longer);

struct drive;

/* Background: looks at a drive in operation. */
void standing_rotor_background(struct drive *drive);

#endif
