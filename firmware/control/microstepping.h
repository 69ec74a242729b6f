/*
 * Open-loop microstepping, Kim 2016 (4)-(5): a current vector of constant magnitude along the
 * reference, which the rotor follows like a compass needle; what every stepper driver without
 * feedback does. Kept as the yardstick.
 *
 *   i = I e^(j N theta*)        current_A, through the current control, or
 *   v = V e^(j N theta*)        voltage_V, as in (5), if it is given
 *
 * Written in the rotor frame, from which the caller turns it back: the estimate of the angle
 * cancels out, so the law is open-loop whatever the estimate is.
 */
#ifndef STEADYSTEP_MICROSTEPPING_H
#define STEADYSTEP_MICROSTEPPING_H

#include "firmware/control/current_control.h"
#include "firmware/control/position_law.h"

struct microstepping_law_params {
    struct current_control_params current_control;
    num_t current;
    num_t voltage; /* 0: current-controlled */
};

static inline num_t *microstepping_law_current_limit(struct microstepping_law_params *params)
{
    (void)params;
    return NULL; /* its current holds the rotor */
}

struct microstepping_law_state {
    struct current_control current_control; /* in the frame of the reference */
};

extern const struct law_gain_list microstepping_law_gains;

/* false: the current loop cannot bear its bandwidth, the limit in error. */
bool microstepping_law_design(struct microstepping_law_params *params,
                              const struct position_law_task *task, char error[DESIGN_ERROR_TEXT]);

struct voltage_demand microstepping_law_step(struct microstepping_law_state *state,
                                             const struct microstepping_law_params *params,
                                             const struct voltage_law_input *input);

#endif
