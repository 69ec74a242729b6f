/* What every estimator knows of the motor at S(k), from the samples up to and including S(k). */
#ifndef STEADYSTEP_ESTIMATE_H
#define STEADYSTEP_ESTIMATE_H

#include "firmware/motor/motor_model.h"

/* What the hold does with the rotor over the period. */
struct rotor_hold {
    bool active;
    const bool *leads; /* the rotor, else it holds it at rest; read in hold alone */
};

/* What is known when the bridge is switched on: at rest, without current. */
struct estimator_start {
    struct position position;         /* as it is assumed */
    struct position encoder_position; /* that the count stands for */
    num_t load_torque;
    num_t resistance;
    uint32_t unloaded_periods; /* of the hold that follows: no load begins in them */
    int32_t encoder_count;
};

/* What an estimator goes by from S(k-1) to S(k). */
struct estimator_input {
    const struct channels *winding; /* current sampled at S(k), mean voltage since S(k-1) */
    int32_t encoder_count;
    struct rotor_hold hold;
};

struct estimate {
    struct phases current;
    struct rotor rotor;
    struct winding winding;
    /* What follows from these for S(k)...S(k+1), and serves both the control and the next step. */
    struct sincos half_turn;    /* of the rotation in half a period */
    struct sincos mid_period;   /* of the electrical angle of the middle of the period */
    struct phases free_current; /* at S(k+1), if no voltage acted */
};

/* Fills in what follows from current, rotor and winding. */
static inline void estimate_look_ahead(struct estimate *x, const struct motor_model_params *model)
{
    const int32_t rotation = half_period_rotation(model, x->rotor.speed);

    x->half_turn = sincos_of((angle_t)rotation);
    x->mid_period = sincos_of(x->rotor.position.fraction + (angle_t)rotation);
    x->free_current = free_current(model, &x->winding, x->current, x->rotor.speed, x->mid_period);
}

/* The rotor at S(k) is half a rotation short of the middle of the period. */
static inline struct sincos estimate_begin_of_period(const struct estimate *x)
{
    const struct sincos back = {x->half_turn.cos, -x->half_turn.sin};

    return sincos_add(x->mid_period, back);
}

/* The rotor at S(k+1) is half a rotation past the middle of the period. */
static inline struct sincos estimate_end_of_period(const struct estimate *x)
{
    return sincos_add(x->mid_period, x->half_turn);
}

/* At rest at a known position, no current and no load. */
static inline void estimate_reset(struct estimate *x, const struct motor_model_params *model,
                                  struct position position, num_t resistance)
{
    const struct phases no_current = {NUM(0.0), NUM(0.0)};

    x->current = no_current;
    x->rotor.position = position;
    x->rotor.speed = NUM(0.0);
    x->rotor.load_torque = NUM(0.0);
    winding_set_resistance(&x->winding, model, resistance);
    estimate_look_ahead(x, model);
}

#endif
