#include "firmware/control/current_control.h"

#include "firmware/control/voltage_limit.h"

struct current_control_params current_control_design(const struct motor_params *motor,
                                                     const struct per_unit *base, double period_s,
                                                     double bandwidth_rad_s)
{
    const double proportional = motor->inductance_H * bandwidth_rad_s / base->resistance_ohm;
    const double integral =
        motor->resistance_ohm * bandwidth_rad_s * period_s / base->resistance_ohm;
    struct current_control_params params;

    params.proportional = coef_from_double(proportional);
    params.integral = coef_from_double(integral);
    params.unwind = coef_from_double(integral / proportional);
    params.reactance = coef_from_double((double)motor->rotor_teeth * base->speed_rad_s *
                                        motor->inductance_H / base->resistance_ohm);
    return params;
}

void current_control_reset(struct current_control *control)
{
    control->integral.d = NUM(0.0);
    control->integral.q = NUM(0.0);
}

static num_t integrate(const struct current_control_params *params, num_t integral, num_t error,
                       num_t taken_away)
{
    return integral + num_mul_coef(error, params->integral) +
           num_mul_coef(taken_away, params->unwind);
}

struct dq current_control_step(struct current_control *control,
                               const struct current_control_params *params, struct dq reference,
                               struct dq current, num_t speed, num_t voltage_limit)
{
    num_t reactance = num_mul_coef(speed, params->reactance);
    struct dq error = {reference.d - current.d, reference.q - current.q};
    struct dq wanted = {num_mul_coef(error.d, params->proportional) + control->integral.d -
                            num_mul(reactance, current.q),
                        num_mul_coef(error.q, params->proportional) + control->integral.q +
                            num_mul(reactance, current.d) + speed};
    struct dq v = limit_voltage(wanted, voltage_limit);

    control->integral.d = integrate(params, control->integral.d, error.d, v.d - wanted.d);
    control->integral.q = integrate(params, control->integral.q, error.q, v.q - wanted.q);
    return v;
}
