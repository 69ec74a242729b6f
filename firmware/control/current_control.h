/*
 * d-q current control of Bendjedia 2012 (4)-(6): a PI per axis on the linear part, the rotational
 * voltages fed forward, the vector limited with d first, integrators unwound by what the limit
 * took away.
 *
 *   v_d = Kp (i_d* - i_d) + z_d - N w_f L i_q
 *   v_q = Kp (i_q* - i_q) + z_q + N w_f L i_d + Km w
 *   z  += Ki (i* - i) + (Ki/Kp) (v_limited - v)
 *
 * Kp = L w_c and Ki = R w_c T cancel the winding's pole, so the loop closes with the bandwidth w_c.
 * w is the rotor's speed, w_f that of the frame in which the currents are regulated: the rotor's in
 * motion, zero in a hold. A rotational voltage fed forward in a frame that stands still would be a
 * q current along the speed, N i_d w/(s + w_c): negative damping that grows with the hold's
 * stiffness.
 *
 * The currents are those predicted for S(k+1), where the voltage begins to act; that takes the
 * period of delay out of the loop.
 */
#ifndef STEADYSTEP_CURRENT_CONTROL_H
#define STEADYSTEP_CURRENT_CONTROL_H

#include "firmware/control/voltage_limit.h"
#include "firmware/motor/motor_params.h"
#include "firmware/motor/park.h"
#include "firmware/motor/per_unit.h"
#include "firmware/numeric/coefficients.h"

struct current_control_params {
    coef_t proportional;
    coef_t integral;
    coef_t unwind;    /* Ki/Kp */
    coef_t reactance; /* N L: voltage per speed and current */
};

#define CURRENT_CONTROL_PARAMS_COEFFICIENTS(X)                                                     \
    X(proportional, current_proportional)                                                          \
    X(integral, current_integral)                                                                  \
    X(unwind, current_unwind)                                                                      \
    X(reactance, current_reactance)
COEFFICIENTS(current_control_params, CURRENT_CONTROL_PARAMS_COEFFICIENTS)

/* Mechanical speeds: of the frame of the currents, and of the rotor, whose back-EMF it is. */
struct rotation {
    num_t frame;
    num_t rotor;
};

struct current_control {
    struct dq integral; /* z */
};

/* N w_base L, per-unit: a large gain. */
__attribute__((cold)) coef_t current_control_reactance(const struct motor_params *motor,
                                                       const struct per_unit *base);

__attribute__((cold)) struct current_control_params
current_control_design(const struct motor_params *motor, const struct per_unit *base,
                       double period_s, double bandwidth_rad_s);

void current_control_reset(struct current_control *control);

/* Bumpless transfer: the integrators as they are in a steady state at this voltage. */
static inline void current_control_preset(struct current_control *control, struct dq voltage)
{
    control->integral = voltage;
}

/* Voltage in the control frame, of magnitude at most voltage_limit. */
__attribute__((always_inline)) static inline struct dq
current_control_step(struct current_control *control, const struct current_control_params *params,
                     struct dq reference, struct dq current, struct rotation speed,
                     num_t voltage_limit)
{
    const struct current_control_params *gain = KNOWN(current_control_params, params);
    const num_t reactance = num_mul_large(speed.frame, gain->reactance);
    const struct dq error = {reference.d - current.d, reference.q - current.q};
    const struct dq wanted = {num_mul_coef(error.d, gain->proportional) + control->integral.d -
                                  num_mul(reactance, current.q),
                              num_mul_coef(error.q, gain->proportional) + control->integral.q +
                                  num_mul(reactance, current.d) + speed.rotor};
    struct dq voltage = wanted;

    control->integral.d += num_mul_coef(error.d, gain->integral);
    control->integral.q += num_mul_coef(error.q, gain->integral);
    if (RARE(exceeds_voltage(wanted, voltage_limit))) {
        voltage = limit_voltage(wanted, voltage_limit);
        control->integral.d += num_mul_coef(voltage.d - wanted.d, gain->unwind);
        control->integral.q += num_mul_coef(voltage.q - wanted.q, gain->unwind);
    }
    return voltage;
}

#endif
