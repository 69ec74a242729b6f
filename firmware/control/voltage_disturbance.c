#include "firmware/control/voltage_disturbance.h"

#include "firmware/design/elementary.h"

struct voltage_disturbance_params voltage_disturbance_design(const struct motor_params *motor,
                                                             const struct per_unit *base,
                                                             double period_s,
                                                             double bandwidth_rad_s)
{
    const double decay = motor->resistance_ohm * period_s / motor->inductance_H;
    const double admittance =
        period_s / motor->inductance_H * exponential_phi1(-decay) * base->resistance_ohm;
    const double x = bandwidth_rad_s * period_s;

    return (struct voltage_disturbance_params){
        .stiffness = coef_from_double(1.0 / admittance),
        .admittance = coef_from_double(admittance),
        .smoothing = unit_from_num(num_from_double(x * exponential_phi1(-x))),
    };
}
