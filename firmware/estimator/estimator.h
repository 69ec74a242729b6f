/* The estimator in use, behind one interface: see drive_interface.h for the choice. */
#ifndef STEADYSTEP_ESTIMATOR_H
#define STEADYSTEP_ESTIMATOR_H

#include "firmware/estimator/encoder_observer.h"
#include "firmware/estimator/high_gain_observer.h"
#include "firmware/estimator/invariant_ekf.h"
#include "firmware/estimator/steady_state_ekf.h"

enum estimator_kind {
    ESTIMATOR_INVARIANT_EKF,
    ESTIMATOR_STEADY_STATE_EKF,
    ESTIMATOR_ENCODER_OBSERVER,
    ESTIMATOR_HIGH_GAIN_OBSERVER
};

/* Those in an image: all, or, for a board that reads no encoder, what goes without one. */
#ifdef STEADYSTEP_WITHOUT_ENCODER
enum { ESTIMATOR_KINDS = ESTIMATOR_ENCODER_OBSERVER };
#else
enum { ESTIMATOR_KINDS = ESTIMATOR_HIGH_GAIN_OBSERVER + 1 };
#endif
enum { ESTIMATORS_READ_ENCODER = (int)ESTIMATOR_KINDS > (int)ESTIMATOR_ENCODER_OBSERVER };

/* Only the one in use is designed and stepped. */
struct estimator_params {
    enum estimator_kind kind;
    union {
        struct invariant_ekf_params invariant;
        struct steady_state_ekf_params steady_state;
        struct {
            struct encoder_observer_params encoder; /* designed for the high-gain observer, too */
            struct high_gain_observer_params high_gain;
        };
    };
};

struct estimator {
    union {
        struct estimate estimate; /* with which each of them begins */
        struct invariant_ekf invariant;
        struct steady_state_ekf steady_state;
        struct encoder_observer encoder;
        struct high_gain_observer high_gain;
    };
};

/* What is known when the bridge is switched on: at rest, without current. */
struct estimator_start {
    struct position position;         /* as the drive is told it */
    struct position encoder_position; /* that the count stands for */
    num_t load_torque;
    num_t resistance;
    uint32_t unloaded_periods; /* of the hold that follows: no load begins in them */
    int32_t encoder_count;
};

static inline bool estimator_is(const struct estimator_params *params, enum estimator_kind kind)
{
    return (int)kind < ESTIMATOR_KINDS && params->kind == kind;
}

static inline void estimator_reset(struct estimator *estimator,
                                   const struct estimator_params *params,
                                   const struct estimator_start *start)
{
    if (estimator_is(params, ESTIMATOR_INVARIANT_EKF)) {
        invariant_ekf_reset(&estimator->invariant, &params->invariant, start->position,
                            start->resistance, start->unloaded_periods);
    } else if (estimator_is(params, ESTIMATOR_STEADY_STATE_EKF)) {
        steady_state_ekf_reset(&estimator->steady_state, &params->steady_state, start->position,
                               start->resistance);
    } else if (estimator_is(params, ESTIMATOR_ENCODER_OBSERVER)) {
        encoder_observer_reset(&estimator->encoder, &params->encoder, start->encoder_position,
                               start->load_torque, start->resistance, start->encoder_count);
    } else if (estimator_is(params, ESTIMATOR_HIGH_GAIN_OBSERVER)) {
        high_gain_observer_reset(&estimator->high_gain, &params->high_gain, start->position,
                                 start->encoder_position, start->resistance, start->encoder_count);
    }
}

/* Without an encoder, behind a reset: this current flows already. */
static inline void estimator_take_current(struct estimator *estimator,
                                          const struct estimator_params *params,
                                          struct phases current)
{
    if (estimator_is(params, ESTIMATOR_INVARIANT_EKF)) {
        estimator->invariant.estimate.current = current;
        estimate_look_ahead(&estimator->invariant.estimate, &params->invariant.model);
    } else if (estimator_is(params, ESTIMATOR_STEADY_STATE_EKF)) {
        estimator->steady_state.estimate.current = current;
        estimator->steady_state.current =
            park(current, estimate_begin_of_period(&estimator->steady_state.estimate));
        estimate_look_ahead(&estimator->steady_state.estimate, &params->steady_state.model);
    }
}

/* Held, without an encoder: the current of the coming S(k), had this voltage acted since S(k-1). */
static inline struct phases estimator_expected_current(const struct estimator *estimator,
                                                       const struct estimator_params *params,
                                                       struct phases voltage)
{
    const struct estimate *x = &estimator->estimate;
    struct phases driving = voltage;

    if (estimator_is(params, ESTIMATOR_INVARIANT_EKF)) {
        driving.a -= estimator->invariant.bias.a;
        driving.b -= estimator->invariant.bias.b;
    }
    return forced_current(&x->winding, x->free_current, driving);
}

/* At rest, without an encoder: the rotor is known from elsewhere. */
static inline void estimator_tell_rotor(struct estimator *estimator,
                                        const struct estimator_params *params,
                                        const struct rotor *rotor)
{
    if (estimator_is(params, ESTIMATOR_INVARIANT_EKF)) {
        estimator->invariant.estimate.rotor = *rotor;
        estimator->invariant.settled_load = rotor->load_torque;
        estimate_look_ahead(&estimator->invariant.estimate, &params->invariant.model);
    } else if (estimator_is(params, ESTIMATOR_STEADY_STATE_EKF)) {
        estimator->steady_state.estimate.rotor = *rotor;
        estimate_look_ahead(&estimator->steady_state.estimate, &params->steady_state.model);
    }
}

/* Offset that is taken from the measured voltage. */
static inline struct phases estimator_bias(const struct estimator *estimator,
                                           const struct estimator_params *params)
{
    return estimator_is(params, ESTIMATOR_INVARIANT_EKF) ? estimator->invariant.bias
                                                         : (struct phases){NUM(0.0), NUM(0.0)};
}

/*
 * Held: of that offset the part along the hold current, the d axis of `frame`, becomes that of
 * `known`. At rest it looks like the drop at the resistance.
 */
static inline void estimator_tell_bias_along(struct estimator *estimator,
                                             const struct estimator_params *params,
                                             struct phases known, struct sincos frame)
{
    if (estimator_is(params, ESTIMATOR_INVARIANT_EKF)) {
        struct phases *bias = &estimator->invariant.bias;
        const struct phases change = {known.a - bias->a, known.b - bias->b};
        const num_t along = park(change, frame).d;

        bias->a += num_mul_unit(along, frame.cos);
        bias->b += num_mul_unit(along, frame.sin);
    }
}

static inline bool estimator_has_encoder(const struct estimator_params *params)
{
    return estimator_is(params, ESTIMATOR_ENCODER_OBSERVER) ||
           estimator_is(params, ESTIMATOR_HIGH_GAIN_OBSERVER);
}

/* Torque that the next prediction takes into account besides the load; the model observer's. */
static inline void estimator_tell_torque(struct estimator *estimator,
                                         const struct estimator_params *params, num_t torque)
{
    if (estimator_is(params, ESTIMATOR_ENCODER_OBSERVER)) {
        estimator->encoder.known_torque = torque;
    }
}

/* With an encoder: the rotor is at `position` with this count. */
static inline void estimator_place(struct estimator *estimator,
                                   const struct estimator_params *params, struct position position,
                                   int32_t count)
{
    if (estimator_is(params, ESTIMATOR_ENCODER_OBSERVER)) {
        encoder_observer_place(&estimator->encoder, &params->encoder, position, count);
    } else if (estimator_is(params, ESTIMATOR_HIGH_GAIN_OBSERVER)) {
        high_gain_observer_place(&estimator->high_gain, position, count);
    }
}

/* From S(k-1) to S(k); the steady-state EKF has no tuning of its own for the hold. */
static inline const struct estimate *estimator_step(struct estimator *estimator,
                                                    const struct estimator_params *params,
                                                    const struct channels *winding,
                                                    int32_t encoder_count, struct rotor_hold hold)
{
    if (estimator_is(params, ESTIMATOR_INVARIANT_EKF)) {
        invariant_ekf_step(&estimator->invariant, &params->invariant, winding->current,
                           winding->voltage, hold);
    } else if (estimator_is(params, ESTIMATOR_STEADY_STATE_EKF)) {
        steady_state_ekf_step(&estimator->steady_state, &params->steady_state, winding->current,
                              winding->voltage);
    } else if (estimator_is(params, ESTIMATOR_ENCODER_OBSERVER)) {
        encoder_observer_step(&estimator->encoder, &params->encoder, winding->current,
                              winding->voltage, encoder_count, hold.active);
    } else if (estimator_is(params, ESTIMATOR_HIGH_GAIN_OBSERVER)) {
        high_gain_observer_step(&estimator->high_gain, &params->high_gain, winding->current,
                                encoder_count);
    }
    return &estimator->estimate;
}

#endif
