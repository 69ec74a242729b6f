/*
 * Gains of continuous sliding-mode control, Seshagiri and Khalil, from bandwidths.
 *
 *   s1 = k0_d sigma1 + e1,   s2 = k0_q sigma2 + k1 e2 + k2 de2/dt + d2e2/dt2        (3)
 *
 * The surface has a double pole at the position bandwidth. Inside the boundary layer -M sat(s/mu)
 * is a proportional control of the current with the bandwidth M/(mu_d L) and M Km/(J mu_q L); that
 * of the current loop decides on the widths of the layers.
 */
#ifndef STEADYSTEP_SLIDING_MODE_DESIGN_H
#define STEADYSTEP_SLIDING_MODE_DESIGN_H

#include "firmware/design/refusal.h"
#include "firmware/motor/motor_params.h"

/*
 * Current bandwidth times period: with a period of delay z^2 - z + g rings beyond 0.25 and is
 * unstable from 1 on. The drive's prediction takes the delay out as far as R and L are right, which
 * these laws are there not to rely on. Without a delay z - 1 + g settles in one period at 1.
 */
#define SLIDING_MODE_DELAYED_MAX    0.25
#define SLIDING_MODE_ZERO_DELAY_MAX 1.0

/* Superscript indices of the paper: k0^1 and k0^2 are k0_d and k0_q, k1^2 and k2^2 are k1 and k2.
 */
struct sliding_mode_gains {
    double k1_1_s2;
    double k2_1_s;
    double mu_d_A;
    double mu_q_rad_s2;
    double k0_d_1_s; /* a third and a fifteenth of the position bandwidth, as the paper's are */
    double k0_q_1_s;
    double voltage_V; /* M: the supply */
};

struct sliding_mode_task {
    const struct motor_params *motor;
    double period_s;
    unsigned delay_periods; /* 0 or 1 */
    double bandwidth_rad_s;
    double current_bandwidth_rad_s;
};

struct sliding_mode_gains sliding_mode_gains_of(const struct sliding_mode_task *task);

/* Whether the sampled loop bears the bandwidths; else false and the limit in error. */
bool sliding_mode_current_bandwidth_check(const struct sliding_mode_task *task,
                                          char error[DESIGN_ERROR_TEXT]);
bool sliding_mode_bandwidth_check(const struct sliding_mode_task *task,
                                  char error[DESIGN_ERROR_TEXT]);

#endif
