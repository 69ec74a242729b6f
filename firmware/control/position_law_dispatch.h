/*
 * The law in use. Direct calls instead of function pointers, so that the longest path of the
 * interrupt can be read off the image and a law is compiled into its place.
 */
#ifndef STEADYSTEP_POSITION_LAW_DISPATCH_H
#define STEADYSTEP_POSITION_LAW_DISPATCH_H

#include "firmware/control/pid.h"
#include "firmware/control/position_laws.h"
#include "firmware/control/state_feedback.h"

/* At start-up. false: refused, reason in error. */
static inline bool position_law_design(enum position_law law, struct position_law_params *params,
                                       const struct position_law_task *task,
                                       char error[DESIGN_ERROR_TEXT])
{
#define POSITION_LAW_DESIGN(constant, function, text)                                              \
    if (law == POSITION_LAW_##constant) {                                                          \
        return function##_law_design(params, task, error);                                         \
    }
    POSITION_LAWS(POSITION_LAW_DESIGN)
#undef POSITION_LAW_DESIGN
    return design_refuse(error, "no such position law");
}

/* One period: the q current, within +-current_limit. */
static inline num_t position_law_step(enum position_law law, struct position_law_state *state,
                                      const struct position_law_params *params,
                                      const struct position_law_input *input)
{
#define POSITION_LAW_STEP(constant, function, text)                                                \
    if (law == POSITION_LAW_##constant) {                                                          \
        return function##_law_step(state, params, input);                                          \
    }
    POSITION_LAWS(POSITION_LAW_STEP)
#undef POSITION_LAW_STEP
    return NUM(0.0);
}

#endif
