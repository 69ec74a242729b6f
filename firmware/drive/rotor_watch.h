/*
 * What shows only beside the reference, in the background.
 *
 * A load that swings beyond the torque throws the rotor to and fro, or to one side, and no time off
 * its place lasts. The sign: the rotor is further off its reference than it may be, on the other
 * side than the last time or having come back by half of that, for the fourth time since a step,
 * each within 0.1 s of the last. It may be off by the following error, or without an encoder, where
 * the monitor's policy is to end in faults, by an electrical turn.
 *
 * The following error spares a rotor that comes back within 0.25 s. One that trembles seems to come
 * back at each look or the next. The sign: it is further off than it may be, and has not come back
 * by half of that in 0.125 s.
 *
 * With an encoder, a count that stands still at rest looks like a rotor at rest, and the observer
 * takes the torque that does not move it for the load's. The law answers it, and both rise to the
 * limit; a load beyond the limit moves the rotor by a count within milliseconds. The sign: for 30
 * ms no count with the q current's demand at its limit, at rest and in its place: a rotor that is
 * pressed against a stop is not.
 *
 * A rotor that turns otherwise than its encoder counts, as the count stands still under a load or
 * its channels are exchanged, shows in the winding: the current is not the one that the voltage and
 * the counted speed's back-EMF led to. The sign: in fifty samples in a row, of those that the
 * background could compare, currents that move are off by more than a share of the supply, half of
 * the currents' own voltages and half of the counted back-EMF would make them. Not of a law whose
 * voltage chatters: its current moves without a rotor.
 */
#ifndef STEADYSTEP_ROTOR_WATCH_H
#define STEADYSTEP_ROTOR_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/motor/park.h"
#include "firmware/numeric/angle.h"
#include "firmware/numeric/num.h"

struct rotor_watch {
    struct rotor_swing {
        uint32_t turned; /* period in which the side was another one last */
        num_t extreme;   /* the furthest since it was thrown, or the nearest since it came back */
        int8_t side;     /* of the reference; 0: not so far, or back */
        uint8_t times;   /* in a row */
    } swing;
    struct position reference; /* looked at last */
    uint32_t free;             /* the last period with a count, or in which none was due */
    struct phases expected;    /* current, in a period to come */
    uint32_t expected_in;
    uint8_t denied; /* samples in a row, up to DENIALS */
    int32_t count;
};

/* Nothing has been seen by then. */
void rotor_watch_reset(struct rotor_watch *watch, uint32_t period);

/* Where the rotor swings from now on is another thing. */
void rotor_watch_reset_swing(struct rotor_swing *swing);

/* Whether a rotor that was thrown for longer has not come back; of what rotor_watch_swings saw. */
bool rotor_watch_stays_away(const struct rotor_swing *swing, uint32_t period, uint32_t longer);

/* Whether the reference is further than this from where it was at the last look: a step, whose
   rotor may swing about it. */
bool rotor_watch_jumps(struct rotor_watch *watch, struct position reference, num_t limit);

/* Whether the rotor is thrown to and fro; error: reference less rotor. */
bool rotor_watch_swings(struct rotor_swing *swing, num_t error, num_t limit, uint32_t period,
                        uint32_t within);

struct rotor_winding {
    struct phases current, expected;
    num_t speed, resistance, reactance; /* the last at this speed */
    coef_t rate;                        /* current per voltage, in a period */
};

/* Whether the current is another rotor's than the one that is counted; margin: per-unit voltage
   that may be wrong. */
bool rotor_watch_winding_denies(const struct rotor_winding *winding, num_t margin);

/* A look: whether the winding denies the count, and what is expected of the next period. What was
   not looked at one behind the other says nothing. true: fifty in a row have denied it. */
bool rotor_watch_denies(struct rotor_watch *watch, bool denies, struct phases expected,
                        uint32_t period);

/* Whether no count has come for longer; pushed: the torque is at its limit, at rest and in place.
 */
bool rotor_watch_count_stands(struct rotor_watch *watch, int32_t count, bool pushed,
                              uint32_t period, uint32_t longer);

struct drive;

/* Background: looks at a drive in operation, at each call, for the sake of the counts. */
void rotor_watch_background(struct drive *drive);

#endif
