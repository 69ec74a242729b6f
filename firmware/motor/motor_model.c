#include "firmware/motor/motor_model.h"

/* What a bridge may add that the board does not state. Per-unit: 9 % of the supply at the rated
   current. */
#define BRIDGE_RESISTANCE_MORE NUM(0.18)

struct motor_model_params motor_model_design(const struct motor_params *motor,
                                             const struct per_unit *base, double period_s,
                                             double bridge_resistance_ohm)
{
    const double rate = period_s / motor->inductance_H * base->resistance_ohm;
    const double nominal = (motor->resistance_ohm + bridge_resistance_ohm) / base->resistance_ohm;
    const double radians = base->turns_per_period * 6.283185307179586476925;
    const double x = rate * nominal; /* T R/L */
    const double y = period_s * motor->viscous_friction_Nms_rad / motor->inertia_kgm2;
    struct motor_model_params params;

    params.rate = coef_from_double(rate);
    params.emf_droop = coef_from_double(radians * radians / 24.0);
    params.speed_per_torque = coef_from_double(period_s * (1.0 - y * (1.0 / 2.0 - y / 6.0)) *
                                               base->acceleration_rad_s2 / base->speed_rad_s);
    params.friction =
        coef_from_double(motor->viscous_friction_Nms_rad * base->speed_rad_s / base->torque_Nm);
    params.turns_per_speed = coef_from_double(base->turns_per_period);
    params.half_turns_per_speed = coef_from_double(0.5 * base->turns_per_period);
    params.nominal_resistance = num_from_double(nominal);
    params.nominal_admittance =
        num_from_double(rate * (1.0 - x * (1.0 / 2.0 - x * (1.0 / 6.0 - x / 24.0))));
    params.admittance_per_resistance =
        coef_from_double(rate * rate * (1.0 / 2.0 - x * (1.0 / 3.0 - x / 8.0)));
    params.resistance_min = num_from_double(0.25 * nominal);
    params.resistance_max = num_from_double(3.0 * nominal);
    if (params.nominal_resistance < num_half(BRIDGE_RESISTANCE_MORE)) { /* thrice that is less */
        params.resistance_max = params.nominal_resistance + BRIDGE_RESISTANCE_MORE;
    }
    motor_model_params_fit_coefficients(&params);
    return params;
}

void winding_set_resistance(struct winding *winding, const struct motor_model_params *params,
                            num_t resistance)
{
    const struct motor_model_params *model = KNOWN(motor_model_params, params);

    winding->resistance = num_clamp(resistance, params->resistance_min, params->resistance_max);
    winding->admittance =
        params->nominal_admittance - num_mul_coef(winding->resistance - params->nominal_resistance,
                                                  model->admittance_per_resistance);
}
