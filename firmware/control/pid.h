/*
 * Position PID, the derivative taken from the estimated speed:
 *
 *   i_q* = Kp (theta* - theta) + Kd (w* - w) + z,   z += Ki (theta* - theta)
 *
 * The integrator stands still while the current is limited and the error would drive it further.
 */
#ifndef STEADYSTEP_PID_H
#define STEADYSTEP_PID_H

#include "firmware/control/error_feedback.h"

struct pid_law_params {
    struct error_feedback_params feedback;
    coef_t integral; /* per period */
};

static inline num_t *pid_law_current_limit(struct pid_law_params *params)
{
    return &params->feedback.current_limit;
}

struct pid_law_state {
    num_t integral; /* z */
};

extern const struct law_gain_list pid_law_gains;

/* false: the loops cannot bear the bandwidth, the limit in error. */
__attribute__((cold)) bool pid_law_design(struct pid_law_params *params,
                                          const struct position_law_task *task,
                                          char error[DESIGN_ERROR_TEXT]);

/* The q current, within +-current_limit. */
num_t pid_law_step(struct pid_law_state *state, const struct pid_law_params *params,
                   const struct position_law_input *input);

#endif
