/*
 * High-gain observer of Seshagiri and Khalil (6) on an encoder: speed and acceleration from the
 * position alone, no parameter of the motor.
 *
 *   dz1 = z2 + a1 (y - z1)/eps,   dz2 = z3 + a2 (y - z1)/eps^2,   dz3 = a3 (y - z1)/eps^3
 *
 * with poles at -2, -5 and -10 over eps. The paper observes e2 = theta - theta*; for a constant
 * reference that is the same.
 *
 * Sampled exactly for a position that moves on a straight line between its samples (first-order
 * hold), so stable for any eps, where Euler needs eps >= 5 T. In the state x = (z1 - y, eps z2,
 * eps^2 z3), electrical turns all three, only the change of y enters:
 *
 *   x+ = F x + g (y+ - y),   F = e^(A T/eps),   g = -(eps/T) integral of e^(A s) e1 over 0...T/eps
 *
 * The estimate takes the measured position as it is, z2 as speed, and as load torque whatever makes
 * the torque balance give z3: so laws read the observed acceleration without knowing of it, and the
 * load torque shown means nothing else. An initial error peaks as eps^-2 in z3; the bounds on
 * the physical range of estimates do not apply.
 *
 * A count moves z3 by about 3 counts/eps^2: for simulation with a fine encoder. Not for fixed
 * point, whose range the peaks leave: the design refuses eps for which they do.
 */
#ifndef STEADYSTEP_HIGH_GAIN_OBSERVER_H
#define STEADYSTEP_HIGH_GAIN_OBSERVER_H

#include "firmware/design/refusal.h"
#include "firmware/estimator/estimate.h"
#include "firmware/motor/encoder.h"

struct high_gain_observer_params {
    struct motor_model_params model;
    struct encoder_params encoder;
    num_t speed_limit; /* of the speed by which angles are turned on */
    coef_t transition[3][3];
    coef_t input[3];
    coef_t speed_per_turn;
    coef_t acceleration_per_turn;
};

struct high_gain_observer {
    struct estimate estimate;
    struct encoder encoder;
    struct position measured;
    num_t x[3];
};

/* What it is designed from. */
struct high_gain_observer_task {
    const struct per_unit *base;
    const struct encoder_params *encoder;
    double period_s;
    double epsilon_s; /* a hundredth of the period at least */
    double speed_limit_rad_s;
};

/* false: epsilon is out of range, the limit in error. */
bool high_gain_observer_design(struct high_gain_observer_params *params,
                               const struct motor_model_params *model,
                               const struct high_gain_observer_task *task,
                               char error[DESIGN_ERROR_TEXT]);

/* z1 at `position` and at rest, while the encoder shows `measured` with this count. */
void high_gain_observer_reset(struct high_gain_observer *observer,
                              const struct high_gain_observer_params *params,
                              struct position position, struct position measured, num_t resistance,
                              int32_t count);

/* The rotor is where the encoder now is: at `position`. */
void high_gain_observer_place(struct high_gain_observer *observer, struct position position,
                              int32_t count);

/* What the control answers to: the motor at S(k+1), under this mean voltage. */
struct passage high_gain_observer_predict(struct high_gain_observer *observer,
                                          const struct high_gain_observer_params *params,
                                          struct phases voltage);

/* From S(k-1) to S(k), and the same; `in_force`: voltage that is expected over S(k)...S(k+1). */
__attribute__((noinline)) struct passage
high_gain_observer_step(struct high_gain_observer *observer,
                        const struct high_gain_observer_params *params, struct phases current,
                        struct phases in_force, int32_t count);

static inline void high_gain_observer_begin(struct high_gain_observer *observer,
                                            const struct high_gain_observer_params *params,
                                            const struct estimator_start *start)
{
    high_gain_observer_reset(observer, params, start->position, start->encoder_position,
                             start->resistance, start->encoder_count);
}

static inline struct passage
high_gain_observer_observe(struct high_gain_observer *observer,
                           const struct high_gain_observer_params *params,
                           const struct estimator_input *input)
{
    return high_gain_observer_step(observer, params, input->winding.current, input->in_force,
                                   input->encoder_count);
}

#endif
