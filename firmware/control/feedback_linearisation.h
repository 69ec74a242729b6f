/*
 * Input-output linearisation with reference feed-forward and disturbance compensation: the default
 * law with an encoder. The voltage is chosen so that position, speed and acceleration, the states
 * from the input to the output, follow the reference with an error that decays by three placed
 * poles (Isidori, Nonlinear Control Systems, ch. 4; gains: design/feedback_linearisation_design.h).
 *
 * From the predicted state at S(k+1), with T_L the whole load torque and its change over the
 * period:
 *
 *   a     = (Km i_q - Kv w - T_L)/J
 *   d_q   = J/Km (j* T + k_theta (theta* - theta) + k_w (w* - w) + k_a (a* - a)) + dT_L/Km
 *   d_d   = (1 - e^(-w_c T)) (i_d* - i_d)
 *   v_d   = R m_d + L/T d_d - N w L m_q - u_d        m = i + d/2, the mean over the period
 *   v_q   = R m_q + L/T d_q + N w L m_d + Km w - u_q   w of its middle
 *
 * (to first order in N w T; the code has the exact inverse of the model in motor/motor_model.h.)
 * There is no integrator: load torque comes from the observer, u_d and u_q from
 * voltage_disturbance.h. The q current is held within its limit. Far from the reference the
 * position error is replaced by its braking parabola, so that a step of any size ends without
 * overshoot.
 */
#ifndef STEADYSTEP_FEEDBACK_LINEARISATION_H
#define STEADYSTEP_FEEDBACK_LINEARISATION_H

#include "firmware/control/position_law.h"
#include "firmware/control/voltage_disturbance.h"

struct feedback_linearisation_law_params {
    struct voltage_disturbance_params disturbance;
    coef_t disturbed;    /* b, current per disturbance in the period before action; 0: no delay */
    coef_t position;     /* current per period, per electrical turn */
    coef_t speed;        /* per speed */
    coef_t acceleration; /* per acceleration */
    unit_t field;        /* 1 - e^(-w_c T) */
    unit_t jerk;         /* share of the reference's jerk fed forward; 1 */
    unit_t load;         /* share of the load torque compensated; 1 */
    coef_t friction;     /* Kv: torque per speed */
    coef_t stiffness;    /* L/T: voltage per change of current */
    coef_t reactance;    /* N L: voltage per speed and current */
    coef_t droop;        /* (N T)^2/24, per speed^2 */
    coef_t half_speed;   /* change of speed in half a period, per acceleration */
    num_t braking_error; /* e0, electrical turns: beyond, the rotor brakes along a parabola */
    num_t position_error_limit;
    num_t speed_error_limit;
    num_t current_limit;
};

static inline num_t *
feedback_linearisation_law_current_limit(struct feedback_linearisation_law_params *params)
{
    return &params->current_limit;
}

struct feedback_linearisation_law_state {
    struct voltage_disturbance disturbance;
};

extern const struct law_gain_list feedback_linearisation_law_gains;

/* false: the period cannot bear the bandwidths, the limit in error. */
__attribute__((cold)) bool
feedback_linearisation_law_design(struct feedback_linearisation_law_params *params,
                                  const struct position_law_task *task,
                                  char error[DESIGN_ERROR_TEXT]);

struct voltage_demand
feedback_linearisation_law_step(struct feedback_linearisation_law_state *state,
                                const struct feedback_linearisation_law_params *params,
                                const struct voltage_law_input *input);

#endif
