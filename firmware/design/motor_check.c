#include "firmware/design/motor_check.h"

#include "firmware/design/elementary.h"

bool motor_check(const struct motor_params *motor, double period_s, char error[DESIGN_ERROR_TEXT])
{
    if (!design_require_positive(error, "resistance", motor->resistance_ohm, "ohm") ||
        !design_require_positive(error, "inductance", motor->inductance_H, "H") ||
        !design_require_positive(error, "torque constant", motor->torque_constant_Nm_A, "N m/A") ||
        !design_require_positive(error, "inertia", motor->inertia_kgm2, "kg m2") ||
        !design_require_positive(error, "rated current", motor->rated_current_A, "A") ||
        !design_require_positive(error, "supply", motor->supply_V, "V") ||
        !design_require_positive(error, "rotor teeth", motor->rotor_teeth, "per turn") ||
        !design_require_positive(error, "period", period_s, "s")) {
        return false;
    }
    if (!(motor->viscous_friction_Nms_rad >= 0.0) || !is_finite(motor->viscous_friction_Nms_rad)) {
        return design_refuse_limit(error, (struct refusal){.quantity = "viscous friction",
                                                           .value = motor->viscous_friction_Nms_rad,
                                                           .relation = "at least",
                                                           .limit = 0.0,
                                                           .unit = "N m s/rad",
                                                           .reason = "and finite"});
    }
    double period_max = motor->inductance_H / motor->resistance_ohm;
    if (!(period_s < period_max)) {
        return design_refuse_limit(error, (struct refusal){.quantity = "period",
                                                           .value = period_s,
                                                           .relation = "below",
                                                           .limit = period_max,
                                                           .unit = "s",
                                                           .reason = "the motor's L / R"});
    }
    return true;
}
