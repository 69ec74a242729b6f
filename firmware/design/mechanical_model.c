#include "firmware/design/mechanical_model.h"

#include "firmware/design/elementary.h"

struct mechanical_model mechanical_model_of(const struct motor_params *motor, double period_s)
{
    double damping = motor->viscous_friction_Nms_rad * period_s / motor->inertia_kgm2;
    double speed_per_torque = period_s / motor->inertia_kgm2 * exponential_phi1(-damping);
    double angle_per_torque =
        period_s * period_s / motor->inertia_kgm2 * exponential_phi2(-damping);

    return (struct mechanical_model){
        .one_minus_a11 = damping * exponential_phi1(-damping),
        .a21 = period_s * exponential_phi1(-damping),
        .b1 = motor->torque_constant_Nm_A * speed_per_torque,
        .b2 = motor->torque_constant_Nm_A * angle_per_torque,
        .e1 = -speed_per_torque,
        .e2 = -angle_per_torque,
    };
}
