#include "firmware/control/current_control.h"

coef_t current_control_reactance(const struct motor_params *motor, const struct per_unit *base)
{
    return coef_large_from_double(per_unit_reactance(base, motor));
}

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
    params.reactance = current_control_reactance(motor, base);
    current_control_params_fit_coefficients(&params);
    return params;
}

void current_control_reset(struct current_control *control)
{
    control->integral.d = NUM(0.0);
    control->integral.q = NUM(0.0);
}
