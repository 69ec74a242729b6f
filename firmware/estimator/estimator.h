/* The estimator in use, behind one interface: see drive_interface.h for the choice. */
#ifndef STEADYSTEP_ESTIMATOR_H
#define STEADYSTEP_ESTIMATOR_H

#include "firmware/estimator/invariant_ekf.h"
#include "firmware/estimator/steady_state_ekf.h"

enum estimator_kind { ESTIMATOR_INVARIANT_EKF, ESTIMATOR_STEADY_STATE_EKF };

/* Only the one in use is designed and stepped. */
struct estimator_params {
    enum estimator_kind kind;
    struct invariant_ekf_params invariant;
    struct steady_state_ekf_params steady_state;
};

struct estimator {
    struct invariant_ekf invariant;
    struct steady_state_ekf steady_state;
};

static inline const struct estimate *estimator_estimate(const struct estimator *estimator,
                                                        const struct estimator_params *params)
{
    return params->kind == ESTIMATOR_INVARIANT_EKF ? &estimator->invariant.estimate
                                                   : &estimator->steady_state.estimate;
}

/* At rest at a known position, without current and load. */
static inline void estimator_reset(struct estimator *estimator,
                                   const struct estimator_params *params, struct position position,
                                   num_t resistance)
{
    if (params->kind == ESTIMATOR_INVARIANT_EKF) {
        invariant_ekf_reset(&estimator->invariant, &params->invariant, position, resistance);
    } else {
        steady_state_ekf_reset(&estimator->steady_state, &params->steady_state, position,
                               resistance);
    }
}

/* From S(k-1) to S(k); the steady-state EKF has no tuning of its own for the hold. */
static inline const struct estimate *estimator_step(struct estimator *estimator,
                                                    const struct estimator_params *params,
                                                    struct phases current, struct phases voltage,
                                                    bool holding)
{
    if (params->kind == ESTIMATOR_INVARIANT_EKF) {
        invariant_ekf_step(&estimator->invariant, &params->invariant, current, voltage, holding);
    } else {
        steady_state_ekf_step(&estimator->steady_state, &params->steady_state, current, voltage);
    }
    return estimator_estimate(estimator, params);
}

#endif
