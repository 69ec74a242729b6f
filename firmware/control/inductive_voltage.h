/*
 * The voltage that the winding's inductance takes for the currents to follow their reference i*,
 * rotation included: L d/dt of the reference's phases, in the rotor frame,
 *
 *   v_d = -N w L i_q*,   v_q = N w L i_d* + f L (d/dt) i_q*
 *
 * with the difference over the past period for the derivative, and a share f of it.
 */
#ifndef STEADYSTEP_INDUCTIVE_VOLTAGE_H
#define STEADYSTEP_INDUCTIVE_VOLTAGE_H

#include "firmware/control/position_law.h"

struct inductive_voltage_params {
    coef_t reactance; /* N L: voltage per speed and current */
    coef_t per_step;  /* f L/T: voltage per change of the q current in a period */
    num_t step_limit; /* keeps the product inside the number range */
};

static inline struct inductive_voltage_params
inductive_voltage_design(const struct position_law_task *task, double share)
{
    const struct per_unit *base = task->base;
    const double inductance = task->motor->inductance_H / base->resistance_ohm; /* s */
    const double per_step = share * inductance / task->period_s;
    const double step_max = 10.0; /* per-unit voltage, a third of the number range */
    const struct inductive_voltage_params params = {
        .reactance = coef_from_double(per_unit_reactance(base, task->motor)),
        .per_step = coef_from_double(per_step),
        .step_limit = num_from_double(per_step > 1.0 ? step_max / per_step : step_max),
    };
    return params;
}

static inline struct dq inductive_voltage(const struct inductive_voltage_params *params,
                                          struct dq reference, num_t step_q, num_t speed)
{
    const num_t reactance = num_mul_coef(speed, params->reactance);
    const num_t step = num_headroom(step_q, params->step_limit);

    return (struct dq){-num_mul(reactance, reference.q),
                       num_mul(reactance, reference.d) + num_mul_coef(step, params->per_step)};
}

#endif
