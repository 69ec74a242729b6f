/*
 * The inductance that is found while the drive is enabled (inductance_measurement.h), in force.
 *
 * A winding is b = T/L to the estimator, and a flux L i. With a share c more of L than what is in
 * force, b falls to b / (1 + c), and each gain on a current's innovation, and the current
 * control's, rises by 1 + c: what follows of a flux, poles and damping, then stays as it was
 * designed. What else the settings' inductance decides of, checks and default bandwidths, goes by
 * the settings; so does all of it where what is found confirms them.
 */
#ifndef STEADYSTEP_INDUCTANCE_H
#define STEADYSTEP_INDUCTANCE_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/interface/parts_carried.h"
#include "firmware/numeric/num.h"

/* What a sound motor has less or more than its settings. */
#define INDUCTANCE_LESS_MAX 0.35
#define INDUCTANCE_MORE_MAX 0.6

struct drive;

/* How what is designed follows: a part in a period. */
struct inductance_put {
    num_t more;
    num_t less;   /* 1 / (1 + more) - 1 */
    uint8_t left; /* parts */
};

/* In the first hold: the inductance is by a share `more` above what is in force. false: beyond what
   is sound. It comes into force in as many calls of inductance_put_part() as `left` then says. */
__attribute__((noinline)) bool inductance_put(struct drive *drive, num_t more);

__attribute__((noinline)) void inductance_put_part(struct drive *drive);

/* Background. */
__attribute__((noinline)) double inductance_in_force_H(const struct drive *drive);

#endif
