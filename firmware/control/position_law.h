/*
 * What every position law has in common. A law answers from the position error and the estimates at
 * the instant when its answer begins to act, S(k+1), in one of two ways:
 *
 *   current laws  give the torque-producing current; the shared current control
 *                 (current_control.h) turns it to a voltage
 *   voltage laws  give the voltage in the rotor frame themselves
 *
 * A law is a header and a source of its own and one line of the registry (position_laws.h). It has
 *
 *   struct <law>_law_params   constants, of coef_t and num_t only (they are hashed bit by bit)
 *   struct <law>_law_state    all zero at rest
 *   <law>_law_gains           the gains that may be given instead of bandwidths
 *   <law>_law_design          at start-up, from motor, period and bandwidths
 *   <law>_law_step            in the interrupt
 *   <law>_law_current_limit   where its constants have the limit that may fall in motion, or NULL
 */
#ifndef STEADYSTEP_POSITION_LAW_H
#define STEADYSTEP_POSITION_LAW_H

#include <stddef.h>

#include "firmware/design/refusal.h"
#include "firmware/motor/motor_params.h"
#include "firmware/motor/park.h"
#include "firmware/motor/per_unit.h"

/* A gain that a law can be given by name, SI, instead of deriving it from the bandwidths. */
struct law_gain {
    const char *name; /* as scenarios spell it, unit at its end where it has one */
    double min;
    double max;
};

struct law_gain_list {
    const struct law_gain *gain;
    size_t count;
};

/* No law takes more gains than this. */
enum { LAW_GAINS_MAX = 12 };

/* What a law is designed from. */
struct position_law_task {
    const struct motor_params *motor;
    const struct per_unit *base;
    double period_s;
    uint32_t delay_periods;         /* from samples to voltage: 1, or 0 in a simulation */
    double bandwidth_rad_s;         /* of the position loop */
    double current_bandwidth_rad_s; /* of the loop inside it */
    double speed_limit_rad_s;
    double current_limit_A;
    const double *gains; /* LAW_GAINS_MAX values in the order of <law>_law_gains; NaN: not given */
};

static inline bool law_gain_is_given(const struct position_law_task *task, size_t gain)
{
    return task->gains != NULL && task->gains[gain] == task->gains[gain];
}

/* The gain as given, or else what the bandwidths make of it. */
static inline double law_gain_or(const struct position_law_task *task, size_t gain, double derived)
{
    return law_gain_is_given(task, gain) ? task->gains[gain] : derived;
}

/* One period's inputs. References of speed and acceleration are zero without feed-forward. */
struct position_law_input {
    num_t position_error; /* electrical turns, reference minus estimate */
    num_t reference_speed;
    num_t reference_acceleration;
    num_t speed;
    num_t load_torque;
};

/* What a voltage law needs besides. Currents and voltages are in the rotor frame. */
struct voltage_law_input {
    struct position_law_input motion;
    num_t reference_jerk;          /* change of reference_acceleration per control period */
    num_t load_torque_change;      /* over the coming period, as far as it is known beforehand */
    struct dq current;             /* when the voltage begins to act */
    struct dq undisturbed_current; /* the same, had the demanded voltage acted and nothing else */
    struct dq innovation;          /* current measured at S(k) less the undisturbed one for it */
    num_t current_d_reference;     /* left over from the hold, else zero */
    num_t resistance;              /* in series with a phase, as calibrated */
    num_t voltage_limit;           /* magnitude of the voltage vector */
    angle_t angle;                 /* electrical, of the rotor */
    angle_t reference_angle;       /* electrical, of the reference */
};

struct voltage_demand {
    struct dq voltage;    /* of magnitude at most voltage_limit */
    num_t torque_current; /* the q current it is meant to drive, for show; 0 if the law has none */
};

#endif
