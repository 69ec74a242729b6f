/*
 * Whether each phase does what its voltage asks for. A lead that breaks leaves a current of zero, a
 * current sensor that is stuck one of any size; the control then pushes against what does not move,
 * and what really flows is not seen. The sign, of each phase: its current stands, within noise,
 * where the voltage that is left for it would have changed it by twice the rated current since,
 *
 *   sum of (|u - R i - e| - u_e - 0.6 R |i|) T/L,   e = Km w (-sin N theta, cos N theta)
 *
 * with u_e = 0.05 supply, and with an encoder the back-EMF that two counts more in a period make
 * its observer see; over the periods in which a current law misses its reference by 15 % of the
 * rated current, or a voltage law acts. But for feedback linearisation voltage laws may change
 * their voltage's sign from period to period: of these the sum is of |...| with the sign of
 * u - R i - e. They are looked at four and five periods apart in turn, as are all from a
 * sixteenth of an electrical turn a period on: half a turn leads from zero to zero of a current. A
 * rotor that has pulled out shows a back-EMF that is not its estimate's, too, but with currents
 * that follow. Without an encoder e is that of the reference, turned by what the estimate has been
 * beside it over the last 13 ms: with the reference's alone a rotor that lags, on a belt that
 * swings, was a broken lead.
 *
 * In a hold a stuck sensor lets the true current drift away, and the resistance that is found with
 * it: at the end of its range it is the sensor of the larger current.
 *
 * Before that is certain, the rotor may have left the estimate or a comparator have tripped. So it
 * is suspected before, and what else ends the operation and may come of it goes by its name
 * (state_machine.c). Signs: three looks in which a current stands while its
 * reference has gone away by 5 % of the rated current; in a hold, a phase without a current of
 * which 20 % of the rated are asked for, from one look to the next with the same asked for, or
 * standing. A rotor that is shaken takes its currents through zero, but with what is asked for, or
 * behind it. A voltage law has no such reference. Of two phases it is the one that is further off.
 *
 * In the background, by four looks at least; behind fourteen periods that it does not come to it
 * begins anew.
 */
#ifndef STEADYSTEP_PHASE_WATCH_H
#define STEADYSTEP_PHASE_WATCH_H

#include "firmware/interface/drive_interface.h"
#include "firmware/motor/park.h"
#include "firmware/motor/per_unit.h"
#include "hal/hal.h"

struct phase_watch_params {
    num_t voltage_error;  /* in which u - R i - e may be wrong */
    uint16_t lag_looks;   /* over which the lag is a mean */
    uint16_t noise_codes; /* within which a current stands */
};

/* Of phase a, then b. */
struct phase_watch {
    uint32_t period;  /* looked at last */
    uint16_t code[2]; /* at which the current stands */
    struct {
        uint8_t looks;  /* that have found it there */
        uint8_t missed; /* in which its reference was elsewhere, less the others since */
        bool followed;  /* its reference, at the last look */
    } count[2];
    uint8_t suspected; /* fault: what another one comes of */
    int32_t lag;       /* of the estimate behind the reference of late, 2^-32 turns */
    num_t wanted[2];   /* current, when it came to stand there */
    num_t pushed[2];   /* by how much its voltage would have changed it since */
};

/* What is seen of both in a period. */
struct phase_look {
    uint32_t period;
    uint16_t code[2];
    num_t push[2];   /* by how much the voltage would change the current in each period, at least */
    bool flows[2];   /* there is a current worth the name */
    num_t wanted[2]; /* current; by a voltage law 0 */
    num_t off[2];    /* by how much the current is another one */
    bool held;
    bool larger; /* the phase of the larger one */
};

struct drive;

__attribute__((cold)) struct phase_watch_params
phase_watch_design(const struct per_unit *base, const struct hal_facts *facts,
                   const struct drive_settings *settings);

/* The fault that shows, if one does. */
enum drive_fault phase_watch_step(struct phase_watch *watch,
                                  const struct phase_watch_params *params,
                                  const struct phase_look *look);

/* Outside operation nothing is suspected. */
void phase_watch_forget(struct phase_watch *watch);

/* Background: looks at a drive in operation, every fourth period or so. */
void phase_watch_background(struct drive *drive);

/* Whether the law's voltage may change its sign from period to period. */
bool phase_watch_chatters(const struct drive *drive);

#endif
