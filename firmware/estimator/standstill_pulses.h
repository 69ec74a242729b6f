/*
 * The rotor's angle under load while it is held: what no current and no back-EMF shows at rest.
 *
 * Every millisecond a pulse of voltage is added to the hold, for a period, and taken back two
 * periods later. As with the impulses of initial_position.h, what the current at its end differs
 * from that of a motor without saturation has a part that does not change sign with the pulse: it
 * is along the flux of magnet and hold current,
 *
 *   r = m (e^(j phi) + i_0 / I_f),   I_f = Km / (N L)
 *
 * with i_0 the hold current and m what the impulses have shown when the drive was enabled, scaled
 * by the square of the flux. Sixteen pulses, in an order that leaves the rotor where it is, give
 * the angle phi, and with it the torque of the mean current, which at rest is the load. Where the
 * hold current of a phase passes zero under the pulses, the bridge takes more of those of one sign,
 * and this mean is not the hold current.
 *
 * How far a pulse carries the current depends on the iron and on an inductance that may be another
 * than the motor's file says. So the first sixteen are smaller, and those that follow grow or
 * shrink until the largest change of the current is 0.85 to 1 of what is allowed.
 */
#ifndef STEADYSTEP_STANDSTILL_PULSES_H
#define STEADYSTEP_STANDSTILL_PULSES_H

#include "firmware/estimator/impulse_order.h"
#include "firmware/motor/motor_model.h"

struct standstill_pulses_params {
    num_t voltage;          /* of a pulse at full strength */
    num_t largest_change;   /* of the current by a pulse, that is allowed */
    uint32_t pulse_periods; /* one or two */
    num_t current_max;      /* of a phase, for a pulse to have room below the trip */
    coef_t signal;          /* m, in sums of eight, per asymmetry of the impulses */
    coef_t per_response;    /* 1 / the change of the current that a pulse should make */
    coef_t per_magnet;      /* 1 / I_f */
    coef_t per_period;      /* 1 / the periods of all sixteen pulses */
    uint32_t rest_periods;  /* of the hold before the first pulse */
    uint32_t pause_periods; /* between sixteen and sixteen */
};

struct standstill_pulses {
    num_t signal;    /* m; 0: nothing is known of the iron, no pulses */
    num_t strength;  /* of the pulses, up to 1 */
    num_t largest;   /* change of the current since the first of sixteen */
    uint32_t period; /* of the present pulse, or of the rest before the first */
    uint32_t number;
    bool at_rest;
    struct phases command; /* of the hold, when the pulse began */
    struct phases sum;     /* of what the samples differ from that */
    struct phases current; /* sum of the hold currents, when the pulses began */
    struct phases mean;    /* of the currents of all periods */
    struct phases start;   /* hold current when the present pulse began */
    num_t response;        /* mean change of the current */
};

struct standstill_pulses_task {
    double period_s;
    double peak_A;        /* of the current, hold and pulse */
    double current_max_A; /* of both, whatever the hold carries */
    double hold_current_A;
    double hold_ramp_s;
    double impulse_peak_A; /* of the impulses of the initial position */
};

__attribute__((cold)) void standstill_pulses_design(struct standstill_pulses_params *params,
                                                    const struct motor_model_params *model,
                                                    const struct motor_params *motor,
                                                    const struct per_unit *base,
                                                    const struct standstill_pulses_task *task);

/* `asymmetry` that the impulses have shown, in sums of eight; 0: none. */
void standstill_pulses_reset(struct standstill_pulses *pulses,
                             const struct standstill_pulses_params *params, num_t asymmetry);

/* No hold: the next one begins with its rest, and with small pulses. */
void standstill_pulses_stop(struct standstill_pulses *pulses);

/*
 * What is sampled now shows pulse and iron: an estimator must not take it for the rotor's motion,
 * nor a compensation the difference of the voltages for what the bridge takes.
 */
bool standstill_pulses_blanks_sample(const struct standstill_pulses *pulses,
                                     const struct standstill_pulses_params *params);

/* At such an S(k), before the estimator: `expected` by its model since the pulse began. */
void standstill_pulses_sample(struct standstill_pulses *pulses,
                              const struct standstill_pulses_params *params, struct phases current,
                              struct phases expected);

/*
 * At S(k), after the control: adds to the voltage it wants, or takes the place of it. Where the
 * hold leaves no room before a pulse, the sixteen are given up and the rest begins anew. `current`:
 * as estimated at S(k). `loss`: what the bridge adds to a voltage in the hold (actuation.h), for
 * which what this returns is still compensated. true: the current in force is the pulse's, the
 * control must forget what it has made of it.
 */
bool standstill_pulses_add(struct standstill_pulses *pulses,
                           const struct standstill_pulses_params *params, struct phases current,
                           struct phases loss, struct phases *voltage);

/* What sixteen pulses have shown. */
struct standstill_angle {
    angle_t angle;         /* electrical, of the rotor */
    struct phases current; /* mean, pulses included: its torque has held the rotor there */
};

/* Whether the angle is found: in the period in which the last pulse has ended. Else `shown` is left
   as it is. */
bool standstill_pulses_result(struct standstill_pulses *pulses,
                              const struct standstill_pulses_params *params,
                              struct standstill_angle *shown);

#endif
