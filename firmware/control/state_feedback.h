/*
 * State feedback with load-torque compensation, Bendjedia 2012 (19):
 *
 *   i_q* = K_theta (theta* - theta) + K_w (w* - w) + K_L T_L + (J alpha* + Kv w*)/Km
 *
 * As published there is no w* and no alpha*: the position then lags by (2/w0) w in motion. Gains
 * (18)-(33): design/state_feedback_design.h.
 */
#ifndef STEADYSTEP_STATE_FEEDBACK_H
#define STEADYSTEP_STATE_FEEDBACK_H

#include "firmware/control/error_feedback.h"

struct state_feedback_law_params {
    struct error_feedback_params feedback;
};

static inline num_t *state_feedback_law_current_limit(struct state_feedback_law_params *params)
{
    return &params->feedback.current_limit;
}

struct state_feedback_law_state {
    num_t none; /* C knows no empty struct */
};

extern const struct law_gain_list state_feedback_law_gains;

/* false: the loops cannot bear the bandwidth, the limit in error. */
__attribute__((cold)) bool state_feedback_law_design(struct state_feedback_law_params *params,
                                                     const struct position_law_task *task,
                                                     char error[DESIGN_ERROR_TEXT]);

/* The q current, within +-current_limit. */
num_t state_feedback_law_step(struct state_feedback_law_state *state,
                              const struct state_feedback_law_params *params,
                              const struct position_law_input *input);

#endif
