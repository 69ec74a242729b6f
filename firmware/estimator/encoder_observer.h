/*
 * Model observer on an encoder: rotor position, speed and load torque from counts and currents.
 *
 *   predict with the measured currents (motor_model.h), then correct with
 *   nu = theta_measured - theta_hat:
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
    num_t known_torque; /* part of the load that need not be estimated; set before each step */
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

/* The rotor rests at `position` with this count: its load is the torque that its current makes. */
void encoder_observer_place(struct encoder_observer *observer,
                            const struct encoder_observer_params *params, struct position position,
                            int32_t count);

/* From S(k-1) to S(k). Not inlined: its registers cost the sensorless interrupt nothing. */
__attribute__((noinline)) void encoder_observer_step(struct encoder_observer *observer,
                                                     const struct encoder_observer_params *params,
                                                     struct phases current, struct phases voltage,
                                                     int32_t count, bool holding);

static inline void encoder_observer_begin(struct encoder_observer *observer,
                                          const struct encoder_observer_params *params,
                                          const struct estimator_start *start)
{
    encoder_observer_reset(observer, params, start->encoder_position, start->load_torque,
                           start->resistance, start->encoder_count);
}

static inline void encoder_observer_observe(struct encoder_observer *observer,
                                            const struct encoder_observer_params *params,
                                            const struct estimator_input *input)
{
    encoder_observer_step(observer, params, input->winding->current, input->winding->voltage,
                          input->encoder_count, input->hold.active);
}

/* Torque that the next prediction takes into account besides the load. */
static inline void encoder_observer_set_known_torque(struct encoder_observer *observer,
                                                     num_t torque)
{
    observer->known_torque = torque;
}

#endif
