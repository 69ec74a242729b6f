/*
 * Voltage disturbance observer, one per axis of the rotor frame: the voltage that acts on the
 * winding besides the one that was demanded: a wrong resistance, torque constant or inductance,
 * what the bridge takes away and its compensation, late at speed, does not give back.
 *
 * The current is predicted from one sample to the next with the demanded voltage, so the
 * disturbance shows in full in each innovation:  i - i_predicted = b u_d,  b = T/L to first order.
 * A low-pass takes the noise of the converters away:
 *
 *   u_d += (1 - e^(-w_u T)) ((i - i_predicted)/b - u_d)
 */
#ifndef STEADYSTEP_VOLTAGE_DISTURBANCE_H
#define STEADYSTEP_VOLTAGE_DISTURBANCE_H

#include "firmware/motor/motor_params.h"
#include "firmware/motor/park.h"
#include "firmware/motor/per_unit.h"

/* No model of this motor is wrong by more; a failed sensor is. */
#define VOLTAGE_DISTURBANCE_MAX NUM(0.15)

struct voltage_disturbance_params {
    coef_t stiffness;  /* 1/b: voltage per current */
    coef_t admittance; /* b: current per voltage */
    unit_t smoothing;  /* 1 - e^(-w_u T); 0: no observer */
};

struct voltage_disturbance {
    struct dq voltage;
};

/* bandwidth_rad_s: w_u, 0 for none. */
struct voltage_disturbance_params voltage_disturbance_design(const struct motor_params *motor,
                                                             const struct per_unit *base,
                                                             double period_s,
                                                             double bandwidth_rad_s);

static inline num_t voltage_disturbance_axis(num_t voltage, num_t innovation,
                                             const struct voltage_disturbance_params *params)
{
    const num_t seen =
        num_limit(num_mul_coef(innovation, params->stiffness), VOLTAGE_DISTURBANCE_MAX);

    return voltage + num_mul_unit(seen - voltage, params->smoothing);
}

/* One period; the innovation of S(k) in the rotor frame. */
static inline struct dq voltage_disturbance_step(struct voltage_disturbance *disturbance,
                                                 const struct voltage_disturbance_params *params,
                                                 struct dq innovation)
{
    struct dq *voltage = &disturbance->voltage;

    voltage->d = voltage_disturbance_axis(voltage->d, innovation.d, params);
    voltage->q = voltage_disturbance_axis(voltage->q, innovation.q, params);
    return *voltage;
}

#endif
