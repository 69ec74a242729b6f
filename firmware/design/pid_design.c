#include "firmware/design/pid_design.h"

#include "firmware/design/elementary.h"
#include "firmware/design/loop_bandwidth.h"
#include "firmware/design/mechanical_model.h"

/*
 * As in state_feedback_design.c, with the sum of the error as third state:
 *   delta (delta^2 + (1 - a11 + K_d b1 + K_p b2) delta + K_p c) + K_i T (b2 delta + c)
 *   = (delta + r)^3
 */
bool pid_design(const struct motor_params *motor, double period_s, double bandwidth_rad_s,
                double current_bandwidth_rad_s, struct pid_gains *gains,
                char error[DESIGN_ERROR_TEXT])
{
    if (!loop_bandwidth_check(motor, period_s, bandwidth_rad_s, current_bandwidth_rad_s, error)) {
        return false;
    }
    struct mechanical_model model = mechanical_model_of(motor, period_s);
    double km = motor->torque_constant_Nm_A;
    double r = bandwidth_rad_s * period_s * exponential_phi1(-bandwidth_rad_s * period_s);
    double c = model.b1 * model.a21 + model.b2 * model.one_minus_a11;
    double k_integral = r * r * r / c;
    double k_proportional = (3.0 * r * r - k_integral * model.b2) / c;
    double k_speed = (3.0 * r - model.one_minus_a11 - k_proportional * model.b2) / model.b1;

    *gains = (struct pid_gains){
        .k_proportional_A_rad = k_proportional,
        .k_integral_step_A_rad = k_integral,
        .k_speed_As_rad = k_speed,
        .k_speed_reference_As_rad = k_speed + motor->viscous_friction_Nms_rad / km,
        .k_acceleration_reference_As2_rad = motor->inertia_kgm2 / km,
    };
    return true;
}
