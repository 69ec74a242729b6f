/*
 * What shows only beside the reference, in the background.
 *
 * Without an encoder, where the monitor's policy is to end in faults: a load that swings beyond the
 * torque throws the rotor to and fro, with a sound estimate beside it, and no side of it lasts. The
 * sign: the rotor is an electrical turn behind its reference, ahead of it, and behind or ahead again
 * for the third time, each within 0.1 s of the last.
 *
 * With one: a count that stands still at rest looks like a rotor at rest, and the observer takes
 * the torque that does not move it for the load's. The law answers it, and both rise; a load that
 * rises so moves the rotor by a count within milliseconds. The sign: for 5 ms no count although the
 * q current has risen by 0.15 of its limit since the last, to 0.7 of it, as no friction asks for,
 * at rest and in its place: a rotor that is pressed against a stop is not.
 */
#ifndef STEADYSTEP_ROTOR_WATCH_H
#define STEADYSTEP_ROTOR_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/numeric/num.h"

struct rotor_watch {
    struct rotor_swing {
        uint32_t turned; /* period in which the side was another one last */
        int8_t side;     /* of the reference; 0: not yet so far */
        uint8_t turns;   /* in a row */
    } swing;
    uint32_t low; /* the last period in which the q current had not risen */
    int32_t count;
    num_t current; /* q, the least since that count */
};

/* Of an encoder's rotor. */
struct rotor_look {
    uint32_t period;
    int32_t count;
    num_t current; /* q */
    bool in_place; /* at rest, and there */
};

struct rotor_watch_params {
    num_t rise;       /* of the q current, that no load makes without a count */
    num_t high;       /* q current that is beyond friction */
    uint32_t periods; /* for which it has risen so high */
};

/* Whether the count stands still although the rotor must turn. */
bool rotor_watch_step(struct rotor_watch *watch, const struct rotor_watch_params *params,
                      const struct rotor_look *look);

/* Whether the rotor is thrown to and fro; error: reference less rotor, electrical turns. */
bool rotor_watch_swings(struct rotor_swing *swing, num_t error, uint32_t period, uint32_t within);

struct drive;

/* Background: looks at a drive in operation, at each call, for the sake of the counts. */
void rotor_watch_background(struct drive *drive);

#endif
