/*
 * One period of the invariant EKF (invariant_ekf.h), compiled into its place in the control
 * interrupt.
 */
#ifndef STEADYSTEP_INVARIANT_EKF_STEP_H
#define STEADYSTEP_INVARIANT_EKF_STEP_H

#include "firmware/estimator/invariant_ekf.h"

/* Corrections that differ between motion and hold. */
struct invariant_ekf_correction {
    num_t turns;  /* of the angle */
    num_t bias_q; /* of the voltage offset, along a q axis: the rotor's; in hold the frame's */
    num_t load_torque;
};

/* The angle's correction by nu_d, which is odd in the speed. */
static inline num_t invariant_ekf_odd_turns(const struct invariant_ekf_params *params,
                                            const struct invariant_ekf_gain_set *gains, num_t speed,
                                            num_t innovation_d)
{
    const struct invariant_ekf_gain_set *gain = KNOWN(invariant_ekf_gain_set, gains);
    const num_t full = params->odd_gain_speed;
    const num_t direction = num_clamp(speed, -full, full);

    return num_mul(innovation_d, num_mul_large(direction, gain->angle_d));
}

static inline struct invariant_ekf_correction
invariant_ekf_correct_in_motion(const struct invariant_ekf_params *params, num_t speed,
                                struct dq innovation)
{
    const struct invariant_ekf_gain_set *gain = KNOWN(invariant_ekf_gain_set, &params->moving);
    const num_t odd = invariant_ekf_odd_turns(params, gain, speed, innovation.d);

    return (struct invariant_ekf_correction){
        .turns = odd + num_mul_coef(innovation.q, gain->angle_q),
        .bias_q = num_mul_small_nearest(odd, gain->bias_per_turn),
        .load_torque = num_mul_large(innovation.q, gain->load_q)};
}

/* `away`: of the load from the one settled at. */
static inline struct invariant_ekf_correction
invariant_ekf_correct_in_hold(const struct invariant_ekf_gain_set *gains, struct dq innovation,
                              num_t away)
{
    const struct invariant_ekf_gain_set *gain = KNOWN(invariant_ekf_gain_set, gains);

    return (struct invariant_ekf_correction){
        .turns =
            num_mul_coef(innovation.q, gain->angle_q) + num_mul_small(away, gain->angle_return),
        .bias_q = num_mul_coef_nearest(innovation.q, gain->bias_q) -
                  num_mul_small_nearest(away, gain->bias_return),
        .load_torque =
            num_mul_large(innovation.q, gain->load_q) - num_mul_small(away, gain->load_return)};
}

static inline num_t invariant_ekf_away_from_settled_load(const struct invariant_ekf *ekf)
{
    return ekf->estimate.rotor.load_torque - ekf->settled_load;
}

/* What the sample shows beside what was expected of it. */
struct invariant_ekf_innovation {
    struct phases current; /* as it was expected */
    struct phases error;   /* measured minus expected */
    struct dq in_frame;    /* the error in the estimated rotor frame */
};

static inline struct invariant_ekf_innovation
invariant_ekf_innovate(const struct estimate *x, struct phases measured, struct phases surprise)
{
    const struct phases current = forced_current(&x->winding, x->next.current, surprise);
    const struct phases error = {measured.a - current.a, measured.b - current.b};

    return (struct invariant_ekf_innovation){current, error, park(error, x->next.frame)};
}

/* `bias_frame`: in which the offset is corrected along q. */
__attribute__((always_inline)) static inline void
invariant_ekf_correct(struct invariant_ekf *ekf, const struct invariant_ekf_gain_set *gains,
                      const struct invariant_ekf_innovation *innovation,
                      struct invariant_ekf_correction by, struct sincos bias_frame)
{
    const struct invariant_ekf_gain_set *gain = KNOWN(invariant_ekf_gain_set, gains);
    struct estimate *x = &ekf->estimate;
    const struct outlook *expected = &x->next;

    x->current.a = innovation->current.a + num_mul_large(innovation->error.a, gain->current);
    x->current.b = innovation->current.b + num_mul_large(innovation->error.b, gain->current);
    x->rotor.speed = expected->speed + num_mul_coef(innovation->in_frame.q, gain->speed_q);
    x->rotor.position = position_add(expected->position, angle_from_any_turns(by.turns));
    x->rotor.load_torque += by.load_torque;
    ekf->bias.a -= num_mul_unit_nearest(by.bias_q, bias_frame.sin);
    ekf->bias.b += num_mul_unit_nearest(by.bias_q, bias_frame.cos);
}

/* Which of the sets of gains serves this period of the hold. */
static inline const struct invariant_ekf_gain_set *
invariant_ekf_hold_gains(struct invariant_ekf *ekf, const struct invariant_ekf_params *params)
{
    if (ekf->unloaded_periods > 0u) {
        ekf->unloaded_periods--;
        if (ekf->unloaded_periods == ekf->swing_end) { /* the back-EMF was taken for an offset */
            ekf->bias = (struct phases){NUM(0.0), NUM(0.0)};
        }
        ekf->settled_bias = ekf->bias; /* no load that it could be mistaken for */
        return &params->unloaded;
    }

    const num_t away = invariant_ekf_away_from_settled_load(ekf);
    const num_t change = num_abs(away);

    if (RARE(change > ekf->step_limit) &&
        (ekf->following_periods == 0u || num_half(change) > ekf->step_limit)) {
        invariant_ekf_follow_step(ekf, params);
    }
    if (ekf->following_periods == 0u) {
        return &params->holding;
    }
    ekf->following_periods--;
    if (ekf->following_periods < params->rest_periods) {
        return &params->holding;
    }
    ekf->settled_load +=
        num_mul_small(away, KNOWN(invariant_ekf_gain_set, &params->following)->load_settle);
    return &params->following;
}

__attribute__((always_inline)) static inline void
invariant_ekf_step_in_hold(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                           const struct invariant_ekf_innovation *innovation, struct sincos frame)
{
    const struct invariant_ekf_gain_set *gain = invariant_ekf_hold_gains(ekf, params);
    const num_t away = invariant_ekf_away_from_settled_load(ekf);

    invariant_ekf_correct(ekf, gain, innovation,
                          invariant_ekf_correct_in_hold(gain, innovation->in_frame, away), frame);
}

/* From S(k) to S(k+1), under this mean voltage. */
__attribute__((always_inline)) static inline struct passage
invariant_ekf_look_ahead(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                         struct phases voltage)
{
    struct estimate *x = &ekf->estimate;
    const struct phases driving = {voltage.a - ekf->bias.a, voltage.b - ekf->bias.b};
    const struct passage passage = estimate_predict_current(x, &params->model, driving);

    estimate_predict_rotor(x, &params->model, estimate_mean_current(x, passage.mid_period));
    return passage;
}

/*
 * At S(k): corrects what was predicted for it with the current that is sampled, and predicts
 * S(k+1). `surprise`: by how much the mean voltage over S(k-1)...S(k) was another than expected;
 * `in_force`: what is expected over S(k)...S(k+1).
 */
__attribute__((always_inline)) static inline struct passage
invariant_ekf_step(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                   struct phases current, struct phases surprise, struct phases in_force,
                   struct rotor_hold hold)
{
    const struct invariant_ekf_innovation innovation =
        invariant_ekf_innovate(&ekf->estimate, current, surprise);

    ekf->innovation_sum = num_add_around(ekf->innovation_sum, innovation.in_frame.d);
    if (RARE(hold.active)) {
        invariant_ekf_step_in_hold(ekf, params, &innovation, *hold.frame);
    } else {
        invariant_ekf_correct(
            ekf, &params->moving, &innovation,
            invariant_ekf_correct_in_motion(params, ekf->estimate.next.speed, innovation.in_frame),
            ekf->estimate.next.frame);
    }
    return invariant_ekf_look_ahead(ekf, params, in_force);
}

#endif
