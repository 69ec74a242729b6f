/*
 * The mechanical controller of Kim 2016 (24), which STMMS and FOC share. With e1 = theta - theta*,
 * e2 = de1/dt + k1p e1 and e0 the integral of e1:
 *
 *   tau_d = B w + T_L + J (alpha* - k1p de1/dt - k0 e0 - k1 e1 - k2 e2)
 *
 * Sorted by errors (error_feedback.h), with e = -e1 and T_L as the observer knows it:
 *
 *   Km i_q* = J (k1p + k2) (w* - w) + J (k1 + k1p k2) e + B w + J alpha* + c T_L + J k0 integral(e)
 *
 * The load compensation c is 1, or 0 to leave the load to the integrator, which stands still while
 * current or voltage is limited and the error would drive it further.
 */
#ifndef STEADYSTEP_TORQUE_DEMAND_H
#define STEADYSTEP_TORQUE_DEMAND_H

#include "firmware/control/error_feedback.h"
#include "firmware/design/mechanical_control_design.h"

struct torque_demand_params {
    struct error_feedback_params feedback;
    coef_t integral; /* per period, TORQUE_DEMAND_INTEGRAL_SCALE times */
    coef_t load_compensation;
    num_t integral_limit; /* the current limit, scaled as the integral */
};

struct torque_demand_state {
    num_t integral;  /* TORQUE_DEMAND_INTEGRAL_SCALE times the q current it stands for */
    num_t shortfall; /* of the last q voltage: what the limit took away */
};

/* Fixed point: an integrator of one current base resolves 1e-9 of it. */
#define TORQUE_DEMAND_INTEGRAL_SCALE 16.0

/* The gains of a law that begins with this one's. */
enum {
    TORQUE_DEMAND_K1P,
    TORQUE_DEMAND_K0,
    TORQUE_DEMAND_K1,
    TORQUE_DEMAND_K2,
    TORQUE_DEMAND_LOAD_COMPENSATION,
    TORQUE_DEMAND_GAINS
};

#define TORQUE_DEMAND_GAIN_LIST                                                                    \
    [TORQUE_DEMAND_K1P] = {"k1p_per_s", 0.0, 1e6}, [TORQUE_DEMAND_K0] = {"k0_per_s3", 0.0, 1e12},  \
    [TORQUE_DEMAND_K1] = {"k1_per_s2", 0.0, 1e9}, [TORQUE_DEMAND_K2] = {"k2_per_s", 0.0, 1e6},     \
    [TORQUE_DEMAND_LOAD_COMPENSATION] = {"load_compensation", 0.0, 1.0}

/* Whether the bandwidth is asked for anything: k1p, k0 or k2 is not given. */
bool torque_demand_needs_design(const struct position_law_task *task);

/* false: a gain that is not given cannot follow from the bandwidth, the limit in error. */
__attribute__((cold)) bool torque_demand_design(struct torque_demand_params *params,
                                                const struct position_law_task *task,
                                                char error[DESIGN_ERROR_TEXT]);

/* One period: i_q*, within +-current_limit. */
num_t torque_demand_step(struct torque_demand_state *state,
                         const struct torque_demand_params *params,
                         const struct position_law_input *input);

#endif
