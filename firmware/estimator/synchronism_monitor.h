/*
 * Does the rotor still run with its estimate? Watches an invariant EKF while the drive is in
 * operation, in blocks of 1.6 ms, and distinguishes two things:
 *
 * Lost synchronism: the estimate no longer belongs to the rotor. A rotor that stands delta beside
 * its estimate induces, in the estimated frame, Km w (-sin N delta, cos N delta). The q part is
 * taken for speed; the d part is a voltage that no right estimate leaves unexplained:
 *
 *   e_d = c nu_d,   c = (1 - (1 - k_i) a) / b:   stationary voltage per innovation
 *
 *   lost if |mean of e_d over two blocks| >= V_0 + Km |w_hat| / 4 + r |i_d|
 *
 * V_0 stands for offsets of the voltage sensing and for what a quick change of load leaves, the
 * quarter for errors of Km and L (the sine of 15 degrees), r for the resistance as far as it is
 * not known: a twentieth of it if it is calibrated before operation or a hold that adapts it has
 * settled, else three quarters.
 *
 * In motion and in every hold. A rotor that a growing load draws out of a settled hold, whose
 * resistance is known by then, creeps past the quarter turn: there the mean over eight blocks has
 * the same bound with V_1 for V_0 and without r, and with the mean |w_hat| of these blocks. V_1 is
 * a quarter of V_0, or what a load leaves that the hold bears: it displaces the rotor, and with it
 * a part of the flux Km/N. Not in a hold that leads its rotor, nor for a tenth of a second behind
 * that: what passed for an offset or a resistance lies along another axis of the rotor by then, and
 * the rotor lags by a load that is not known.
 *
 * A load that vibrates swings a held rotor about its place: e_d swings with it, not in phase with
 * |w_hat|, which passes zero. In a hold that rests both bounds count its mean, V_0 by Km |w_hat| /
 * 2 more.
 *
 * On the opposite half-turn the estimate has a second equilibrium: it turns against the rotor,
 * and what is left in d, 0.4 Km |w_hat|, draws its angle along. Of a sound estimate nothing is left
 * there for long. Lost, too, in motion faster than the standing speed below of a known resistance,
 *
 *   if |mean of e_d over two blocks| >= Km |w_hat| / 4 + r |i_d| in four blocks in a row
 *
 * Stalled: the estimate is sound and says that the rotor does not follow:
 *   standing    all current is in use and yet the rotor stands, or seems to turn no faster than an
 *               error of the resistance that is not known yet feigns: at full current r i / Km
 *   unheld      all current is in use in a hold that rests, and yet the rotor turns, by V_1 / Km or
 *               more
 *   behind      all current is in use and yet the rotor falls further behind
 *   pull-out    a load of 1.6 times the rated torque, or, holding, a load angle of a quarter of an
 *               electrical turn, beyond which the current that holds the rotor yields
 *
 * Doubtful: half of what makes a loss, half of the load angle of pull-out, or no torque left.
 *
 * Limits. A rotor that stands radiates nothing: a wrong angle shows as soon as it moves, in motion
 * with V_0 / Km (1.6 rad/s on the reference motor) and more. Drawn out of its hold by a load that
 * grows so slowly that it never moves faster than V_1 / Km (0.4 rad/s), it is seen when it falls.
 */
#ifndef STEADYSTEP_SYNCHRONISM_MONITOR_H
#define STEADYSTEP_SYNCHRONISM_MONITOR_H

#include "firmware/estimator/estimate.h"

/* A block, of at least as many periods as it has steps in motion, and one: so long at 5 kHz and
 * more. */
#define SYNCHRONISM_BLOCK_S 1.6e-3
#define SYNCHRONISM_STEPS   8u

/* Of the limit: what counts as all of the current. */
#define FULL_CURRENT 0.99

struct synchronism_monitor_task {
    const struct motor_params *motor;
    const struct per_unit *base;
    const struct motor_model_params *model;
    double period_s;
    double current_gain_moving; /* k_i of the estimator, 0...1 */
    double current_gain_holding;
    double current_limit_A;     /* of the position law and of the hold */
    bool resistance_adapted;    /* in every hold */
    bool resistance_calibrated; /* and before operation, too */
};

struct synchronism_monitor_params {
    uint32_t block_periods;
    coef_t voltage_per_sum_moving; /* c, of a block's sum of innovations */
    coef_t voltage_per_sum_holding;
    coef_t voltage_per_current_at_first; /* r, until a hold has settled */
    coef_t voltage_per_current;          /* r, from then on */
    num_t voltage_floor;                 /* V_0 */
    num_t settled_floor;                 /* V_1 */
    num_t standing_speed_at_first; /* an error of the resistance may feign it; until a hold has
                                      settled */
    num_t standing_speed;          /* from then on */
    num_t full_current;
    num_t load_limit;
    uint32_t settled_blocks; /* of a hold, until it is */
};

enum synchronism { SYNCHRONISM_SURE, SYNCHRONISM_DOUBTFUL, SYNCHRONISM_STALLED, SYNCHRONISM_LOST };

struct synchronism_monitor {
    coef_t voltage_per_current; /* r as far as it is known now */
    num_t standing_speed;       /* likewise */
    num_t past_mean;            /* e_d of the last block, per-unit voltage */
    num_t disturbance;          /* magnitude of its mean over the last two */
    num_t settled;              /* mean of e_d over eight blocks of a hold */
    num_t swing;                /* likewise, of the speed's magnitude; else 0 */
    uint32_t held;              /* blocks at rest in a hold; in a row, as those below */
    uint32_t opposite;
    bool full; /* all current is in use */
    uint32_t standing;
    uint32_t behind;
    uint32_t pull_out;
    uint32_t doubtful; /* blocks left */
};

__attribute__((cold)) struct synchronism_monitor_params
synchronism_monitor_design(const struct synchronism_monitor_task *task);

/* Apart, so that the size of what it sets can be read off the image. */
__attribute__((noinline)) void
synchronism_monitor_reset(struct synchronism_monitor *monitor,
                          const struct synchronism_monitor_params *params);

/* ---- The steps of a block, each for a period of its own. ---- */

/* Takes the block's sum of innovations in d. */
void synchronism_monitor_take(struct synchronism_monitor *monitor,
                              const struct synchronism_monitor_params *params, num_t innovation_sum,
                              bool holding);

/* Whether the disturbance is more than a right estimate leaves: lost, or sure. */
enum synchronism synchronism_monitor_judge_voltage(struct synchronism_monitor *monitor,
                                                   const struct synchronism_monitor_params *params,
                                                   num_t speed, num_t i_d);

/* The same of a hold, by the mean over eight blocks; `leads`: of a rotor that its frame leads. */
enum synchronism synchronism_monitor_judge_hold(struct synchronism_monitor *monitor,
                                                const struct synchronism_monitor_params *params,
                                                num_t speed, bool leads);

/* In motion instead: whether the disturbance lasts, as on the opposite half-turn: lost, or sure. */
enum synchronism synchronism_monitor_judge_motion(struct synchronism_monitor *monitor,
                                                  const struct synchronism_monitor_params *params,
                                                  num_t speed, num_t i_d);

/* Whether the torque is used up in vain: stalled, or sure. `wanted`: the q current asked for. */
enum synchronism synchronism_monitor_judge_torque(struct synchronism_monitor *monitor,
                                                  const struct synchronism_monitor_params *params,
                                                  num_t wanted, num_t speed);

/* Whether the load is more than the motor can hold: stalled, or sure. */
enum synchronism synchronism_monitor_judge_load(struct synchronism_monitor *monitor,
                                                const struct synchronism_monitor_params *params,
                                                num_t load_torque);

/* Whether the rotor follows: stalled, or sure. `error`: reference less estimate, electrical turns;
   `deficit`: the same of the speeds. */
enum synchronism
synchronism_monitor_judge_following(struct synchronism_monitor *monitor,
                                    const struct synchronism_monitor_params *params, num_t error,
                                    num_t deficit);

/* In a hold: whether the load angle is that of pull-out: stalled, or sure. */
enum synchronism synchronism_monitor_judge_pull_out(struct synchronism_monitor *monitor,
                                                    num_t error);

/* What the block's other steps leave: doubtful, or sure. */
enum synchronism synchronism_monitor_judge_load_angle(struct synchronism_monitor *monitor);

#endif
