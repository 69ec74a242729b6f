#include "firmware/design/state_feedback_design.h"

#include "firmware/design/elementary.h"
#include "firmware/design/loop_bandwidth.h"
#include "firmware/design/mechanical_model.h"

/*
 * With delta = z - 1, r = 1 - e^(-w0 T) and c = b1 a21 + b2 (1 - a11), the closed loop has
 *   delta^2 + (1 - a11 + K_w b1 + K_theta b2) delta + K_theta c = (delta + r)^2,
 * free of the cancellations that Ackermann's formula (27) suffers from near z = 1.
 */
bool state_feedback_design(const struct motor_params *motor, double period_s,
                           double bandwidth_rad_s, double current_bandwidth_rad_s,
                           struct state_feedback_gains *gains, char error[DESIGN_ERROR_TEXT])
{
    if (!loop_bandwidth_check(motor, period_s, bandwidth_rad_s, current_bandwidth_rad_s, error)) {
        return false;
    }
    struct mechanical_model model = mechanical_model_of(motor, period_s);
    double km = motor->torque_constant_Nm_A;
    double r = bandwidth_rad_s * period_s * exponential_phi1(-bandwidth_rad_s * period_s);
    double c = model.b1 * model.a21 + model.b2 * model.one_minus_a11;
    double k_angle = r * r / c;
    double k_speed = (2.0 * r - model.one_minus_a11 - k_angle * model.b2) / model.b1;

    *gains = (struct state_feedback_gains){
        .k_speed_As_rad = k_speed,
        .k_angle_A_rad = k_angle,
        .k_angle_reference_A_rad = k_angle,
        .k_load_A_Nm = 1.0 / km,
        .k_speed_reference_As_rad = k_speed + motor->viscous_friction_Nms_rad / km,
        .k_acceleration_reference_As2_rad = motor->inertia_kgm2 / km,
    };
    return true;
}
