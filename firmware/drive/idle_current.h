/*
 * Less current in a hold at rest, for machines that rest for long: idle current reduction.
 *
 * Once the reference has rested for idle_delay_s and the estimated load has stayed where it is, the
 * hold current falls to idle_current_A, in ten times hold_ramp_s. It is back within hold_ramp_s as
 * soon as the reference moves or the estimated load has changed by a fifth of the rated torque.
 *
 * What is left is a torque of Km idle_current_A, and at rest nothing announces a load that grows
 * more slowly than the back-EMF shows: such a load pulls the rotor out beyond it.
 *
 * In the background. The interrupt reads one word of it, the current to which i_d* ramps.
 */
#ifndef STEADYSTEP_IDLE_CURRENT_H
#define STEADYSTEP_IDLE_CURRENT_H

#include "firmware/interface/drive_interface.h"
#include "firmware/motor/per_unit.h"
#include "firmware/numeric/num.h"

struct idle_current_params {
    num_t current; /* of the idle hold; that of any hold: there is none */
    num_t fall;    /* of it per period */
    uint32_t delay_periods;
};

struct idle_current {
    uint32_t period;  /* looked at last */
    uint32_t resting; /* periods for which nothing has happened, up to the delay */
    num_t load;       /* estimated, since then */
};

/* What is seen in a period. */
struct idle_look {
    uint32_t period;
    bool holds; /* a reference at rest */
    num_t load;
};

struct drive;

__attribute__((cold)) struct idle_current_params
idle_current_design(const struct drive_settings *settings, const struct per_unit *base,
                    double period_s);

/* The hold current that follows `now`; of a hold that has `full` where nothing is idle. */
num_t idle_current_step(struct idle_current *idle, const struct idle_current_params *params,
                        const struct idle_look *look, num_t now, num_t full);

/* Background: of a drive in operation. */
void idle_current_background(struct drive *drive);

#endif
