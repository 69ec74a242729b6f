/*
 * Position PID, the derivative taken from the estimated speed:
 *
 *   i_q* = Kp (theta* - theta) + Kd (w* - w) + z,   z += Ki (theta* - theta)
 *
 * The integrator stands still while the current is limited and the error would drive it further.
 */
#ifndef STEADYSTEP_PID_H
#define STEADYSTEP_PID_H

#include "firmware/control/position_law.h"

/* false: the loops cannot bear the bandwidth, the limit in error. */
bool pid_law_design(struct position_law_params *params, const struct position_law_task *task,
                    char error[DESIGN_ERROR_TEXT]);

/* The q current, within +-current_limit. */
num_t pid_law_step(struct position_law_state *state, const struct position_law_params *params,
                   const struct position_law_input *input);

#endif
