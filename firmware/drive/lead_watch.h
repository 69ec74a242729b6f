/*
 * Whether a rotor comes along that a hold leads, in the background; without an encoder.
 *
 * The back-EMF of a rotor that is led is less than the offset of a voltage measurement: no period
 * shows whether it is there. Over an electrical turn of the frame an offset leaves nothing, since
 * it stays where it is in phase coordinates, nor do two phases that are not alike; the rotor's
 * back-EMF stands along the frame's q axis. It is what the estimate makes of it, less what the
 * innovations deny, which show in the load's estimate (estimator/invariant_ekf.h, in a settled
 * hold):
 *
 *   e_q = Km w_hat + b_q - c nu_q,   nu_q = (dT_L/dk + k_r (T_L - T_settled)) / k_T
 *
 * c: estimator/synchronism_monitor.h. The sign: two turns in a row, in one direction, in which the
 * mean of e_q is less than a quarter of Km w. Of a sound rotor that lags by a load, and whose
 * inductance is a fifth off, half is left. It is a fault where the monitor's policy is to end in
 * faults; with another it is not said. Where a frame turns to and fro within a turn nothing shows.
 */
#ifndef STEADYSTEP_LEAD_WATCH_H
#define STEADYSTEP_LEAD_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/numeric/num.h"

struct lead_watch {
    uint32_t block; /* period in which the block of the monitor ended that was looked at last */
    num_t load;     /* as it was estimated then */
    num_t led;      /* electrical turns of the frame */
    num_t seen;     /* likewise, that the back-EMF shows */
    uint8_t unseen; /* turns in a row */
};

/* Nothing has been led by then. */
void lead_watch_reset(struct lead_watch *watch);

/* Background: whether the rotor is left, as of the last look. */
bool lead_watch_rotor_is_left(const struct lead_watch *watch);

/* Electrical turns that the frame has led since the last call, and that are seen. true: the rotor
   is left. */
bool lead_watch_is_left(struct lead_watch *watch, num_t led, num_t seen);

struct drive;

/* Background: looks at each block of a drive in operation. */
void lead_watch_background(struct drive *drive);

#endif
