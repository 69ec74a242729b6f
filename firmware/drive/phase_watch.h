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
 * u - R i - e. They are looked at four and five periods apart in turn, and all currents four to
 * nine from a sixteenth of an electrical turn a period on: whatever the speed, in seven looks each
 * current differs by six tenths of its amplitude. One that is small may not, within noise; then no
 * more does the other phase's, and nothing is sure. A rotor that has pulled out shows a back-EMF
 * that is not its estimate's, too, but with currents that follow. Without an encoder e is that of
 * the reference, turned by what the estimate has been beside it over the last 13 ms: with the
 * reference's alone a rotor that lags, on a belt that swings, was a broken lead.
 *
 * In a hold a stuck sensor lets the true current drift away, and the resistance that is found with
 * it: at the end of its range it is the sensor of the larger current.
 *
 * A phase of a hold that stands at no current in three looks is open, with 20 % of the rated asked
 * for and a voltage that would have changed it by half of the rated. More is no sign there: the
 * bridge's dead time keeps the current of a rotor that is shaken at zero for as long.
 *
 * A converter that is alive is so by its noise, if by nothing else. It is dead that gives the very
 * same code of a current in 16 looks with a reference that has left it; or any code in 112, if its
 * codes were seen to scatter as it was calibrated (offset_calibration.h). If they were not, while
 * the other phase's change, and the rotor turns by an electrical turn, in which no current stays
 * within a code, or a settled hold's resistance moves by an eighth, as no winding's does so soon.
 *
 * Before that is certain, the rotor may have left the estimate or a comparator have tripped. So it
 * is suspected before, and what else ends the operation and may come of it goes by its name
 * (state_machine.c). Signs: three looks in which a current stands while its
 * reference has gone away by 5 % of the rated current; in a hold, a phase without a current of
 * which 20 % of the rated are asked for, from one look to the next with the same asked for, or
 * standing. A rotor that is shaken takes its currents through zero, but with what is asked for, or
 * behind it. A voltage law has no such reference. Of two phases it is the one that is further off.
 *
 * A voltage that is measured as far beside what was commanded as no bridge's loss is (actuation.h)
 * is one that is measured wrong, of a leg or of the bus, of which the duty was made. Eight looks
 * make sure, each without it counting against two; one is a suspicion, of which come a lost or
 * stalled estimate, a current beyond the trip and a following error. A leg that does not switch
 * looks the same. A bus voltage of which the share r is shown shows from 0.12 / |1 - r| of
 * the supply on.
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

struct phase_count {
    uint8_t looks : 3;    /* that have found its current where it stands */
    uint8_t followed : 1; /* its reference, at the last look */
    uint8_t missed : 4;   /* looks in which its reference was elsewhere, less the others since */
    uint8_t same;         /* looks in a row with the very code of the one before */
    uint8_t last;         /* the low byte of that */
};

/* Of phase a, then b. */
struct phase_watch {
    uint32_t period;  /* looked at last */
    uint16_t code[2]; /* at which the current stands */
    struct phase_count count[2];
    uint8_t suspected;  /* fault: what another one comes of */
    uint8_t apart;      /* periods that the next look is later than it might be */
    uint8_t resistance; /* low byte of the look's, when a code last changed of two that do */
    uint8_t wrong;      /* looks with a wrong voltage, less twice those without */
    int32_t lag;        /* of the estimate behind the reference of late, 2^-32 turns */
    num_t wanted[2];    /* current, when it came to stand there */
    num_t pushed[2];    /* by how much its voltage would have changed it since */
};

/* What is seen of both in a period. */
struct phase_look {
    uint32_t period;
    uint16_t code[2];
    num_t push[2];   /* by how much the voltage would change the current in each period, at least */
    bool flows[2];   /* there is a current worth the name */
    bool noisy[2];   /* as its sensor was calibrated its codes scattered */
    num_t wanted[2]; /* current; by a voltage law 0 */
    num_t off[2];    /* by how much the current is another one */
    uint16_t resistance; /* 2^-10 per unit */
    uint16_t eighth;     /* of the nominal one */
    bool held;
    bool settled;       /* and for so long that its resistance is found */
    bool turns;         /* by an electrical turn within the looks of one code */
    bool fast;          /* by one within sixteen periods */
    bool larger;        /* the phase of the larger one */
    bool voltage_wrong; /* what is measured of a leg is not what was commanded */
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
