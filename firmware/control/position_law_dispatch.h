/*
 * The law in use. Direct calls instead of function pointers, so that the longest path of the
 * interrupt can be read off the image and a law is compiled into its place.
 */
#ifndef STEADYSTEP_POSITION_LAW_DISPATCH_H
#define STEADYSTEP_POSITION_LAW_DISPATCH_H

#include "firmware/control/csmc.h"
#include "firmware/control/csmc_equivalent.h"
#include "firmware/control/csmc_servo.h"
#include "firmware/control/feedback_linearisation.h"
#include "firmware/control/foc.h"
#include "firmware/control/laws_carried.h"
#include "firmware/control/microstepping.h"
#include "firmware/control/pid.h"
#include "firmware/control/position_laws.h"
#include "firmware/control/smc.h"
#include "firmware/control/state_feedback.h"
#include "firmware/control/stmms.h"
#include "firmware/control/stmms_plus.h"

union position_law_params {
#define POSITION_LAW_PARAMS(constant, function, text) struct function##_law_params function;
    POSITION_LAWS(POSITION_LAW_PARAMS)
#undef POSITION_LAW_PARAMS
};

union position_law_state {
#define POSITION_LAW_STATE(constant, function, text) struct function##_law_state function;
    POSITION_LAWS(POSITION_LAW_STATE)
#undef POSITION_LAW_STATE
};

/* Whether the law gives a voltage or a current. */
static inline bool position_law_gives_voltage(enum position_law law)
{
    return law >= (enum position_law)POSITION_LAW_VOLTAGE_FIRST;
}

/* The gains that can be given to a law; none for a law that does not exist. */
static inline struct law_gain_list position_law_gains(enum position_law law)
{
#define POSITION_LAW_GAINS(constant, function, text)                                               \
    if (position_law_is_carried(POSITION_LAW_##constant) && law == POSITION_LAW_##constant) {      \
        return function##_law_gains;                                                               \
    }
    POSITION_LAWS(POSITION_LAW_GAINS)
#undef POSITION_LAW_GAINS
    return (struct law_gain_list){NULL, 0};
}

/* At start-up. false: refused, reason in error. */
static inline bool position_law_design(enum position_law law, union position_law_params *params,
                                       const struct position_law_task *task,
                                       char error[DESIGN_ERROR_TEXT])
{
#define POSITION_LAW_DESIGN(constant, function, text)                                              \
    if (position_law_is_carried(POSITION_LAW_##constant) && law == POSITION_LAW_##constant) {      \
        return function##_law_design(&params->function, task, error);                              \
    }
    POSITION_LAWS(POSITION_LAW_DESIGN)
#undef POSITION_LAW_DESIGN
    return design_refuse(error, "no such position law");
}

/* Where it may fall in motion; NULL: the law has none. */
static inline num_t *position_law_current_limit(enum position_law law,
                                                union position_law_params *params)
{
#define POSITION_LAW_LIMIT(constant, function, text)                                               \
    if (position_law_is_carried(POSITION_LAW_##constant) && law == POSITION_LAW_##constant) {      \
        return function##_law_current_limit(&params->function);                                    \
    }
    POSITION_LAWS(POSITION_LAW_LIMIT)
#undef POSITION_LAW_LIMIT
    return NULL;
}

/* At rest: all zero. In one piece: the interrupt copies nothing of a size that varies. */
static inline void position_law_reset(union position_law_state *state)
{
    static const union position_law_state at_rest;

    *state = at_rest;
}

/*
 * One period of a current law: the q current, within +-current_limit. Each law gets a copy of its
 * own, so that the one compiled into its place keeps its input in registers.
 */
static inline num_t position_law_current(enum position_law law, union position_law_state *state,
                                         const union position_law_params *params,
                                         const struct position_law_input *input)
{
#define POSITION_LAW_CURRENT(constant, function, text)                                             \
    if (position_law_is_carried(POSITION_LAW_##constant) &&                                        \
        !RARE(law != POSITION_LAW_##constant)) {                                                   \
        const struct position_law_input own = *input;                                              \
        return function##_law_step(&state->function, &params->function, &own);                     \
    }
    CURRENT_LAWS(POSITION_LAW_CURRENT)
#undef POSITION_LAW_CURRENT
    return NUM(0.0);
}

/* One period of a voltage law; here, too, each gets a copy of its own. */
static inline struct voltage_demand position_law_voltage(enum position_law law,
                                                         union position_law_state *state,
                                                         const union position_law_params *params,
                                                         const struct voltage_law_input *input)
{
#define POSITION_LAW_VOLTAGE(constant, function, text)                                             \
    if (position_law_is_carried(POSITION_LAW_##constant) && law == POSITION_LAW_##constant) {      \
        const struct voltage_law_input own = *input;                                               \
        return function##_law_step(&state->function, &params->function, &own);                     \
    }
    VOLTAGE_LAWS(POSITION_LAW_VOLTAGE)
#undef POSITION_LAW_VOLTAGE
    return (struct voltage_demand){{NUM(0.0), NUM(0.0)}, NUM(0.0)};
}

#endif
