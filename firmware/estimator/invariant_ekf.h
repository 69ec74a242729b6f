/*
 * Constant-gain invariant extended Kalman filter: rotor position, speed and load torque of a
 * stepper from its phase currents and voltages.
 *
 * The current model lives in phase coordinates; the innovation is expressed in the estimated
 * rotor frame, nu = e^(-j N theta) (i - i_hat), in which the error dynamics depend on speed and
 * d current only, so that one constant gain serves every speed. The gain from nu_d to the angle
 * changes sign with the direction of rotation and is therefore multiplied by sat(w / w_s).
 *
 *   predict with the voltage that is expected over the period (motor_model.h); at its end correct,
 *   with i_hat moved by what the voltage was another than expected:
 *   i_hat += k_i (i - i_hat)          w_hat  += k_w nu_q
 *   theta += k_td sat(w/w_s) nu_d + k_tq nu_q          k_td: in hold while a load step is followed
 *   T_L   += k_T nu_q
 *   b     += (k_bd sat(w/w_s) nu_d + k_bq nu_q) q      q: the q axis, in phase coordinates: the
 *                                                     rotor's; in hold the frame's, since what
 *                                                     swings with the rotor adds up in d
 *   R     += k_R i_d sum(nu_d)                         while holding, every few periods
 *
 * b is the offset of the voltage measurement, constant in phase coordinates, where the back-EMF
 * turns. In motion an offset shows as an angle error that turns with it, so in nu_d; at rest, where
 * the mean back-EMF is null, in nu_q.
 *
 * At rest no innovation distinguishes load and displacement; only the back-EMF of the rotor's own
 * motion does, and what is integrated of it walks away with noise and offset. So the hold follows
 * the load at once, but returns within 3 to 10 ms, load and angle together, to the load it had
 * settled at, and takes what lasts for an offset; unless the difference shows a load step: then
 * what is estimated is the load from there on, and of the offset stays what has lasted: the rest
 * was the motion of a rotor that crept under a slow load. Of small steps one in 10 ms is believed,
 * and further on to the same side none that an error of the resistance can make of the q current
 * which compensates the steps so far: so the estimate cannot run away with that. A rotor that is
 * led along a creeping reference passes its detent torque, and a machine may vibrate, which several
 * steps on end show: there what exceeds three times the mean difference of late is a step.
 *
 * A rotor that a slow load has displaced is not where the estimate has it, and shows that when it
 * is released: it swings with a back-EMF along d, too. So while a step is followed nu_d moves the
 * angle, where the rotor is ahead of the estimate by 1.5 times what it does in motion, else by half
 * of that.
 *
 * The resistance has some 20 ms to be found, so it need not move in every period: all that nu_d has
 * been since it moved last moves it by as much as if it had done so in each. i_d is its mean of
 * then and now: where an inductance is wrong nu_d is as the change of i_d, and a current that
 * swings leaves nothing of a product that is the change of a square.
 *
 * Gains: design/invariant_ekf_design.h.
 */
#ifndef STEADYSTEP_INVARIANT_EKF_H
#define STEADYSTEP_INVARIANT_EKF_H

#include "firmware/design/invariant_ekf_design.h"
#include "firmware/estimator/estimate.h"
#include "firmware/numeric/coefficients.h"

/* One set of gains, per-unit. */
struct invariant_ekf_gain_set {
    coef_t current;
    coef_t speed_q;
    coef_t angle_d; /* per unit of the clamped speed */
    coef_t angle_q; /* electrical turns per current */
    coef_t load_q;
    coef_t bias_per_turn; /* voltage in q per odd correction of the angle, electrical turns */
    coef_t bias_q;
    coef_t resistance;   /* per product of d current and d innovation */
    coef_t load_return;  /* share of its way back to the settled load, each period */
    coef_t angle_return; /* electrical turns per torque on that way */
    coef_t bias_return;  /* voltage in q per torque on that way */
    coef_t load_settle;  /* share of the settled load's way to the estimate, each period */
};

#define INVARIANT_EKF_GAIN_SET_COEFFICIENTS(X)                                                     \
    X(current, ekf_current)                                                                        \
    X(speed_q, ekf_speed_q)                                                                        \
    X(angle_d, ekf_angle_d)                                                                        \
    X(angle_q, ekf_angle_q)                                                                        \
    X(load_q, ekf_load_q)                                                                          \
    X(bias_per_turn, ekf_bias_per_turn)                                                            \
    X(bias_q, ekf_bias_q)                                                                          \
    X(resistance, ekf_resistance)                                                                  \
    X(load_return, ekf_load_return)                                                                \
    X(angle_return, ekf_angle_return)                                                              \
    X(bias_return, ekf_bias_return)                                                                \
    X(load_settle, ekf_load_settle)
COEFFICIENTS(invariant_ekf_gain_set, INVARIANT_EKF_GAIN_SET_COEFFICIENTS)

struct invariant_ekf_params {
    struct motor_model_params model;
    struct invariant_ekf_gain_set moving;
    struct invariant_ekf_gain_set holding;
    struct invariant_ekf_gain_set unloaded;  /* holding, where no load is expected */
    struct invariant_ekf_gain_set following; /* holding, after a load step */
    num_t odd_gain_speed;                    /* w_s */
    uint32_t following_periods;              /* how long a load step is followed */
    uint16_t rest_periods;                   /* behind that, in which none is */
    uint16_t swing_periods;                  /* in which a rotor swings into place */
    num_t load_step;                         /* what a settled hold takes for a step of the load */
    coef_t bias_settle;                      /* share per block of settled_bias' way to the bias */
    coef_t usual_memory;                     /* share per block of usual_change's way */
    coef_t feigned_share;                    /* of a change of the load, by what it makes of i_q */
};

struct invariant_ekf {
    struct estimate estimate;
    struct phases bias;         /* offset of the measured voltage */
    struct phases settled_bias; /* of it, what has lasted in a settled hold */
    num_t innovation_sum;       /* of nu_d since it was taken last; runs on if nobody does */
    num_t adapted_sum;   /* of those that the resistance has taken, for the synchronism monitor */
    num_t adapted_at;    /* i_d when it last did */
    num_t settled_load;  /* torque that a hold returns to */
    num_t step_limit;    /* beyond which a change of the load is a step */
    num_t usual_change;  /* three times the mean of the load's change of late */
    uint8_t swings;      /* of the load on end, a reversal twice; up to what vibrates */
    uint8_t calm_blocks; /* left until they are at an end */
    bool swung_up;       /* the last time */
    uint32_t following_periods; /* left of the gains that follow a load step, and of their rest */
    uint32_t swing_end;         /* of unloaded_periods, when the rotor has swung into place */
    uint32_t unloaded_periods;  /* left of the hold in which no load step is expected */
    num_t offset_load;          /* torque at whose q current settled_bias was found */
};

/* Per-unit parameters. */
__attribute__((cold)) struct invariant_ekf_params
invariant_ekf_scale(const struct motor_model_params *model, const struct per_unit *base,
                    const struct invariant_ekf_gains *moving,
                    const struct invariant_ekf_hold_gains *hold);

/*
 * At rest at a known position, without current and load. In the first `unloaded_periods` of holding
 * a torque is taken for a voltage offset that is still to be found, not for a load.
 */
__attribute__((cold)) void invariant_ekf_reset(struct invariant_ekf *ekf,
                                               const struct invariant_ekf_params *params,
                                               struct position position, num_t resistance,
                                               uint32_t unloaded_periods);

/* Carries the sum of nu_d over to the monitor's. */
static inline void invariant_ekf_carry_sum(struct invariant_ekf *ekf)
{
    ekf->adapted_sum = num_add_around(ekf->adapted_sum, ekf->innovation_sum);
    ekf->innovation_sum = NUM(0.0);
}

/* The sum of nu_d since the last call. In hold up to where the resistance was adapted last: what
   has come since then is still to adapt it. */
static inline num_t invariant_ekf_take_innovation_sum(struct invariant_ekf *ekf, bool held)
{
    num_t sum;

    if (!held) {
        invariant_ekf_carry_sum(ekf);
    }
    sum = ekf->adapted_sum;
    ekf->adapted_sum = NUM(0.0);
    return sum;
}

/* In hold, every few periods, at their end: by the innovations since the last call while a load
   step is followed the angle that is expected, half as much against the rotor's direction; and the
   resistance. Not if the hold leads its rotor, whose lag behind its frame shows in nu_d, too. */
void invariant_ekf_work_on_hold(struct invariant_ekf *ekf,
                                const struct invariant_ekf_params *params, bool leads);

/* A load step in a settled hold. Of the offset stays what has lasted: the rest may have been
 * motion. */
__attribute__((noinline)) void invariant_ekf_follow_step(struct invariant_ekf *ekf,
                                                         const struct invariant_ekf_params *params);

/* In a settled hold, once a block of the synchronism monitor: the lasting offset goes some of its
   way to the offset. Without a monitor it stays as the hold began with it. */
void invariant_ekf_settle_bias(struct invariant_ekf *ekf,
                               const struct invariant_ekf_params *params);

/*
 * As often: what counts as a step of the load, which is more where it swings, as that of a rotor
 * which is led and passes its detent torque, or one that has made several steps on end; and to the
 * side to which the load has gone since the offset was found. Without a monitor it stays, too.
 */
void invariant_ekf_watch_hold(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                              bool leads);

/* The load that a hold returns to is no more than what its q current bears: beyond that nothing
   anchors the estimate, and that of a rotor which rests walks away. */
static inline void invariant_ekf_bear(struct invariant_ekf *ekf, num_t most)
{
    ekf->settled_load = num_clamp(ekf->settled_load, -most, most);
}

/* At S(k): corrects what was predicted for it, and predicts S(k+1). The default path does not come
   here: invariant_ekf_step.h. */
__attribute__((noinline)) struct passage
invariant_ekf_observe(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                      const struct estimator_input *input);

static inline void invariant_ekf_begin(struct invariant_ekf *ekf,
                                       const struct invariant_ekf_params *params,
                                       const struct estimator_start *start)
{
    invariant_ekf_reset(ekf, params, start->position, start->resistance, start->unloaded_periods);
}

static inline void invariant_ekf_preset_current(struct invariant_ekf *ekf, struct phases current)
{
    ekf->estimate.current = current;
}

/*
 * A hold begins, and with it the load it returns to and the offset: those estimated in motion. Its
 * current comes, and what inductance and offsets make of that looks like a load: as of one that
 * vibrates, until a tenth of a second has been calm, more than usual is a step.
 */
__attribute__((noinline)) void invariant_ekf_settle(struct invariant_ekf *ekf,
                                                    const struct invariant_ekf_params *params);

/* The first hold is over: what is left of its unloaded periods is. */
static inline void invariant_ekf_expect_load(struct invariant_ekf *ekf)
{
    ekf->unloaded_periods = 0u;
}

/* What was taken for an offset of the measured voltage was something else, which is over. */
static inline void invariant_ekf_forget_bias(struct invariant_ekf *ekf)
{
    ekf->bias = (struct phases){NUM(0.0), NUM(0.0)};
    ekf->settled_bias = ekf->bias;
}

static inline void invariant_ekf_preset_rotor(struct invariant_ekf *ekf, const struct rotor *rotor)
{
    ekf->estimate.rotor = *rotor;
    ekf->settled_load = rotor->load_torque;
    ekf->offset_load = ekf->settled_load;
}

/*
 * Held: of the offset the part along the hold current, the d axis of `frame`, becomes that of
 * `known`. At rest it looks like the drop at the resistance.
 */
static inline void invariant_ekf_preset_bias_along(struct invariant_ekf *ekf, struct phases known,
                                                   struct sincos frame)
{
    struct phases *bias = &ekf->bias;
    const struct phases change = {known.a - bias->a, known.b - bias->b};
    const num_t along = park(change, frame).d;

    bias->a += num_mul_unit(along, frame.cos);
    bias->b += num_mul_unit(along, frame.sin);
    ekf->settled_bias = *bias;
}

#endif
