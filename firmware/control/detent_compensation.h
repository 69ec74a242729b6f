/*
 * Detent torque of a hybrid stepper, learned and compensated: the harmonics 1, 2 and 4 of the
 * electrical angle phi (N, 2N and 4N per turn of the shaft).
 *
 *   T_detent(phi) = sum over h of a_h cos h phi + b_h sin h phi        opposes motion when positive
 *
 * The torque is known to observer and law as part of the load, so the load torque T_L that the
 * observer estimates is what remains. Its periodic part is the error of the coefficients, delayed
 * by the observer; it is correlated with the harmonics of the angle of that much earlier
 * (filtered-x least mean squares; Widrow and Stearns, Adaptive Signal Processing, ch. 11):
 *
 *   a_h += 2 k (T_L - m) cos h(phi - N w tau) |dphi|,   b_h likewise with sin,   dphi in turns
 *   m   += k_m (T_L - m) |dphi|                         the load itself
 *
 * - Steps are per angle, not per time: the same fit at every speed, none at rest, nothing
 *   forgotten.
 * - What the observer estimates does not depend on the position loop: the currents are measured. So
 *   learning closes a loop through the observer's delay alone, and that loop is stable as long as
 *   tau is right to a quarter of a period of the harmonic. Each harmonic therefore stops learning
 *   where h N w passes the observer's bandwidth, gradually from half of it.
 * - A harmonic is compensated up to h N w T = 0.6, gradually from 0.3: beyond, the rotor's inertia
 *   smooths it better than a sampled current could.
 * - dphi is the way of a follower of the angle that has a play of 1.25 counts, 1/64 electrical turn
 *   at least. Otherwise a rotor at rest whose estimate goes to and fro between counts would learn
 *   them, until they turn the spring of the position law around.
 * - Every coefficient is bounded to 15 % of the holding torque. A change of the load by more than
 *   that is not the detent torque's: m goes with it until the observer has it, and nothing is
 *   learned of it. A wrong torque turns the spring of a light rotor's position law around.
 */
#ifndef STEADYSTEP_DETENT_COMPENSATION_H
#define STEADYSTEP_DETENT_COMPENSATION_H

#include "firmware/motor/motor_params.h"
#include "firmware/motor/park.h"
#include "firmware/motor/per_unit.h"

enum { DETENT_HARMONICS = 3, DETENT_COEFFICIENTS = 2 * DETENT_HARMONICS };

/* Of the holding torque, sqrt 2 Km x rated current. */
#define DETENT_SHARE_MAX 0.15

/* A share of 1 up to a speed, and from there in a line to 0 at twice that speed. */
struct detent_fade {
    num_t speed;
    coef_t slope; /* 1 at that speed */
};

struct detent_compensation_params {
    int32_t play;                /* each way, 2^-32 turn */
    coef_t lag;                  /* electrical turns from the lag to the present angle, per speed */
    struct detent_fade learning; /* of the first harmonic */
    struct detent_fade playing;
    num_t residual_limit;      /* of T_L - m; beyond it the load has changed */
    uint32_t settling_periods; /* for which the observer then follows */
    num_t limit;               /* of a coefficient, scaled */
};

struct detent_compensation {
    num_t coefficient[DETENT_COEFFICIENTS]; /* a_1, b_1, a_2, b_2, a_4, b_4; scaled torque */
    num_t mean;                             /* m */
    uint32_t unsettled_periods;             /* of way for which the load is changing yet */
    num_t torque;                           /* at the angle of the last step */
    bool followed;                          /* since the bridge is on */
    angle_t follower;                       /* of the angle, by its play behind */
};

struct detent_compensation_task {
    const struct motor_params *motor;
    const struct per_unit *base;
    double period_s;
    double observer_bandwidth_rad_s; /* triple pole of the load estimate */
    uint32_t counts_per_turn;        /* of the encoder; 0: there is none */
};

__attribute__((cold)) struct detent_compensation_params
detent_compensation_design(const struct detent_compensation_task *task);

/* Start-up and background: the coefficients in N m, limited to what they are bounded to. */
__attribute__((cold)) void detent_compensation_set(struct detent_compensation *detent,
                                                   const struct detent_compensation_params *params,
                                                   const struct per_unit *base,
                                                   const double torque_Nm[DETENT_COEFFICIENTS]);
__attribute__((cold)) void detent_compensation_get(const struct detent_compensation *detent,
                                                   const struct per_unit *base,
                                                   double torque_Nm[DETENT_COEFFICIENTS]);

/* The bridge is switched on: what was learned is kept, nothing is known of the load. */
void detent_compensation_reset(struct detent_compensation *detent);

/*
 * One period. `frame` is that of `angle`, the predicted electrical angle at which the answer begins
 * to act; `load_torque` is the estimate without the detent. detent->torque is then that of `angle`.
 * `learns`: this period has time for it.
 */
__attribute__((noinline)) void
detent_compensation_step(struct detent_compensation *detent,
                         const struct detent_compensation_params *params, angle_t angle,
                         struct sincos frame, num_t speed, num_t load_torque, bool learns);

#endif
