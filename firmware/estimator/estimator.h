/*
 * The estimator in use. Direct calls instead of function pointers, as with the position laws
 * (control/position_law_dispatch.h); the choice is that of drive_interface.h.
 */
#ifndef STEADYSTEP_ESTIMATOR_H
#define STEADYSTEP_ESTIMATOR_H

#include <stddef.h>

#include "firmware/estimator/encoder_observer.h"
#include "firmware/estimator/estimators.h"
#include "firmware/estimator/high_gain_observer.h"
#include "firmware/estimator/invariant_ekf.h"
#include "firmware/estimator/steady_state_ekf.h"

/* Only the one in use is designed and stepped; with an encoder, the first of its kind as well. */
struct estimator_params {
    enum estimator_kind kind;
    union {
#define ESTIMATOR_PARAMS(constant, name) struct name##_params name;
        SENSORLESS_ESTIMATORS(ESTIMATOR_PARAMS)
        struct {
            ENCODER_ESTIMATORS(ESTIMATOR_PARAMS)
        };
#undef ESTIMATOR_PARAMS
    };
};

struct estimator {
    union {
        struct estimate estimate; /* with which each of them begins */
#define ESTIMATOR_STATE(constant, name) struct name name;
        ESTIMATORS(ESTIMATOR_STATE)
#undef ESTIMATOR_STATE
    };
};

static inline bool estimator_is(const struct estimator_params *params, enum estimator_kind kind)
{
    return (int)kind < ESTIMATOR_KINDS && params->kind == kind;
}

static inline bool estimator_has_encoder(const struct estimator_params *params)
{
    return ESTIMATORS_READ_ENCODER && (int)params->kind >= (int)ESTIMATOR_ENCODER_FIRST;
}

static inline void estimator_begin(struct estimator *estimator,
                                   const struct estimator_params *params,
                                   const struct estimator_start *start)
{
#define ESTIMATOR_BEGIN(constant, name)                                                            \
    if (estimator_is(params, ESTIMATOR_##constant)) {                                              \
        name##_begin(&estimator->name, &params->name, start);                                      \
    } else
    ESTIMATORS(ESTIMATOR_BEGIN)
    {
    }
#undef ESTIMATOR_BEGIN
}

/* At S(k): from S(k-1) on to what is expected of S(k+1). The default path does not come here. */
struct passage estimator_observe(struct estimator *estimator, const struct estimator_params *params,
                                 const struct estimator_input *input);

/* From S(k) to S(k+1) once more, under this mean voltage. Apart: rare. */
__attribute__((noinline)) void estimator_predict(struct estimator *estimator,
                                                 const struct estimator_params *params,
                                                 const struct motor_model_params *model,
                                                 struct phases voltage);

/* Without an encoder, behind estimator_begin: this current flows already. */
static inline void estimator_preset_current(struct estimator *estimator,
                                            const struct estimator_params *params,
                                            struct phases current)
{
#define ESTIMATOR_PRESET_CURRENT(constant, name)                                                   \
    if (estimator_is(params, ESTIMATOR_##constant)) {                                              \
        name##_preset_current(&estimator->name, current);                                          \
    } else
    SENSORLESS_ESTIMATORS(ESTIMATOR_PRESET_CURRENT)
    {
    }
#undef ESTIMATOR_PRESET_CURRENT
}

/* Behind estimator_begin, between two samples: this current is expected of the next one. */
static inline void estimator_expect_current(struct estimator *estimator, struct phases current)
{
    estimator->estimate.next.current = current;
}

/* The rotor is held from now on. Only this one distinguishes a hold from motion. */
static inline void estimator_begin_hold(struct estimator *estimator,
                                        const struct estimator_params *params)
{
    if (estimator_is(params, ESTIMATOR_INVARIANT_EKF)) {
        invariant_ekf_settle(&estimator->invariant_ekf, &params->invariant_ekf);
    }
}

/* Held, every few periods: what a hold shows of the resistance. Only this one leaves it until then.
 */
static inline void estimator_work_on_hold(struct estimator *estimator,
                                          const struct estimator_params *params, bool leads)
{
    if (estimator_is(params, ESTIMATOR_INVARIANT_EKF)) {
        invariant_ekf_work_on_hold(&estimator->invariant_ekf, &params->invariant_ekf, leads);
    }
}

/* Only this one distinguishes them from others. */
static inline void estimator_expect_load(struct estimator *estimator,
                                         const struct estimator_params *params)
{
    if (estimator_is(params, ESTIMATOR_INVARIANT_EKF)) {
        invariant_ekf_expect_load(&estimator->invariant_ekf);
    }
}

/* Only this one has such a bias. */
static inline void estimator_forget_bias(struct estimator *estimator,
                                         const struct estimator_params *params)
{
    if (estimator_is(params, ESTIMATOR_INVARIANT_EKF)) {
        invariant_ekf_forget_bias(&estimator->invariant_ekf);
    }
}

/* At rest, without an encoder: the rotor is known from elsewhere. */
static inline void estimator_preset_rotor(struct estimator *estimator,
                                          const struct estimator_params *params,
                                          const struct rotor *rotor)
{
#define ESTIMATOR_PRESET_ROTOR(constant, name)                                                     \
    if (estimator_is(params, ESTIMATOR_##constant)) {                                              \
        name##_preset_rotor(&estimator->name, rotor);                                              \
    } else
    SENSORLESS_ESTIMATORS(ESTIMATOR_PRESET_ROTOR)
    {
    }
#undef ESTIMATOR_PRESET_ROTOR
}

/* With an encoder: the rotor is at `position` with this count; predict is to follow. */
static inline void estimator_place(struct estimator *estimator,
                                   const struct estimator_params *params, struct position position,
                                   int32_t count)
{
#define ESTIMATOR_PLACE(constant, name)                                                            \
    if (estimator_is(params, ESTIMATOR_##constant)) {                                              \
        name##_place(&estimator->name, position, count);                                           \
    } else
    ENCODER_ESTIMATORS(ESTIMATOR_PLACE)
    {
    }
#undef ESTIMATOR_PLACE
}

/* As it counts in the estimator; NULL: there is none. */
static inline const struct encoder *estimator_encoder(const struct estimator *estimator,
                                                      const struct estimator_params *params)
{
#define ESTIMATOR_ENCODER(constant, name)                                                          \
    if (estimator_is(params, ESTIMATOR_##constant)) {                                              \
        return &estimator->name.encoder;                                                           \
    }
    ENCODER_ESTIMATORS(ESTIMATOR_ENCODER)
#undef ESTIMATOR_ENCODER
    return NULL;
}

/* While the bridge is off: the rotor is at `position`, whatever moves it. */
static inline void estimator_show_position(struct estimator *estimator, struct position position)
{
    estimator->estimate.rotor.position = position;
}

#endif
