#include "firmware/estimator/estimator.h"

/* Named, so that the image can place it beside the code. */
static const struct passage at_rest = {{UNIT(1.0), UNIT(0.0)}, {UNIT(1.0), UNIT(0.0)}};

/* Each gets a copy of its own, so that the one compiled into its place keeps its input in
   registers. */
struct passage estimator_observe(struct estimator *estimator, const struct estimator_params *params,
                                 const struct estimator_input *input)
{
#define ESTIMATOR_OBSERVE(constant, name)                                                          \
    if (estimator_is(params, ESTIMATOR_##constant)) {                                              \
        const struct estimator_input own = *input;                                                 \
        return name##_observe(&estimator->name, &params->name, &own);                              \
    }
    ESTIMATORS(ESTIMATOR_OBSERVE)
#undef ESTIMATOR_OBSERVE
    return at_rest;
}

void estimator_predict(struct estimator *estimator, const struct estimator_params *params,
                       const struct motor_model_params *model, struct phases voltage)
{
    struct estimate *x = &estimator->estimate;
    struct phases driving = voltage;
    num_t known_torque = NUM(0.0);
    struct passage passage;

    if (estimator_is(params, ESTIMATOR_INVARIANT_EKF)) {
        driving.a -= estimator->invariant_ekf.bias.a;
        driving.b -= estimator->invariant_ekf.bias.b;
    } else if (estimator_is(params, ESTIMATOR_ENCODER_OBSERVER)) {
        known_torque = estimator->encoder_observer.known_torque;
    }
    passage = estimate_predict_current(x, model, driving);
    if (estimator_is(params, ESTIMATOR_STEADY_STATE_EKF)) {
        estimator->steady_state_ekf.mid_period = passage.mid_period;
    }
    estimate_predict_rotor(x, model, estimate_mean_of_ends(x, passage) - known_torque);
}
