/*
 * Steady-state extended Kalman filter of Bendjedia 2012, section II: the d-q model (3) stepped by
 * Euler (8), corrected (11) with the constant gain that the full filter (9)-(12) converges to at
 * standstill. Kept as the reference the default estimator is measured against.
 *
 * Limits (shown by the scenarios bendjedia-paper-ekf and -fast): the Euler predictor is unstable
 * beyond |1 - T R/L + j N w T| = 1; the gain is stable at standstill only without d current.
 */
#ifndef STEADYSTEP_STEADY_STATE_EKF_H
#define STEADYSTEP_STEADY_STATE_EKF_H

#include "firmware/design/steady_state_ekf_design.h"
#include "firmware/estimator/estimate.h"

struct steady_state_ekf_params {
    struct motor_model_params model;
    coef_t rotation; /* N T: electrical rad per period and unit of speed */
    coef_t gain_current_d;
    coef_t gain_current_q;
    coef_t gain_speed;
    coef_t gain_angle; /* electrical turns per q current */
    coef_t gain_load;
};

struct steady_state_ekf {
    struct estimate estimate;
    struct dq current;        /* in the estimated rotor frame */
    struct sincos mid_period; /* of the rotor over S(k)...S(k+1) */
};

struct steady_state_ekf_params steady_state_ekf_scale(const struct motor_model_params *model,
                                                      const struct per_unit *base,
                                                      const struct steady_state_ekf_gains *gains);

void steady_state_ekf_reset(struct steady_state_ekf *ekf,
                            const struct steady_state_ekf_params *params, struct position position,
                            num_t resistance);

/* What the control answers to: the motor at S(k+1), under this mean voltage. */
struct passage steady_state_ekf_predict(struct steady_state_ekf *ekf,
                                        const struct steady_state_ekf_params *params,
                                        struct phases voltage);

/* From S(k-1) to S(k), and the same. `winding`: current sampled at S(k), mean voltage over that
   period; `in_force`: voltage that is expected over S(k)...S(k+1). */
__attribute__((noinline)) struct passage
steady_state_ekf_step(struct steady_state_ekf *ekf, const struct steady_state_ekf_params *params,
                      const struct channels *winding, struct phases in_force);

static inline void steady_state_ekf_begin(struct steady_state_ekf *ekf,
                                          const struct steady_state_ekf_params *params,
                                          const struct estimator_start *start)
{
    steady_state_ekf_reset(ekf, params, start->position, start->resistance);
}

/* It has no tuning of its own for the hold. */
static inline struct passage steady_state_ekf_observe(struct steady_state_ekf *ekf,
                                                      const struct steady_state_ekf_params *params,
                                                      const struct estimator_input *input)
{
    return steady_state_ekf_step(ekf, params, &input->winding, input->in_force);
}

static inline void steady_state_ekf_preset_current(struct steady_state_ekf *ekf,
                                                   struct phases current)
{
    ekf->estimate.current = current;
    ekf->current = park(current, sincos_of(ekf->estimate.rotor.position.fraction));
}

static inline void steady_state_ekf_preset_rotor(struct steady_state_ekf *ekf,
                                                 const struct rotor *rotor)
{
    ekf->estimate.rotor = *rotor;
}

#endif
