/*
 * Gains of the state feedback (19) of Bendjedia 2012 with a double real closed-loop pole
 * e^(-w0 T), (24)-(26), placed on the exact discrete model (18); (33).
 *
 * Errata of the paper: B_r in (21) is [0 1]^T, and the subscripts in (27) are permuted.
 */
#ifndef STEADYSTEP_STATE_FEEDBACK_DESIGN_H
#define STEADYSTEP_STATE_FEEDBACK_DESIGN_H

#include <stdbool.h>

#include "firmware/design/refusal.h"
#include "firmware/motor/motor_params.h"

/*
 * i_q* = k_angle_reference theta* - k_angle theta - k_speed w + k_load T_L       (19)
 *        + k_speed_reference w* + k_acceleration_reference alpha*        (feed-forward)
 */
struct state_feedback_gains {
    double k_speed_As_rad;                   /* K_w, A per rad/s */
    double k_angle_A_rad;                    /* K_theta, A per rad (mechanical) */
    double k_angle_reference_A_rad;          /* K_theta* = K_theta, (33) */
    double k_load_A_Nm;                      /* K_L = 1 / Km, (33) */
    double k_speed_reference_As_rad;         /* K_w + Kv / Km */
    double k_acceleration_reference_As2_rad; /* J / Km */
};

/* False, with the limit in `error`, if the loops cannot bear the bandwidths (loop_bandwidth.h). */
bool state_feedback_design(const struct motor_params *motor, double period_s,
                           double bandwidth_rad_s, double current_bandwidth_rad_s,
                           struct state_feedback_gains *gains, char error[DESIGN_ERROR_TEXT]);

#endif
