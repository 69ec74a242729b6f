#include "firmware/estimator/estimator.h"

struct passage estimator_observe(struct estimator *estimator, const struct estimator_params *params,
                                 const struct estimator_input *input)
{
#define ESTIMATOR_OBSERVE(constant, name)                                                          \
    if (estimator_is(params, ESTIMATOR_##constant)) {                                              \
        return name##_observe(&estimator->name, &params->name, input);                             \
    }
    ESTIMATORS(ESTIMATOR_OBSERVE)
#undef ESTIMATOR_OBSERVE
    return (struct passage){{UNIT(1.0), UNIT(0.0)}, {UNIT(1.0), UNIT(0.0)}};
}

void estimator_predict(struct estimator *estimator, const struct estimator_params *params,
                       struct phases voltage)
{
#define ESTIMATOR_PREDICT(constant, name)                                                          \
    if (estimator_is(params, ESTIMATOR_##constant)) {                                              \
        (void)name##_predict(&estimator->name, &params->name, voltage);                            \
    }
    ESTIMATORS(ESTIMATOR_PREDICT)
#undef ESTIMATOR_PREDICT
}
