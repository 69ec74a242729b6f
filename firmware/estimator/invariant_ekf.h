/*
 * Constant-gain invariant extended Kalman filter: rotor position, speed and load torque of a
 * stepper from its phase currents and voltages.
 *
 * The current model lives in phase coordinates; the innovation is expressed in the estimated
 * rotor frame, nu = e^(-j N theta) (i - i_hat), in which the error dynamics depend on speed and
 * d current only, so that one constant gain serves every speed. The gain from nu_d to the angle
 * changes sign with the direction of rotation and is therefore multiplied by sat(w / w_s).
 *
 *   predict with the voltage measured over the past period (motor_model.h), then correct:
 *   i_hat += k_i (i - i_hat)          w_hat  += k_w nu_q
 *   theta += k_td sat(w/w_s) nu_d + k_tq nu_q
 *   T_L   += k_T nu_q
 *   b     =  s b + (k_bd nu_d, k_bq nu_q)     voltage bias in the rotor frame, while holding
 *   R     += k_R i_d b_d                      series resistance, while holding
 *
 * At rest no innovation tells load from displacement; only the back-EMF of the rotor's own motion
 * does. Gains quick enough to follow a load step would let the noise carry the estimate away over
 * a long hold. So the hold has two sets: a slow one, and for 10 ms after the mean innovation has
 * shown a load step a quick one.
 *
 * Gains: design/invariant_ekf_design.h.
 */
#ifndef STEADYSTEP_INVARIANT_EKF_H
#define STEADYSTEP_INVARIANT_EKF_H

#include "firmware/design/invariant_ekf_design.h"
#include "firmware/estimator/estimate.h"

/* One set of gains, per-unit. */
struct invariant_ekf_gain_set {
    coef_t current;
    coef_t speed_q;
    coef_t angle_d; /* per unit of the clamped speed */
    coef_t angle_q; /* electrical turns per current */
    coef_t load_q;
    coef_t load_leak; /* share of the load torque forgotten each period */
    coef_t bias_decay;
    coef_t bias_d;
    coef_t bias_q;
    coef_t resistance; /* per product of d current and d bias */
};

struct invariant_ekf_params {
    struct motor_model_params model;
    struct invariant_ekf_gain_set moving;
    struct invariant_ekf_gain_set holding;
    struct invariant_ekf_gain_set following; /* holding, after a load step */
    num_t odd_gain_speed;                    /* w_s */
};

struct invariant_ekf {
    struct estimate estimate;
    struct dq bias;             /* voltage, in the rotor frame */
    num_t innovation_mean;      /* of nu_q over a millisecond: a load step shows in it */
    uint32_t following_periods; /* left of the gains that follow a load step */
};

/* Per-unit parameters. */
struct invariant_ekf_params invariant_ekf_scale(const struct motor_model_params *model,
                                                const struct per_unit *base,
                                                const struct invariant_ekf_gains *moving,
                                                const struct invariant_ekf_gains *holding,
                                                const struct invariant_ekf_gains *following);

/* At rest at a known position, without current and load. */
void invariant_ekf_reset(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                         struct position position, num_t resistance);

/* From S(k-1) to S(k). `voltage`: mean over that period; `current`: sampled at S(k). */
void invariant_ekf_step(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                        struct phases current, struct phases voltage, bool holding);

#endif
