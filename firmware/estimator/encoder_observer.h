/*
 * Model observer on an encoder: rotor position, speed and load torque from counts and currents.
 *
 *   predict with the voltage that is expected over the period (motor_model.h); at its end put the
 *   speed right by the current that is measured, then correct with nu = theta_measured - theta_hat:
 *   theta += l_theta nu,   w += l_w nu,   T_L -= l_T nu
 *
 * Triple pole p = e^(-w_o T) of the error (position, speed and acceleration of a free rotor,
 * critically damped):  l_theta = 1 - p^3,  l_w = 3/2 (1 - p)^2 (1 + p) / T,
 * l_T = J (1 - p)^3 / T^2.
 *
 * While holding, the series resistance is adapted so that the current model explains the measured
 * current:  R -= k (i - i_hat) . i.
 */
#ifndef STEADYSTEP_ENCODER_OBSERVER_H
#define STEADYSTEP_ENCODER_OBSERVER_H

#include "firmware/design/refusal.h"
#include "firmware/estimator/estimate.h"
#include "firmware/motor/encoder.h"

struct encoder_observer_params {
    struct motor_model_params model;
    struct encoder_params encoder;
    coef_t gain_angle; /* 1: electrical turns per electrical turn */
    coef_t gain_speed;
    coef_t gain_load;
    coef_t gain_resistance;
};

struct encoder_observer {
    struct estimate estimate;
    struct encoder encoder;
    num_t known_torque; /* part of the load that need not be estimated, at S(k) */
};

/* What it is designed from. */
struct encoder_observer_task {
    const struct per_unit *base;
    int32_t rotor_teeth;
    uint32_t counts_per_turn;
    double period_s;
    double bandwidth_rad_s;         /* w_o, at most 0.5 per period */
    double resistance_adaptation_s; /* time constant at the hold current; 0: none */
    double hold_current_A;
};

/* false: the bandwidth or the encoder is out of range, the limit in error. */
__attribute__((cold)) bool encoder_observer_design(struct encoder_observer_params *params,
                                                   const struct motor_model_params *model,
                                                   const struct encoder_observer_task *task,
                                                   char error[DESIGN_ERROR_TEXT]);

/* At rest at a known position with this count, without current. */
void encoder_observer_reset(struct encoder_observer *observer,
                            const struct encoder_observer_params *params, struct position position,
                            num_t load_torque, num_t resistance, int32_t count);

/* The rotor rests at `position` with this count: its load is the torque that its current makes. To
   be predicted from there. */
void encoder_observer_place(struct encoder_observer *observer, struct position position,
                            int32_t count);

/*
 * At S(k): corrects what was predicted for it, and predicts S(k+1). `surprise`: by how much the
 * mean voltage over S(k-1)...S(k) was another than expected; `in_force`: what is expected over
 * S(k)...S(k+1).
 */
struct passage encoder_observer_step(struct encoder_observer *observer,
                                     const struct encoder_observer_params *params,
                                     struct phases current, struct phases surprise,
                                     struct phases in_force, int32_t count, bool holding);

/* Predicts S(k+1) once more, under this mean voltage. Apart: rare. */
__attribute__((noinline)) struct passage
encoder_observer_predict(struct encoder_observer *observer,
                         const struct encoder_observer_params *params, struct phases voltage);

static inline void encoder_observer_begin(struct encoder_observer *observer,
                                          const struct encoder_observer_params *params,
                                          const struct estimator_start *start)
{
    encoder_observer_reset(observer, params, start->encoder_position, start->load_torque,
                           start->resistance, start->encoder_count);
}

static inline struct passage encoder_observer_observe(struct encoder_observer *observer,
                                                      const struct encoder_observer_params *params,
                                                      const struct estimator_input *input)
{
    return encoder_observer_step(observer, params, input->winding.current, input->surprise,
                                 input->in_force, input->encoder_count, input->hold.active);
}

/* Torque besides the load, as it is known for S(k+1): the prediction takes the mean of it and of
   what was known for S(k). */
void encoder_observer_set_known_torque(struct encoder_observer *observer,
                                       const struct encoder_observer_params *params, num_t torque);

#endif
